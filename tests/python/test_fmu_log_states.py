"""Logs of FMUs and states: where a log cannot begin or breaks off, what is left of a run, and values that are zero or ramp.

Run by tests/it/fmu.rs, which packs the FMUs first.

SANDGATE_PROGRAM  the program
"""

import csv
import ctypes
import os
import resource
import signal
import subprocess
import sys

import pytest

sys.path.insert(0, os.path.dirname(__file__))

import fmpy
from fmpy.fmi1 import FMICallException

from importer import Fmu, Library, bits
from scheduled import FMUS, H, LIBRARY, PATH

PROGRAM = os.environ["SANDGATE_PROGRAM"]
GATE = "gate.sluice.opening"
TERMINATED = 3
both = pytest.mark.parametrize("version", [2, 3])


def sandgate(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def runs_again(path):
    said = sandgate("log", "redrive", path, "--check")
    assert "same bits" in said and "and the state at the end" in said, said


def exported(path):
    table = path.with_suffix(".csv")
    sandgate("log", "export", path, "--csv", table)
    with open(table, newline="") as file:
        return list(csv.DictReader(file))


def state_after_a_step(version):
    fmu = Fmu(FMUS[version]).initialize()
    fmu.step(0.0, H)
    saved = fmu.save()
    fmu.free()
    return saved


def refused(call, *arguments):
    try:
        call(*arguments)
    except FMICallException:
        return True
    return False


@both
def test_a_state_whose_log_cannot_begin_is_refused_and_changes_nothing(version, tmp_path):
    saved = state_after_a_step(version)
    fmu = Fmu(FMUS[version])
    fmu.set("log.required", True)
    fmu.set("log.path", str(tmp_path / "nowhere" / "run.mcap"))
    before = fmu.save()
    assert refused(fmu.restore, saved)
    assert "nowhere" in fmu.messages[-1][2]
    assert fmu.save() == before and fmu.get(["time"]) == [0.0]
    # It is only instantiated, as it was: the path may be corrected.
    path = tmp_path / "run.mcap"
    fmu.set("log.path", str(path))
    fmu.restore(saved)
    fmu.step(H, H)
    fmu.free()
    runs_again(path)
    assert [float(row["time"]) for row in exported(path)] == [H, 2 * H]


@both
def test_a_state_goes_without_a_log_that_is_not_required_and_that_is_told_once(version, tmp_path):
    fmu = Fmu(FMUS[version])
    fmu.set("log.required", False)
    fmu.set("log.path", str(tmp_path / "nowhere" / "run.mcap"))
    fmu.restore(state_after_a_step(version))
    fmu.step(H, H)
    told = [status for status, _, text in fmu.messages if "nowhere" in text]
    assert told == [1] and fmu.get(["time"]) == [2 * H]
    fmu.free()


def test_the_c_library_refuses_such_a_state_too(tmp_path):
    saved = state_after_a_step(3)
    library = Library(LIBRARY, PATH)
    lib, handle = library.lib, library.handle
    path = ctypes.c_uint32(library.references["log.path"])
    library.set("log.required", 1.0)
    library.check(lib.sandgate_set_text(handle, path, str(tmp_path / "nowhere" / "run.mcap").encode()))
    mode = ctypes.c_int32(-1)
    assert lib.sandgate_restore(handle, saved, ctypes.c_size_t(len(saved))) == 7
    library.check(lib.sandgate_get_mode(handle, ctypes.byref(mode)))
    assert mode.value == 0 and library.get(["time"]) == [0.0]
    library.free()


def step_until_the_disk_is_full(step):
    """Files cannot grow beyond 300 kB, which stands for a full disk. Larger than a chunk: the flush comes by itself."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, resource.RLIM_INFINITY))
    t = 0.0
    for _ in range(1500):
        failed = step(t, H / 64.0)
        t += H / 64.0
        if failed:
            return t
    raise AssertionError("there is room for all of it")


def rescued_fmu(version, folder):
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    fmu = Fmu(FMUS[int(version)])
    fmu.set("log.required", True)
    fmu.initialize(log__path=os.path.join(folder, "run.mcap"))
    early = fmu.save()
    t = step_until_the_disk_is_full(lambda t, h: refused(fmu.step, t, h))
    # The step in which it failed was done; the state can be had, and nothing goes on.
    late = fmu.save()
    assert fmu.get(["time"]) == [t]
    assert refused(fmu.step, t, H) and refused(fmu.restore, early)
    assert "states can be saved" in fmu.messages[-1][2]
    assert fmu.save() == late
    # Without the log it does.
    fmu.reset()
    fmu.restore(late)
    fmu.step(t, H)
    assert fmu.get(["time"]) == [t + H]
    fmu.free()


def rescued_c(folder):
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    library = Library(LIBRARY, PATH)
    lib, handle = library.lib, library.handle
    path = ctypes.c_uint32(library.references["log.path"])
    library.set("log.required", 1.0)
    library.check(lib.sandgate_set_text(handle, path, os.path.join(folder, "run.mcap").encode()))
    library.initialize()

    def saved():
        size = ctypes.c_size_t()
        library.check(lib.sandgate_save_size(handle, ctypes.byref(size)))
        state = (ctypes.c_uint8 * size.value)()
        library.check(lib.sandgate_save(handle, state, size, ctypes.byref(size)))
        return bytes(state)

    def step(t, h):
        return lib.sandgate_step(handle, ctypes.c_double(t), ctypes.c_double(h), None)

    early = saved()
    t = step_until_the_disk_is_full(step)
    late = saved()
    assert step(t, H) == 7 and lib.sandgate_restore(handle, early, ctypes.c_size_t(len(early))) == 7
    assert saved() == late and library.get(["time"]) == [t]
    # The end says that the log is not whole, and is the end.
    assert lib.sandgate_terminate(handle) == 7
    mode = ctypes.c_int32()
    library.check(lib.sandgate_get_mode(handle, ctypes.byref(mode)))
    assert mode.value == TERMINATED
    library.free()


@pytest.mark.parametrize("interface", ["2", "3", "c"])
def test_a_run_whose_required_log_broke_off_can_be_rescued(interface, tmp_path):
    command = [sys.executable, __file__, interface, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def ramp(fmu, name, slope):
    reference = fmu.variables[name].valueReference
    fmu.fmu.fmi2SetRealInputDerivatives(
        fmu.fmu.component, (fmpy.fmi2.fmi2ValueReference * 1)(reference), 1, (fmpy.fmi2.fmi2Integer * 1)(1),
        (fmpy.fmi2.fmi2Real * 1)(slope))


def test_tables_have_the_values_to_which_inputs_ramped(tmp_path):
    path = tmp_path / "run.mcap"
    fmu = Fmu(FMUS[2]).initialize(log__path=str(path), saturate_inputs=True)
    held = []

    def step(slope):
        if slope:
            ramp(fmu, GATE, slope)
        fmu.step(len(held) * H, H)
        held.append(fmu.get([GATE])[0])

    fmu.set(GATE, 0.1)
    step(0.3 / H)
    step(0.0)
    # Saved with its slope, tried, and done again.
    ramp(fmu, GATE, 0.2 / H)
    state = fmu.get_state()
    fmu.step(2 * H, H)
    fmu.set(GATE, 0.9)
    fmu.set_state(state)
    fmu.free_state(state)
    step(0.0)
    # Beyond its range, where it is clamped; from which a value that is set drops the slope.
    step(5.0 / H)
    ramp(fmu, GATE, -0.1 / H)
    fmu.set(GATE, 0.25)
    step(0.0)
    fmu.free()
    assert held[1] == held[0] and held[3:] == [1.0, 0.25]
    rows = exported(path)
    assert [bits(float(row[GATE])) for row in rows[1:]] == [bits(value) for value in held]
    runs_again(path)


@both
def test_zeros_of_either_sign_run_again(version, tmp_path):
    path = tmp_path / "run.mcap"
    fmu = Fmu(FMUS[version])
    fixed = [
        v.name for v in fmu.description.modelVariables
        if v.causality == "parameter" and v.variability == "fixed" and v.type in ("Real", "Float64") and float(v.start) == 0.0]
    assert fixed
    for name in fixed:
        fmu.set(name, -0.0)
    if version == 2:
        ramp(fmu, GATE, -0.0)
    fmu.initialize(log__path=str(path))
    fmu.set(GATE, -0.0)
    fmu.step(-0.0, H)
    fmu.step(H, H)
    fmu.fmu.terminate()
    fmu.free()
    runs_again(path)


@both
def test_an_instance_goes_as_far_as_it_was_told_itself(version):
    fmu = Fmu(FMUS[version]).initialize(stop=H)
    state = fmu.get_state()
    saved = fmu.save()
    for back in (lambda: fmu.set_state(state), lambda: fmu.restore(saved)):
        fmu.reset()
        fmu.initialize(stop=2 * H)
        back()
        fmu.step(0.0, H)
        fmu.step(H, H)
        assert refused(fmu.step, 2 * H, H)
    # Told nothing, FMI 2 goes as far as the one whose state is still in memory; bytes and FMI 3 have no end.
    fmu.reset()
    fmu.set_state(state)
    fmu.step(0.0, H)
    assert refused(fmu.step, H, H) == (version == 2)
    fmu.reset()
    fmu.restore(saved)
    fmu.step(0.0, H)
    fmu.step(H, H)
    fmu.free_state(state)
    fmu.free()


if __name__ == "__main__":
    if sys.argv[1] == "c":
        rescued_c(sys.argv[2])
    else:
        rescued_fmu(*sys.argv[1:3])
