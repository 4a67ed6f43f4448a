"""The FMUs as FMPy sees them: valid, safe with states, unharmed by wrong calls.

Run by tests/it/fmu.rs, which packs the FMUs first.
"""

import ctypes
import math
import os
import struct
import subprocess
import sys
import threading
import zipfile

import pytest
from lxml import etree

sys.path.insert(0, os.path.dirname(__file__))

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from importer import Fmu
from scheduled import FMUS, H, STEPS, run, through_the_c_interface

ENV = os.environ
both = pytest.mark.parametrize("version", [2, 3])


@pytest.fixture(scope="module")
def reference():
    """The series from the plain C interface with one thread."""
    return through_the_c_interface()


@pytest.mark.parametrize("path", ENV["SANDGATE_FMUS"].split(os.pathsep))
def test_fmpy_finds_no_fault(path):
    assert validate_fmu(path) == []


@pytest.mark.parametrize("path", ENV["SANDGATE_FMUS"].split(os.pathsep))
def test_the_description_is_complete(path):
    description = fmpy.read_model_description(path)
    experiment = description.defaultExperiment
    assert None not in (experiment.startTime, experiment.stopTime, experiment.tolerance, experiment.stepSize)
    assert all(unit.baseUnit is not None for unit in description.unitDefinitions)
    for variable in description.modelVariables:
        assert variable.description, variable.name
        assert variable.unit or variable.type not in ("Real", "Float64"), variable.name
    cs = description.coSimulation
    assert cs.canGetAndSetFMUstate and cs.canSerializeFMUstate and cs.canHandleVariableCommunicationStepSize
    assert not (cs.needsExecutionTool or cs.canBeInstantiatedOnlyOncePerProcess)
    assert all(unknown.dependencies == [] for unknown in description.outputs)
    assert description.initialUnknowns
    for unknown in description.initialUnknowns:
        assert unknown.dependencies, unknown.variable.name
        assert {(v.causality, v.variability) for v in unknown.dependencies} == {("parameter", "fixed")}


@both
def test_the_archive_is_plain(version):
    with zipfile.ZipFile(FMUS[version]) as archive:
        for entry in archive.infolist():
            assert entry.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
            assert "\\" not in entry.orig_filename and not entry.filename.startswith("/")
            assert entry.date_time == (1980, 1, 1, 0, 0, 0)
        with open(ENV["SANDGATE_SCENE"], "rb") as file:
            assert archive.read("resources/scene.toml") == file.read()
        page = archive.read("documentation/index.html").decode()
        assert "gauge.surface.depth[1]" in page
        assert "<td>1</td><td>0 to 256</td><td>threads" in page and "<td>false</td><td>false to true</td>" in page
        assert b"Apache License" in archive.read("documentation/licenses/license.txt")


def test_an_icon_and_a_terminal_for_every_device():
    with zipfile.ZipFile(FMUS[2]) as archive:
        assert archive.read("model.png").startswith(b"\x89PNG")
    with zipfile.ZipFile(FMUS[3]) as archive:
        assert archive.read("terminalsAndIcons/icon.png").startswith(b"\x89PNG")
        etree.fromstring(archive.read("terminalsAndIcons/icon.svg"))
        terminals = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
    schema = os.path.join(os.path.dirname(fmpy.__file__), "schema", "fmi3", "fmi3TerminalsAndIcons.xsd")
    etree.XMLSchema(file=schema).assertValid(terminals)
    description = fmpy.read_model_description(FMUS[3])
    variables = {v.name: v for v in description.modelVariables}
    names = [t.get("name") for t in terminals.iter("Terminal")]
    assert len(set(names)) == len(names)
    assert {"gate.sluice", "inflow.feed", "gauge.surface"} <= set(names)
    members = [m.get("variableName") for m in terminals.iter("TerminalMemberVariable")]
    assert len(set(members)) == len(members)
    assert set(members) <= set(variables)
    inputs = {name for name, v in variables.items() if v.causality == "input"}
    assert inputs and inputs <= set(members)


