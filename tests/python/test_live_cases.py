"""Every case with gates or inflows, served and running by itself while a client moves them: its log runs again, bit for bit.

SANDGATE is the program, SANDGATE_ROOT the source tree. Run by tests/it/logs.
"""

import json
import os
import pathlib
import random
import re
import subprocess
import sys
import time

import pytest

ROOT = pathlib.Path(os.environ["SANDGATE_ROOT"])
CASES = sorted([*(ROOT / "cases").glob("*.toml"), *(ROOT / "cases/phases").glob("*.toml")])
MOVABLE = [path for path in CASES if re.search(r"^\[(gates|inflows)\.", path.read_text(), re.M)]

sys.path.insert(0, str(ROOT / "examples"))
from bus_client import Component, open_session  # noqa: E402


def served(case, folder, log):
    """The case on Zenoh, as coarse as its rules allow, and where it listens. Its steps are short: what is done counts, not how
    far the run comes."""
    text, count = re.subn(r"(?m)^step = .*$", 'step = "0.3 ms"', case.read_text())
    assert count == 1
    spacing = re.compile(r'(?m)^spacing = "(\S+) mm"')
    for coarser in (2.5, 2.0, 1.4, 1.0):
        changed, count = spacing.subn(lambda found: f'spacing = "{coarser * float(found[1]):g} mm"', text)
        assert count == 1
        scene = folder / case.name
        scene.write_text(changed)
        command = [os.environ["SANDGATE"], "serve", str(scene), "--instance", "live", "--threads", "1", "--log", str(log)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for line in process.stdout:
            if line.startswith("listening on "):
                return process, line.split()[-1]
        said = process.communicate()[1]
        assert process.returncode == 3, said
    raise AssertionError(f"no spacing will do: {said}")


@pytest.mark.parametrize("case", MOVABLE, ids=[path.stem for path in MOVABLE])
def test_gates_and_inflows_moved_live_run_again(case, tmp_path):
    log = tmp_path / "live.mcap"
    process, endpoint = served(case, tmp_path, log)
    with process:
        try:
            with open_session(endpoint) as session:
                component = Component(session, "live", client="hand")
                variables = component.ask("describe")["variables"]
                inputs = {v["name"]: (v["min"], v["max"]) for v in variables if v["causality"] == "input"}
                assert inputs
                dice = random.Random(case.stem)
                component.ask("step", dt_ns=500_000)
                component.ask("run")
                for name, (least, most) in [*inputs.items()] * 3:
                    value = dice.uniform(least, most)
                    if dice.random() < 0.5:
                        session.put(f"sandgate/v1/live/in/{name}", json.dumps({"value": value, "client": "plc"}))
                    else:
                        component.ask("set", inputs={name: value})
                    step, end = component.ask("status")["step"], time.monotonic() + 60
                    while component.ask("status")["step"] <= step:
                        assert time.monotonic() < end, "it does not step"
                        time.sleep(0.01)
                component.ask("pause")
                component.ask("step", dt_ns=333_333, inputs={name: least for name, (least, _) in inputs.items()})
                component.ask("terminate")
            process.communicate(timeout=60)
        finally:
            process.kill()
    check = [os.environ["SANDGATE"], "log", "redrive", "--check", "--threads", "1", str(log)]
    done = subprocess.run(check, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    steps, moved = map(int, re.search(r"same bits: (\d+) steps with (\d+) inputs", done.stdout).groups())
    assert steps >= 2 + 3 and moved >= 4 * len(inputs), done.stdout
