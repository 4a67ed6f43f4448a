"""Other people's co-simulation drivers step our FMUs and read what the plain C interface gives: ecos, libcosim.

SANDGATE_SCENE    a scene with a gate `main` and a gauge `level`
SANDGATE_CASES    FMUs of all cases for FMI 2
SANDGATE_LIBRARY  the shared library; SANDGATE_FMU2, SANDGATE_FMU3 the scene packed. Run by tests/it/drivers.rs.
"""

import os
import re
import subprocess
import sys

import pytest

sys.path.insert(0, os.path.dirname(__file__))

from importer import Library, bits

ENV = os.environ
FMUS = {2: ENV["SANDGATE_FMU2"], 3: ENV["SANDGATE_FMU3"]}
# Dyadic: drivers that add steps up and those that count nanoseconds meet the same times.
H = 1.0 / 256.0
NANOSECONDS = 3_906_250
STEPS = 12
NAMES = ["gate.main.actual_opening", "gauge.level.depth", "outflow.drain.rate", "mass.present"]


@pytest.fixture(scope="module")
def reference():
    library = Library(ENV["SANDGATE_LIBRARY"], ENV["SANDGATE_SCENE"]).initialize()
    library.set("gate.main.opening", 1.0)
    for k in range(STEPS):
        library.step(k * H, H)
    values = [bits(v) for v in library.get(NAMES)]
    library.free()
    return values


def run(driver, version, *arguments):
    """A driver in a process of its own: they print from C++ and keep to themselves what they load."""
    command = [sys.executable, __file__, driver, FMUS[version], *arguments]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    (values,) = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("values ")]
    return [int(v) for v in values], done.stdout + done.stderr


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("threads", ["1", "2"])
def test_ecos(version, threads, reference):
    values, said = run("ecos", version, threads)
    assert values == reference
    assert "[error]" not in said
    # Known: ecos reads numbers, booleans and texts, and says of other types that it leaves them out.
    odd = [line for line in said.splitlines() if "[warning]" in line and "unsupported type" not in line]
    assert odd == []


def test_libcosim(reference):
    values, said = run("cosim", 2)
    assert values == reference
    assert "[FMI Library: FMI2XML] Parsing XML element ModelVariables" in said, "its log was not caught"
    complaints = [line for line in said.splitlines() if re.search(r"\[(warning|error|fatal)\]", line)]
    assert [line for line in complaints if "FMI Library" in line] == []
    # Known: libcosim itself, not FMI Library, reads numbers, booleans and texts and leaves enumerations out.
    assert [line for line in complaints if "Enumeration variable type not supported" not in line] == []


def test_fmi_library_has_no_complaint_about_any_case():
    """libcosim reads each description with FMI Library and makes an instance; all in one process, whose log is read."""
    cases = ENV["SANDGATE_CASES"].split(os.pathsep)
    assert len(cases) > 20
    done = subprocess.run([sys.executable, __file__, "load", *cases], capture_output=True, text=True)
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    # It reads each once or more.
    assert said.count("[FMI Library: FMI2XML] Parsing XML element ModelVariables") >= len(cases), "its log was not caught"
    complaints = [line for line in said.splitlines() if re.search(r"\[(warning|error|fatal)\]", line)]
    assert [line for line in complaints if "Enumeration variable type not supported" not in line] == []


def load(*paths):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.TRACE)
    for path in paths:
        execution = CosimExecution.from_step_size(NANOSECONDS)
        assert execution.add_local_slave(CosimLocalSlave(path, "instance")) >= 0
    return []


def ecos(path, threads):
    # ecospy's library needs oneTBB, which its package does not bring; the package `tbb` puts it here.
    import ctypes

    ctypes.CDLL(os.path.join(sys.prefix, "lib", "libtbb.so.12"), ctypes.RTLD_GLOBAL)
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

    EcosLib.set_log_level("debug")
    with EcosSimulationStructure() as structure:
        structure.add_model("silo", path)
        structure.add_parameter_set("start", {"silo::solver.threads": int(threads)})
        with EcosSimulation(structure=structure, step_size=H) as simulation:
            assert simulation.init(parameter_set="start")
            simulation.set_real("silo::gate.main.opening", 1.0)
            assert simulation.step(STEPS) == STEPS * H
            values = [simulation.get_real("silo::" + name) for name in NAMES]
            simulation.terminate()
    return values


def cosim(path):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.TRACE)
    execution = CosimExecution.from_step_size(NANOSECONDS)
    silo = execution.add_local_slave(CosimLocalSlave(path, "silo"))
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    assert execution.add_observer(observer) and execution.add_manipulator(manipulator)
    rows = {row.name.decode(): row.reference for row in execution.slave_variables(silo)}
    assert manipulator.slave_real_values(silo, [rows["gate.main.opening"]], [1.0])
    assert execution.step(STEPS)
    assert execution.status().current_time == STEPS * NANOSECONDS
    return observer.last_real_values(silo, [rows[name] for name in NAMES])


if __name__ == "__main__":
    values = {"ecos": ecos, "cosim": cosim, "load": load}[sys.argv[1]](*sys.argv[2:])
    print("\nvalues", *[bits(v) for v in values], flush=True)
