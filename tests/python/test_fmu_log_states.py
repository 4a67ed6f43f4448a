"""Logs of FMUs and states: where a log cannot begin or breaks off, what is left of a run, and values that are zero or ramp.

Run by tests/it/fmu.rs, which packs the FMUs first.

SANDGATE_PROGRAM  the program
"""

import csv
import ctypes
import os
import pathlib
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
    # Without the log it does, and nothing says that it does not.
    fmu.messages.clear()
    fmu.reset()
    told = [text for _, _, text in fmu.messages if "log stopped at" in text]
    assert len(told) == 1 and "goes on without it" in told[0] and "so the run stops" not in told[0], told
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
    # Beyond its range, where it is clamped; and with a value that is set after the slope.
    step(5.0 / H)
    ramp(fmu, GATE, -0.125 / H)
    fmu.set(GATE, 0.25)
    step(0.0)
    fmu.free()
    assert held[1] == held[0] and held[3:] == [1.0, 0.125]
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


def logging_library(folder, settings, **parameters):
    """The C library with a scene whose log does not depend on the clock, and where that log goes."""
    scene = os.path.join(folder, "scene.toml")
    with open(PATH) as usual, open(scene, "w") as file:
        file.write(usual.read() + f"\n[log]\ndeterministic = true\n{settings}\n")
    library = Library(LIBRARY, scene)
    for name, value in parameters.items():
        library.set(name.replace("__", "."), value)
    path = ctypes.c_uint32(library.references["log.path"])
    library.check(library.lib.sandgate_set_text(library.handle, path, os.path.join(folder, "run.mcap").encode()))
    return library


def limit_files(size):
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))


def begins_again_c(folder):
    """A required log fails at the very start, in its first bytes or in the messages of the start: nothing has happened."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    for size in (1000, 20_000, 30_000):
        library = logging_library(folder, "required = true")
        limit_files(size)
        mode = ctypes.c_int32(-1)
        start = library.lib.sandgate_initialize(library.handle, ctypes.c_double(0.5), ctypes.c_double(9.0))
        assert start == 7, size
        library.check(library.lib.sandgate_get_mode(library.handle, ctypes.byref(mode)))
        assert (mode.value, library.get(["time"])) == (0, [0.0])
        assert os.listdir(folder) == ["scene.toml"]
        limit_files(resource.RLIM_INFINITY)
        library.initialize()
        library.step(0.0, H)
        library.free()
        runs_again(pathlib.Path(folder, "run.mcap"))
        os.remove(os.path.join(folder, "run.mcap"))


def goes_on_c(folder):
    """A log over several files breaks off, and goes on in the next one as soon as there is room."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    library = logging_library(folder, f"required = false\nrotate_every = {2 * H}").initialize()
    for k in range(12):
        limit_files(20_000 if 3 <= k < 7 else resource.RLIM_INFINITY)
        library.step(k * H, (k + 1) * H - k * H)
    library.check(library.lib.sandgate_terminate(library.handle))
    library.free()
    files = sorted(name for name in os.listdir(folder) if name.startswith("run"))
    assert sum(name.endswith(".part") for name in files) == 1, files
    assert "run-0-0000.mcap" in files and len(files) > 3, files
    for name in files:
        if not name.endswith(".part"):
            runs_again(pathlib.Path(folder, name))


@pytest.mark.parametrize("what", ["begins_again_c", "goes_on_c"])
def test_a_log_that_met_a_full_disk_begins_again_where_there_is_room(what, tmp_path):
    done = subprocess.run([sys.executable, __file__, what, str(tmp_path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_what_one_call_sets_beside_saturate_inputs_runs_again(tmp_path):
    library = logging_library(str(tmp_path), "required = true").initialize()
    both_at_once = (ctypes.c_uint32 * 2)(library.references["saturate_inputs"], library.references[GATE])
    two = ctypes.c_size_t(2)
    library.check(library.lib.sandgate_set(library.handle, both_at_once, two, (ctypes.c_double * 2)(1.0, 5.0), two))
    assert library.get([GATE]) == [1.0]
    library.step(0.0, H)
    library.check(library.lib.sandgate_terminate(library.handle))
    library.free()
    path = tmp_path / "run.mcap"
    runs_again(path)
    assert [float(row[GATE]) for row in exported(path)][-1] == 1.0


def test_the_account_of_mass_follows_parameters_and_stays_at_the_last_good_step():
    library = Library(LIBRARY, PATH)
    lib, handle = library.lib, library.handle

    def ledger():
        account = (ctypes.c_double * 4)()
        library.check(lib.sandgate_get_ledger(handle, account))
        return list(account)

    names = ["mass.initial", "mass.inflow", "mass.outflow", "mass.present"]
    before = ledger()
    parameter = next(name for name in library.references if name.startswith("body.") and name.endswith("upper_y"))
    library.set(parameter, 0.75 * library.get([parameter])[0])
    assert ledger() != before and ledger() == library.get(names)
    library.free()


if __name__ == "__main__":
    if sys.argv[1] == "c":
        rescued_c(sys.argv[2])
    elif sys.argv[1].endswith("_c"):
        globals()[sys.argv[1]](sys.argv[2])
    else:
        rescued_fmu(*sys.argv[1:3])