def test_fmi_3_arrays_and_their_elements_agree():
    fmu = Fmu(FMUS[3]).initialize(gate__sluice__opening=1.0)
    run(fmu, last=4)
    array = fmu.variables["gauge.surface.depth"]
    count = int(array.dimensions[0].start)
    elements = fmu.get([f"gauge.surface.depth[{k + 1}]" for k in range(count)])
    assert fmu.fmu.getFloat64([array.valueReference], nValues=count) == elements
    assert any(depth > 0.0 for depth in elements)
    with pytest.raises(FMICallException):
        fmu.fmu.getFloat64([array.valueReference], nValues=count - 1)
    fmu.free()


@both
@pytest.mark.parametrize("mode", ["instantiated", "stepping"])
def test_a_state_goes_on_in_another_process(version, mode, reference, tmp_path):
    half = STEPS // 2
    fmu = Fmu(FMUS[version]).initialize()
    assert run(fmu, last=half) == reference[:half]
    path = tmp_path / "state"
    path.write_bytes(fmu.save())
    assert run(fmu, first=half) == reference[half:]
    fmu.free()
    command = [sys.executable, __file__, "continue", str(version), mode, str(path), str(half)]
    other = subprocess.run(command, capture_output=True, text=True)
    assert other.returncode == 0, other.stderr
    assert [[int(v) for v in line.split()] for line in other.stdout.splitlines()] == reference[half:]


def go_on(version, mode, path, first):
    """The other process."""
    fmu = Fmu(FMUS[int(version)])
    if mode == "stepping":
        fmu.initialize(gate__sluice__opening=0.25)
        fmu.step(0.0, H / 3.0)
    with open(path, "rb") as file:
        fmu.restore(file.read())
    for row in run(fmu, first=int(first)):
        print(*row)
    fmu.free()


@both
def test_going_back_reset_and_a_second_instance(version, reference):
    fmu, other = Fmu(FMUS[version]).initialize(), Fmu(FMUS[version]).initialize()
    assert run(fmu, last=4) == reference[:4]
    state = fmu.get_state()
    assert run(other, last=2) == reference[:2]
    assert run(fmu, first=4, last=10) == reference[4:10]
    fmu.set_state(state)
    assert run(fmu, first=4, last=10) == reference[4:10]
    fmu.free_state(state)
    assert run(other, first=2, last=8) == reference[2:8]
    other.free()
    fmu.reset()
    fmu.initialize()
    assert run(fmu, last=6) == reference[:6]
    fmu.free()


def refused(fmu, call, *texts):
    """The call answers Error, the last message says why, and nothing changed."""
    before = fmu.save()
    fmu.messages.clear()
    with pytest.raises(FMICallException) as error:
        call()
    assert error.value.status == 3
    status, category, message = fmu.messages[-1]
    assert (status, category) == (3, "logStatusError")
    for text in texts:
        assert text in message
    assert fmu.save() == before


@both
def test_wrong_calls_are_refused_and_leave_no_trace(version, reference):
    fmu = Fmu(FMUS[version])
    gate = "gate.sluice.opening"
    refused(fmu, lambda: fmu.step(0.0, H), "DoStep", "not allowed in mode Instantiated", "allowed in Stepping")
    refused(fmu, fmu.fmu.exitInitializationMode, "not allowed in mode Instantiated")
    refused(fmu, fmu.fmu.terminate, "not allowed in mode Instantiated")
    fmu.initialize(stop=10.0)
    assert run(fmu, last=2) == reference[:2]
    t = 2 * H
    refused(fmu, fmu.fmu.enterInitializationMode, "not allowed in mode Stepping")
    for h in (0.0, -H, math.nan, math.inf):
        refused(fmu, lambda: fmu.step(t, h), "DoStep", "h: found")
    for time in (0.0, t + H, math.nan):
        refused(fmu, lambda: fmu.step(time, H), "DoStep", "current time")
    refused(fmu, lambda: fmu.step(t, 11.0), "10 s, the stop time")
    for value in (math.nan, math.inf, -0.5, 1.5):
        refused(fmu, lambda: fmu.set(gate, value), gate, "found", "allowed a number from 0 to 1")
    refused(fmu, lambda: fmu.set("gauge.depth.depth", 1.0), "found an output")
    refused(fmu, lambda: fmu.set("solver.threads", -1), "solver.threads", "0 to 256")
    reals = {2: "Real", 3: "Float64"}[version]
    getter, setter = (getattr(fmu.fmu, action + reals) for action in ("get", "set"))
    refused(fmu, lambda: getter([9999]), "9999", "allowed 0 to")
    validity = fmu.variables["gauge.depth.validity"].valueReference
    refused(fmu, lambda: getter([validity]), "gauge.depth.validity", "integer", "real")
    place = fmu.variables[gate].valueReference
    refused(fmu, lambda: setter([place, 9999], [0.5, 0.5]), "9999")
    refused(fmu, lambda: setter([place, place], [0.5, 7.0]), gate)
    assert run(fmu, first=2, last=8) == reference[2:8]
    fmu.fmu.terminate()
    refused(fmu, lambda: fmu.step(8 * H, H), "not allowed in mode Terminated")
    fmu.free()


