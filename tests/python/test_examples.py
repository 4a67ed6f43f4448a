"""The example clients on served scenes: SANDGATE is the program, SANDGATE_ROOT the source tree.

SANDGATE_RUST_CLIENT  examples/bus_client.rs, built
"""

import os
import pathlib
import re
import signal
import struct
import subprocess
import sys

import pytest

ROOT = pathlib.Path(os.environ["SANDGATE_ROOT"])


@pytest.fixture
def serve():
    """Starts servers and ends them."""
    processes = []

    def start(scene, *arguments):
        command = [os.environ["SANDGATE"], "serve", str(ROOT / f"tests/scenes/{scene}.toml"), "--threads", "1", *arguments]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        processes.append(process)
        for line in process.stdout:
            if line.startswith("listening on "):
                return line.split()[-1]
        raise AssertionError(process.stderr.read())

    yield start
    for process in processes:
        process.send_signal(signal.SIGINT)
        try:
            process.communicate(timeout=60)
        finally:
            process.kill()


def example(name, *arguments):
    command = [sys.executable, str(ROOT / "examples" / name), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_two_components_are_stepped_against_each_other(serve, tmp_path):
    logs = [tmp_path / "upper.mcap", tmp_path / "lower.mcap"]
    upper, lower = serve("small_silo", "--log", str(logs[0])), serve("devices", "--log", str(logs[1]))
    out = example("orchestrator.py", upper, "small_silo", lower, "devices", "--steps", 40)
    assert len(re.findall(r"^t = ", out, re.M)) == 4, out
    left = float(re.search(r"small_silo: (\S+) kg out, account off by 0.0 kg", out)[1])
    entered, asked, owed = map(float, re.search(r"devices: (\S+) kg in of (\S+) kg asked for, (\S+) kg", out).groups())
    assert left > 0.5 and asked > 0
    # All that left is asked for a step later, or, beyond what the inflow takes, still owed.
    assert asked + owed == pytest.approx(left, abs=1e-3)
    # An inflow lets in whole particles (5 mm x 5 mm x 50 mm of 1.5 t/m3), a layer of four at a time, and waits for room.
    assert 0 <= asked - entered < 2 * 4 * 0.0019


def test_gauges_are_plotted_as_they_arrive(serve, tmp_path):
    endpoint = serve("small_silo", "--realtime-factor", "0.2")
    picture = tmp_path / "plot.png"
    out = example("live_plot.py", endpoint, "small_silo", "--seconds", 3, "--output", picture)
    values, gauges, lost = map(int, re.findall(r"\d+", out))
    assert gauges == 5 and values > 5 * 20 and lost == 0, out
    data = picture.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">II", data[16:24]) == (1080, 840)


def test_the_client_in_rust_says_what_the_one_in_python_says(serve):
    said = {}
    for name, command in (
        ("python", [sys.executable, str(ROOT / "examples/bus_client.py")]),
        ("rust", [os.environ["SANDGATE_RUST_CLIENT"]]),
    ):
        endpoint = serve("small_silo")
        done = subprocess.run([*command, endpoint, "small_silo"], capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stderr
        said[name] = done.stdout
    number = r"-?\d+\.?\d*(?:e-?\d+)?"
    for pattern in (rf"step 10: gate at ({number})", rf"gauge.level.depth = ({number}) m", rf"mass present ({number}) kg"):
        python, rust = (float(re.search(pattern, said[name])[1]) for name in ("python", "rust"))
        # The same simulation; what is printed is rounded differently.
        assert rust > 0 and abs(python - rust) < 6e-3, said
    assert len(re.findall("^t = ", said["rust"], re.M)) == len(re.findall("^t = ", said["python"], re.M)) > 4
    assert "refused, range: set: gate.main.opening: found 1.5, allowed a number from 0 to 1" in said["rust"]
