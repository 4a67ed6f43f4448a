"""The reference results inside FMUs are what importers get: FMPy steps both versions along them, bit for bit.

SANDGATE_FMUS holds the paths. Run by tests/it/drivers.rs, which packs them first.
"""

import csv
import io
import os
import sys
import zipfile

import numpy as np
import pytest

sys.path.insert(0, os.path.dirname(__file__))

import fmpy

from importer import Fmu, bits

FMUS = os.environ["SANDGATE_FMUS"].split(os.pathsep)
EXTRA = "extra/org.fmi-standard.fmi-ls-ref/"


def table(path, ending):
    with zipfile.ZipFile(path) as archive:
        (name,) = [n for n in archive.namelist() if n.startswith(EXTRA) and n.endswith(ending)]
        return list(csv.DictReader(io.StringIO(archive.read(name).decode())))


@pytest.mark.parametrize("path", FMUS)
def test_call_by_call(path):
    inputs, outputs = table(path, "_in.csv"), table(path, "_out.csv")
    description = fmpy.read_model_description(path)
    arrays = {v.name for v in description.modelVariables if v.dimensions}
    wanted = {v.name for v in description.modelVariables if v.causality == "output"} - arrays
    assert set(outputs[0]) == wanted | {"time"}
    assert len(inputs) == len(outputs) > 5
    fmu = Fmu(path).initialize()
    names = sorted(wanted)
    for k, (given, expected) in enumerate(zip(inputs, outputs)):
        found = fmu.get(names)
        different = [n for n, v in zip(names, found) if bits(v) != bits(float(expected[n]))]
        assert different == [], f"at t = {expected['time']} s"
        assert given["time"] == expected["time"]
        if k + 1 < len(outputs):
            for name, value in given.items():
                if name != "time":
                    fmu.set(name, float(value))
            t = float(given["time"])
            fmu.step(t, float(outputs[k + 1]["time"]) - t)
    fmu.free()
    # Results of nothing would agree too.
    assert outputs[0] != outputs[-1]


@pytest.mark.parametrize("path", FMUS)
def test_fmpy_reads_the_files_as_they_are(path):
    """The inputs' file is one that simulate_fmu takes; its steps are whole multiples of the scene's."""
    description = fmpy.read_model_description(path)
    outputs = table(path, "_out.csv")
    with zipfile.ZipFile(path) as archive:
        (name,) = [n for n in archive.namelist() if n.startswith(EXTRA) and n.endswith("_in.csv")]
        text = archive.read(name).decode()
    signals = np.genfromtxt(io.StringIO(text), delimiter=",", names=True, deletechars="", dtype=float)
    signals.dtype.names = [name.strip('"') for name in signals.dtype.names]
    result = fmpy.simulate_fmu(
        path,
        input=signals,
        stop_time=float(outputs[-1]["time"]),
        output_interval=float(description.defaultExperiment.stepSize),
    )
    assert len(result) == len(outputs)
    for name in ("mass.outflow", "energy.kinetic"):
        expected = [float(row[name]) for row in outputs]
        assert result[name] == pytest.approx(expected, rel=1e-6, abs=1e-9)
