"""Logs that FMUs and the C library write: whole, all traffic, and run again with the same bits.

Run by tests/it/fmu.rs, which packs the FMUs first.

SANDGATE_PROGRAM  the program
"""

import csv
import ctypes
import json
import os
import resource
import signal
import subprocess
import sys

import numpy as np
import pytest

sys.path.insert(0, os.path.dirname(__file__))

import fmpy
from fmpy.fmi1 import FMICallException
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from importer import Fmu, Library
from scheduled import FMUS, H, INPUTS, LIBRARY, PATH, STEPS, run, table, wanted

PROGRAM = os.environ["SANDGATE_PROGRAM"]
both = pytest.mark.parametrize("version", [2, 3])


def sandgate(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def runs_again(path):
    said = sandgate("log", "redrive", path, "--check")
    assert "same bits" in said and "and the state at the end" in said, said
    return said


def messages(path):
    """Topics below the instance's name, with their messages decoded."""
    with open(path, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        return [(channel.topic.split("/", 3)[3], value) for _, channel, _, value in reader.iter_decoded_messages(log_time_order=False)]


def logged(version, path, **start_values):
    return Fmu(FMUS[version]).initialize(**{"log__path": str(path)}, **start_values)


@both
def test_simulate_fmu_leaves_a_log_that_runs_again(version, tmp_path):
    path = tmp_path / "run.mcap"
    fmpy.simulate_fmu(
        FMUS[version], start_values={"log.path": str(path), "solver.resolution_scale": 1.25}, input=table(),
        stop_time=STEPS * H, step_size=H, output_interval=H)
    assert f"{STEPS} steps" in runs_again(path)
    info = json.loads(sandgate("log", "info", path, "--json"))
    text = json.dumps(info)
    for part in ("modelDescription.xml", "scene.toml", "terminated"):
        assert part in text
    found = messages(path)
    calls = [v for topic, v in found if topic == f"@fmi{version}/fmi{version}DoStep/request"]
    replies = [v for topic, v in found if topic == f"@fmi{version}/fmi{version}DoStep/reply"]
    assert len(calls) == len(replies) == STEPS
    assert json.loads(calls[1].body) == {"t": H, "h": H} and calls[1].time == H
    assert {reply.status for reply in replies} == {"ok"}
    kind = {2: "fmi2SetReal", 3: "fmi3SetFloat64"}[version]
    asked = [json.loads(v.body) for topic, v in found if topic == f"@fmi{version}/{kind}/request"]
    assert all(set(body) <= set(INPUTS) for body in asked) and len(asked) >= STEPS
    applied = [v for topic, v in found if topic == "out/applied"]
    assert {a.source for a in applied} == {f"fmi{version}"}
    assert [i.name for i in applied[0].inputs][0] == "solver.resolution_scale"
    assert len([t for t, _ in found if t == "out/stats"]) == STEPS + 1


@both
def test_logging_changes_no_bit(version, tmp_path):
    fmu = Fmu(FMUS[version]).initialize()
    plain = run(fmu)
    fmu.free()
    fmu = logged(version, tmp_path / "run.mcap")
    assert run(fmu) == plain
    fmu.free()
    runs_again(tmp_path / "run.mcap")


@both
def test_roll_backs_are_in_the_log_and_run_again(version, tmp_path):
    """Each step three times, as masters do that iterate; the last one counts."""
    path = tmp_path / "run.mcap"
    steps = 6
    fmu = logged(version, path)
    for k in range(steps):
        state = fmu.get_state()
        for attempt in range(3):
            if attempt > 0:
                fmu.set_state(state)
            for name in INPUTS:
                fmu.set(name, wanted(name, k * H) * (1.0 if attempt == 2 else 0.5))
            fmu.step(k * H, H)
        fmu.free_state(state)
    fmu.fmu.terminate()
    fmu.free()
    assert os.listdir(tmp_path) == ["run.mcap"]
    said = runs_again(path)
    assert f"{3 * steps} steps" in said and f"{2 * steps} times back to a saved state" in said
    assert f"{2 * steps} times back" in sandgate("log", "info", path)
    # What is exported is the trajectory that was kept.
    sandgate("log", "export", path, "--csv", tmp_path / "gauges.csv")
    with open(tmp_path / "gauges.csv", newline="") as file:
        lines = [line for line in file if not line.startswith("#")]
    rows = list(csv.reader(lines))
    times = [float(row[0]) for row in rows[1:]]
    assert times == [k * H for k in range(steps + 1)]
    # A new run of the log can be logged, and runs again as well.
    sandgate("log", "redrive", path, "--log", tmp_path / "again.mcap")
    assert f"{2 * steps} times back" in runs_again(tmp_path / "again.mcap")


def test_a_changed_state_is_found(tmp_path):
    """The log of a roll-back whose saved state is another: told at the step where it was saved."""
    path = tmp_path / "run.mcap"
    fmu = logged(3, path)
    fmu.step(0.0, H)
    state = fmu.get_state()
    fmu.step(H, H)
    fmu.set_state(state)
    fmu.free_state(state)
    fmu.free()
    runs_again(path)
    checksum = next(v.state for topic, v in messages(path) if topic == "out/applied" and v.state)
    data = path.read_bytes()
    assert data.count(checksum) == 2
    changed = tmp_path / "changed.mcap"
    changed.write_bytes(data.replace(checksum, bytes(32), 1))
    done = subprocess.run([PROGRAM, "log", "redrive", changed, "--check"], capture_output=True, text=True)
    assert done.returncode == 7 and "saved state" in done.stderr, done.stderr


def test_slopes_of_inputs_run_again(tmp_path):
    path = tmp_path / "run.mcap"
    fmu = Fmu(FMUS[2])
    fmu.set("log.path", str(path))
    gate = fmu.variables["gate.sluice.opening"].valueReference

    def ramp(slope):
        fmu.fmu.fmi2SetRealInputDerivatives(
            fmu.fmu.component, (fmpy.fmi2.fmi2ValueReference * 1)(gate), 1, (fmpy.fmi2.fmi2Integer * 1)(1),
            (fmpy.fmi2.fmi2Real * 1)(slope))

    ramp(0.25 / H)
    fmu.initialize()
    fmu.step(0.0, H)
    assert fmu.get(["gate.sluice.opening"]) == [0.25]
    ramp(0.5 / H)
    fmu.step(H, H)
    fmu.free()
    runs_again(path)


def free_only(fmu):
    """Frees the instance; FMPy's own method unloads the library, too."""
    getattr(fmu.fmu, f"fmi{fmu.version}FreeInstance")(fmu.fmu.component)


class Updated:
    """An FMI 3 instance with intermediate updates: sets the gate inside steps, and ends the second step early."""

    def __init__(self, path):
        self.made = Fmu(FMUS[3])
        fmu, variables = self.made.fmu, self.made.variables
        free_only(self.made)
        self.gate = variables["gate.sluice.opening"].valueReference
        self.updates = 0
        fmu.instantiate(
            earlyReturnAllowed=True, requiredIntermediateVariables=[self.gate], intermediateUpdate=self.update)
        fmu.setString([variables["log.path"].valueReference], [str(path)])
        fmu.enterInitializationMode(startTime=0.0)
        fmu.exitInitializationMode()

    def update(self, environment, time, set_requested, get_allowed, step_finished, can_return_early, early, early_time):
        self.updates += 1
        if self.updates == 2:
            self.made.fmu.setFloat64([self.gate], [0.75])
        if time > 1.25 * H:
            early[0] = True
            early_time[0] = 1.5 * H


def test_what_is_done_inside_steps_runs_again(tmp_path):
    path = tmp_path / "run.mcap"
    updated = Updated(path)
    fmu = updated.made.fmu
    fmu.doStep(currentCommunicationPoint=0.0, communicationStepSize=H)
    _, _, early, last = fmu.doStep(currentCommunicationPoint=H, communicationStepSize=H)
    assert (early, last) == (True, 1.5 * H) and updated.updates > 3
    updated.made.free()
    moments = [m for topic, v in messages(path) if topic == "out/applied" for m in v.moments]
    assert [i.name for m in moments for i in m.inputs] == ["gate.sluice.opening"]
    assert sum(m.ends for m in moments) >= 1
    runs_again(path)


@both
def test_a_state_from_elsewhere_begins_the_next_file(version, tmp_path):
    other = Fmu(FMUS[version]).initialize()
    run(other, last=3)
    state = other.save()
    fmu = logged(version, tmp_path / "run.mcap")
    run(fmu, last=2)
    fmu.restore(state)
    assert run(fmu, first=3, last=5) == run(other, first=3, last=5)
    for one in (fmu, other):
        one.free()
    # One that was only instantiated begins with the state.
    fresh = Fmu(FMUS[version])
    fresh.set("log.path", str(tmp_path / "fresh.mcap"))
    fresh.restore(state)
    run(fresh, first=3, last=5)
    fresh.free()
    files = ["fresh.mcap", "run-1-0000.mcap", "run.mcap"]
    assert sorted(os.listdir(tmp_path)) == files
    said = sandgate("log", "redrive", "--check", *[tmp_path / file for file in files])
    assert said.count("same bits: 2 steps") == 3


@both
def test_reset_ends_the_log_and_the_same_path_goes_on_beside_it(version, tmp_path):
    path = tmp_path / "run.mcap"
    fmu = logged(version, path)
    run(fmu, last=2)
    fmu.reset()
    fmu.initialize(log__path=str(path))
    run(fmu, last=3)
    fmu.reset()
    fmu.initialize()
    run(fmu, last=1)
    fmu.free()
    assert sorted(os.listdir(tmp_path)) == ["run-1-0000.mcap", "run.mcap"]
    sandgate("log", "redrive", "--check", path, tmp_path / "run-1-0000.mcap")


@both
def test_a_log_that_cannot_begin_is_refused_and_the_path_can_be_corrected(version, tmp_path):
    path = tmp_path / "run.mcap"
    first, second = logged(version, path), Fmu(FMUS[version])
    for bad, why in ((path, "exists already"), (tmp_path / "#r5#" / "run.mcap", "cannot create log file")):
        second.messages.clear()
        with pytest.raises(FMICallException):
            second.initialize(log__path=str(bad))
        assert why in second.messages[-1][2] and "ExitInitializationMode" in second.messages[-1][2]
        # A single # would be the mark of a value reference.
        assert "#r5#" not in second.messages[-1][2].replace("##", "")
        second.set("log.path", str(tmp_path / f"{why[0]}.mcap"))
        second.fmu.exitInitializationMode()
        second.reset()
    for fmu in (first, second):
        fmu.free()
    assert sorted(os.listdir(tmp_path)) == ["c.mcap", "e.mcap", "run.mcap"]


@both
def test_a_relative_path_is_where_the_importer_is_when_the_log_begins(version, tmp_path, monkeypatch):
    (tmp_path / "here").mkdir()
    (tmp_path / "there").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    fmu = logged(version, "run.mcap")
    monkeypatch.chdir(tmp_path / "there")
    run(fmu, last=1)
    fmu.free()
    assert os.listdir(tmp_path / "here") == ["run.mcap"] and os.listdir(tmp_path / "there") == []


@both
def test_texts_are_refused_like_numbers_are(version, tmp_path):
    fmu = Fmu(FMUS[version])
    reference = {name: fmu.variables[name].valueReference for name in ("log.path", "zenoh.config", "energy.kinetic")}
    fmu.set("log.path", str(tmp_path / "ä.mcap"))
    assert fmu.fmu.getString([reference["log.path"], reference["zenoh.config"]]) in (
        [str(tmp_path / "ä.mcap"), ""], [str(tmp_path / "ä.mcap").encode(), b""])
    for call in (
        lambda: fmu.fmu.getString([reference["energy.kinetic"]]),
        lambda: fmu.fmu.setString([reference["energy.kinetic"]], ["x"]),
        lambda: fmu.fmu.setString([9999], ["x"]),
    ):
        with pytest.raises(FMICallException):
            call()
        assert "found" in fmu.messages[-1][2] and "allowed" in fmu.messages[-1][2]
    fmu.initialize()
    with pytest.raises(FMICallException):
        fmu.set("log.path", "late.mcap")
    assert "not allowed in mode Stepping" in fmu.messages[-1][2]
    fmu.free()
    assert os.listdir(tmp_path) == ["ä.mcap"]
    runs_again(tmp_path / "ä.mcap")


def open_things():
    return len(os.listdir("/proc/self/task")), len(os.listdir("/proc/self/fd"))


@both
def test_a_thousand_instances_with_a_log_leave_nothing_open(version, tmp_path):
    """Half of them end inside their logs, half before these begin."""
    fmu = Fmu(FMUS[version], logging=False)
    reference = fmu.variables["log.path"].valueReference
    before = None
    for k in range(1000):
        fmu.fmu.setString([reference], [str(tmp_path / f"{k}.mcap")])
        if k % 2 == 0:
            fmu.initialize()
        if k % 100 == 0:
            fmu.step(0.0, H)
        free_only(fmu)
        if version == 2:
            fmu.fmu.instantiate(callbacks=fmu.callbacks)
        else:
            fmu.fmu.instantiate()
        before = before or open_things()
    assert open_things() == before
    assert len(os.listdir(tmp_path)) == 500 and not any(f.name.endswith(".part") for f in tmp_path.iterdir())
    fmu.free()


def full_disk(version, required, folder):
    """In a process whose files cannot grow beyond 300 kB, which stands for a full disk."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    fmu = Fmu(FMUS[int(version)])
    fmu.set("log.required", required == "True")
    fmu.initialize(log__path=os.path.join(folder, "run.mcap"))
    resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, resource.RLIM_INFINITY))
    errors, k = 0, 0
    # Larger than a chunk: the flush comes by itself.
    for k in range(1500):
        try:
            fmu.step(k * H / 64.0, H / 64.0)
        except FMICallException:
            errors += 1
            if errors == 2:
                break
    told = [m for m in fmu.messages if "log stopped at simulated time" in m[2]]
    print(json.dumps({"errors": errors, "told": len(told), "status": [m[0] for m in told][:1], "text": told[0][2]}))
    fmu.free()


@both
@pytest.mark.parametrize("required", [True, False])
def test_a_full_disk_is_told_once_or_is_an_error(version, required, tmp_path):
    command = [sys.executable, __file__, "full", str(version), str(required), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout.splitlines()[-1])
    assert "File too large" in said["text"]
    if required:
        assert said["errors"] == 2 and "log.required" in said["text"]
    else:
        assert (said["errors"], said["told"], said["status"]) == (0, 1, [1])
    # Up to its cut the file is whole.
    [file] = os.listdir(tmp_path)
    assert file == "run.mcap.part"
    again = subprocess.run([PROGRAM, "log", "redrive", tmp_path / file, "--check"], capture_output=True, text=True)
    assert again.returncode == 0 and "same bits up to its cut" in again.stdout, again.stdout + again.stderr


def test_the_c_library_logs_alike(tmp_path):
    library = Library(LIBRARY, PATH)
    lib, handle = library.lib, library.handle
    assert lib.sandgate_capabilities() & 32
    reference = ctypes.c_uint32(library.references["log.path"])
    path = tmp_path / "run.mcap"
    library.check(lib.sandgate_set_text(handle, reference, str(path).encode()))
    text = ctypes.c_char_p()
    library.check(lib.sandgate_get_text(handle, reference, ctypes.byref(text)))
    assert text.value.decode() == str(path)
    library.initialize()
    run(library, last=3)
    assert lib.sandgate_step(handle, ctypes.c_double(-1.0), ctypes.c_double(H), None) == 3
    # A state that nobody got is no state to come back to.
    written = ctypes.c_size_t()
    assert lib.sandgate_save(handle, (ctypes.c_uint8 * 1)(), ctypes.c_size_t(1), ctypes.byref(written)) != 0
    library.check(lib.sandgate_terminate(handle))
    library.free()
    assert "3 steps" in runs_again(path)
    found = messages(path)
    refused = [v for topic, v in found if topic == "@c/sandgate_step/reply" and v.status != "ok"]
    assert [v.status for v in refused] == ["range"]
    assert not any(v.state for topic, v in found if topic == "out/applied")
    # One that cannot begin says so with a code of its own.
    library = Library(LIBRARY, PATH)
    library.check(lib.sandgate_set_text(library.handle, reference, str(path).encode()))
    status = lib.sandgate_initialize(library.handle, ctypes.c_double(0.0), ctypes.c_double(1.0))
    assert status == 7 and b"exists already" in lib.sandgate_last_error(library.handle)
    library.free()


def c_log(path):
    """The C library with a log that shall be at `path`, before it is initialised."""
    library = Library(LIBRARY, PATH)
    reference = ctypes.c_uint32(library.references["log.path"])
    library.check(library.lib.sandgate_set_text(library.handle, reference, str(path).encode()))
    return library


def test_a_log_begins_where_the_run_does(tmp_path):
    begun = {}
    for way in ("in one", "in two"):
        library = c_log(tmp_path / f"{way}.mcap")
        lib, handle, start = library.lib, library.handle, ctypes.c_double(2.5)
        end = ctypes.c_double(float("inf"))
        if way == "in one":
            library.check(lib.sandgate_initialize(handle, start, end))
        else:
            library.check(lib.sandgate_enter_initialization(handle, start, end))
            library.check(lib.sandgate_exit_initialization(handle))
        library.step(2.5, H)
        library.free()
        said = json.loads(sandgate("log", "info", "--json", tmp_path / f"{way}.mcap"))
        assert said["metadata"]["segment"]["time"] == "2.5"
        assert said["first_ns"] == 2_500_000_000
        begun[way] = [(c["topic"], c["first_ns"]) for c in said["channels"] if "/@c/" not in c["topic"]]
        assert "same bits" in runs_again(tmp_path / f"{way}.mcap")
    assert begun["in one"] == begun["in two"]


def test_calls_that_change_something_or_are_refused_are_in_the_log_with_what_they_asked(tmp_path):
    path = tmp_path / "run.mcap"
    library = c_log(path)
    lib, handle = library.lib, library.handle
    library.initialize()
    library.check(lib.sandgate_set_threads(handle, 2))
    opening = library.references["gate.sluice.opening"]
    one, found = ctypes.c_size_t(1), ctypes.c_double()
    unknown = ctypes.c_uint32(9999)
    for refused in [
        lib.sandgate_set_threads(handle, 300),
        lib.sandgate_variable_by_name(handle, b"nope", ctypes.byref(unknown)),
        lib.sandgate_set_text(handle, ctypes.c_uint32(opening), b"x"),
        lib.sandgate_get(handle, ctypes.byref(unknown), one, ctypes.byref(found), one),
        lib.sandgate_set(handle, ctypes.byref(ctypes.c_uint32(opening)), one, None, one),
        lib.sandgate_set_text(handle, ctypes.c_uint32(opening), None),
        lib.sandgate_get_text(handle, ctypes.c_uint32(opening), ctypes.byref(ctypes.c_char_p())),
        lib.sandgate_initialize(handle, ctypes.c_double(1.0), ctypes.c_double(2.0)),
    ]:
        assert refused != 0
    library.get(["gate.sluice.opening"])
    library.free()
    asked = [(v.verb.removeprefix("sandgate_"), json.loads(v.body)) for topic, v in messages(path) if topic.endswith("/request")]
    assert asked[1:] == [
        ("set_threads", {"threads": 2}),
        ("set_threads", {"threads": 300}),
        ("variable_by_name", {"name": "nope"}),
        ("set_text", {"gate.sluice.opening": "x"}),
        ("get", {"variables": ["unknown reference 9999"], "count": 1}),
        ("set", {"variables": ["gate.sluice.opening"], "count": 1}),
        ("set_text", {"variables": ["gate.sluice.opening"], "count": 1}),
        ("get_text", {"variables": ["gate.sluice.opening"], "count": 1}),
        ("initialize", {"start": 1.0, "stop": 2.0}),
    ]


def test_tables_have_the_values_that_inputs_had(tmp_path):
    path, table = tmp_path / "run.mcap", tmp_path / "run.csv"
    library = c_log(path)
    library.initialize()
    library.set("saturate_inputs", 1.0)
    library.set("gate.sluice.opening", 5.0)
    assert library.get(["gate.sluice.opening"]) == [1.0]
    library.step(0.0, H)
    library.free()
    sandgate("log", "export", path, "--csv", table)
    with open(table) as file:
        rows = list(csv.DictReader(file))
    assert [float(row["gate.sluice.opening"]) for row in rows][1:] == [1.0]
    # What is done again is what it held; what was asked for stands in the request.
    applied = [v for topic, v in messages(path) if topic == "out/applied"]
    assert [i.values[0] for a in applied for i in a.inputs if i.name == "gate.sluice.opening"][-1] == 1.0
    runs_again(path)


if __name__ == "__main__" and sys.argv[1:2] == ["full"]:
    full_disk(*sys.argv[2:])