@both
def test_bad_states_are_refused_and_leave_no_trace(version, reference):
    fmu = Fmu(FMUS[version]).initialize()
    run(fmu, last=3)
    good = fmu.save()
    turned = bytearray(good)
    turned[len(good) // 2] ^= 1
    for bad in (b"\0", good[:-1], good[: len(good) // 2], good + b"\0", bytes(turned), b"\0" * len(good)):
        refused(fmu, lambda: fmu.restore(bad), "saved state refused")
    with pytest.raises(FMICallException):
        fmu.set_state(None)
    assert run(fmu, first=3, last=8) == reference[3:8]
    fmu.free()


def test_a_state_goes_between_versions(reference):
    fmu2, fmu3 = Fmu(FMUS[2]).initialize(), Fmu(FMUS[3])
    run(fmu2, last=5)
    fmu3.restore(fmu2.save())
    assert run(fmu3, first=5, last=8) == reference[5:8]
    fmu2.free()
    fmu3.free()


def test_fmi_2_without_setup_experiment_and_parameters_in_initialization_mode(reference):
    fmu = Fmu(FMUS[2])
    fmu.fmu.enterInitializationMode()
    fmu.set("solver.threads", 2)
    fmu.set("gate.sluice.opening", 0.0)
    fmu.fmu.exitInitializationMode()
    assert run(fmu, last=4) == reference[:4]
    fmu.free()


def test_fmi_2_ramps_an_input_within_a_step():
    """A slope gives what the same straight line in many small steps tends to: the gate ends where the line ends."""
    fmu = Fmu(FMUS[2]).initialize()
    gate = fmu.variables["gate.sluice.opening"].valueReference
    vr, order, slope = (fmpy.fmi2.fmi2ValueReference * 1)(gate), (fmpy.fmi2.fmi2Integer * 1)(1), (
        fmpy.fmi2.fmi2Real * 1)(0.125 / H)
    fmu.fmu.fmi2SetRealInputDerivatives(fmu.fmu.component, vr, 1, order, slope)
    fmu.step(0.0, H)
    assert fmu.get(["gate.sluice.opening"]) == [0.125]
    h, t = 0.003, H
    for k in range(5):
        # Slopes that end at 1 but for rounding are no mistake, others are. Value and slope come in any order.
        calls = [lambda: fmu.set("gate.sluice.opening", 0.1 + 0.17 * k),
                 lambda: fmu.fmu.fmi2SetRealInputDerivatives(fmu.fmu.component, vr, 1, order, slope)]
        slope[0] = (1.0 - (0.1 + 0.17 * k)) / h
        for call in calls if k % 2 else reversed(calls):
            call()
        fmu.step(t, h)
        t += h
        assert fmu.get(["gate.sluice.opening"])[0] == pytest.approx(1.0, abs=1e-15)
    slope[0] = 0.1
    fmu.fmu.fmi2SetRealInputDerivatives(fmu.fmu.component, vr, 1, order, slope)
    refused(fmu, lambda: fmu.step(t, h), "by its slope 0.1")
    refused(fmu, lambda: fmu.fmu.fmi2SetRealInputDerivatives(
        fmu.fmu.component, vr, 1, (fmpy.fmi2.fmi2Integer * 1)(2), slope), "order: found 2")
    fmu.free()


@both
def test_nothing_is_logged_when_logging_is_off(version):
    fmu = Fmu(FMUS[version], logging=False).initialize()
    with pytest.raises(FMICallException):
        fmu.step(1.0, H)
    run(fmu, last=1)
    assert fmu.messages == []
    fmu.fmu.setDebugLogging(True, ["logEvents"])
    run(fmu, first=1, last=2)
    assert [category for _, category, _ in fmu.messages] == ["logEvents"]
    assert "internal steps" in fmu.messages[0][2]
    fmu.fmu.setDebugLogging(False, ["logAll"])
    fmu.messages.clear()
    run(fmu, first=2, last=3)
    assert fmu.messages == []
    fmu.fmu.setDebugLogging(True, ["logAll"])
    run(fmu, first=3, last=4)
    with pytest.raises(FMICallException):
        fmu.step(1.0, H)
    assert [category for _, category, _ in fmu.messages] == ["logEvents", "logStatusError"]
    with pytest.raises(FMICallException):
        fmu.fmu.setDebugLogging(True, ["logNothing"])
    assert "found logNothing, allowed logStatusError" in fmu.messages[-1][2]
    fmu.free()


@both
def test_named_categories_are_those_that_are_on_in_fmi_2_and_switched_in_fmi_3(version):
    fmu = Fmu(FMUS[version], logging=True).initialize()
    steps = iter(range(10))

    def categories(on, names):
        fmu.fmu.setDebugLogging(on, names)
        fmu.messages.clear()
        k = next(steps)
        run(fmu, first=k, last=k + 1)
        with pytest.raises(FMICallException):
            fmu.step(1000.0, H)
        return [category for _, category, _ in fmu.messages]

    narrowed = categories(True, ["logStatusError"])
    assert narrowed == (["logStatusError"] if version == 2 else ["logEvents", "logStatusError"])
    events = categories(True, ["logEvents"])
    assert events == (["logEvents"] if version == 2 else ["logEvents", "logStatusError"])
    off = categories(False, ["logStatusError"])
    assert off == ([] if version == 2 else ["logEvents"])
    assert categories(True, []) == ["logEvents", "logStatusError"]
    fmu.free()


@both
def test_the_library_leaves_the_process_as_it_was(version):
    """No thread outlives the instance; directory, locale, environment, signals and floating-point mode stay."""

    def surroundings():
        import locale
        with open("/proc/self/status") as file:
            kept = ("Threads", "SigBlk", "SigIgn", "SigCgt")
            threads = [line for line in file if line.startswith(kept)]
        # fenv_t of glibc on x86-64: control word of the x87 first, MXCSR last; its six flags of past exceptions may change.
        fenv = ctypes.create_string_buffer(32)
        assert ctypes.CDLL(None).fegetenv(fenv) == 0
        control, mxcsr = struct.unpack_from("<H", fenv, 0)[0], struct.unpack_from("<I", fenv, 28)[0]
        return threads, control, mxcsr & ~0x3F, os.getcwd(), locale.setlocale(locale.LC_ALL), dict(os.environ)

    before = surroundings()
    fmu = Fmu(FMUS[version]).initialize(solver__threads=3)
    run(fmu, last=2)
    fmu.free()
    assert surroundings() == before


@both
def test_clamped_inputs_are_reported(version):
    fmu = Fmu(FMUS[version]).initialize()
    gate = "gate.sluice.opening"
    fmu.set(gate, 1.0 + 1e-10)
    assert fmu.get([gate]) == [1.0] and not any(category == "logStatusWarning" for _, category, _ in fmu.messages)
    fmu.set("saturate_inputs", True)
    fmu.messages.clear()
    fmu.set(gate, -2.5)
    assert fmu.get([gate]) == [0.0]
    [(status, category, message)] = fmu.messages
    assert (status, category) == (1, "logStatusWarning")
    for text in (gate, "found -2.5", "clamped to 0"):
        assert text in message
    refused(fmu, lambda: fmu.set(gate, math.nan), gate, "found NaN")
    fmu.free()


@both
def test_the_logger_is_called_from_the_calling_thread(version):
    fmu = Fmu(FMUS[version]).initialize(solver__threads=2)
    run(fmu, last=2)
    with pytest.raises(FMICallException):
        fmu.step(99.0, H)
    assert fmu.logging_threads == {threading.get_native_id()}
    fmu.free()


class Raw:
    """Instances without FMPy between: any resource location, no logger."""

    def __init__(self, version):
        self.made = Fmu(FMUS[version])
        self.version = version
        self.lib = ctypes.CDLL(self.made.fmu.dll._name)
        self.instantiate = self.lib.fmi2Instantiate if version == 2 else self.lib.fmi3InstantiateCoSimulation
        self.instantiate.restype = ctypes.c_void_p
        description = self.made.description
        self.token = (description.guid if version == 2 else description.instantiationToken).encode()

    def instance(self, location=None):
        if self.version == 2:
            callbacks = fmpy.fmi2.fmi2CallbackFunctions()
            made = self.instantiate(b"raw", 1, self.token, location, ctypes.byref(callbacks), 0, 1)
        else:
            no = ctypes.c_bool(False)
            yes = ctypes.c_bool(True)
            made = self.instantiate(b"raw", self.token, location, no, yes, no, no, None, ctypes.c_size_t(0), None, None, None)
        assert made
        return ctypes.c_void_p(made)

    def call(self, name, *arguments):
        status = getattr(self.lib, f"fmi{self.version}{name}")(*arguments)
        assert status == 0, (name, status)

    def free(self, instance):
        getattr(self.lib, f"fmi{self.version}FreeInstance")(instance)


@both
def test_any_resource_location_will_do(version):
    """And a NULL logger with logging on does no harm."""
    raw = Raw(version)
    double, size = ctypes.c_double, ctypes.c_size_t
    locations = [None, b"", b"/nowhere", b"/with space/", b"file:/x", b"file:///x", b"file:///x/", b"file://localhost/x",
                 b"file:///with%20space/%C3%BC", "file:///ü".encode(), "/ü/".encode(), b"C:\\x", b"%%%"]
    for location in locations:
        instance = raw.instance(location)
        if version == 2:
            raw.call("EnterInitializationMode", instance)
        else:
            raw.call("EnterInitializationMode", instance, False, double(0.0), double(0.0), False, double(0.0))
        raw.call("ExitInitializationMode", instance)
        # Refused, with nobody to tell.
        getattr(raw.lib, f"fmi{version}DoStep")(instance, double(5.0), double(H), 1, None, None, None, None)
        raw.free(instance)
    raw.made.free()


def open_things():
    return len(os.listdir("/proc/self/task")), len(os.listdir("/proc/self/fd"))


@both
def test_a_thousand_instances_leave_nothing_behind(version):
    raw = Raw(version)
    threads = raw.made.variables["solver.threads"].valueReference
    kind = (ctypes.c_int32, "SetInteger") if version == 2 else (ctypes.c_int64, "SetInt64")
    reference, two, one = (ctypes.c_uint32 * 1)(threads), (kind[0] * 1)(2), ctypes.c_size_t(1)
    before = open_things()
    for k in range(1000):
        instance = raw.instance()
        if k % 10 == 0:
            raw.call(kind[1], instance, reference, one, two, *([] if version == 2 else [one]))
        raw.free(instance)
    assert open_things() == before
    raw.made.free()


@both
def test_a_thousand_states_leave_no_memory_behind(version):
    """With 16 times the particles, so that a state is large beside what allocators keep."""

    def resident():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    fmu = Fmu(FMUS[version], logging=False)
    fmu.initialize(solver__resolution_scale=4.0)
    fmu.step(0.0, H)
    size = len(fmu.save())
    assert size > 150_000

    def cycle(count):
        for _ in range(count):
            state = fmu.get_state()
            fmu.set_state(state)
            fmu.free_state(state)

    cycle(50)
    before = resident()
    cycle(1000)
    assert resident() - before < size
    fmu.free()


if __name__ == "__main__" and sys.argv[1:2] == ["continue"]:
    go_on(*sys.argv[2:])
