"""Every way of running a scene gives the same bits: FMI 2, FMI 3, the C interface and the program; 1 and 2 threads.

Run by tests/it/fmu.rs for each of its scenes; SANDGATE_RUN1 and SANDGATE_RUN2 are what the program left.
"""

import csv
import os
import sys

import pytest

sys.path.insert(0, os.path.dirname(__file__))

import fmpy

from importer import bits
from scheduled import FMUS, H, STEPS, outputs, table, through_the_c_interface


@pytest.fixture(scope="module")
def reference():
    return through_the_c_interface()


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("threads", [1, 2])
def test_simulate_fmu(version, threads, reference):
    names = outputs()
    result = fmpy.simulate_fmu(
        FMUS[version],
        input=table(),
        output=names,
        output_interval=H,
        stop_time=STEPS * H,
        start_values={"solver.threads": threads},
    )
    series = [[bits(float(row[name])) for name in names] for row in result[1:]]
    assert list(result["time"]) == [k * H for k in range(STEPS + 1)]
    assert series == reference


def test_two_threads_through_the_c_interface(reference):
    assert through_the_c_interface(threads=2) == reference


@pytest.mark.parametrize("threads", [1, 2])
def test_the_program(threads, reference):
    with open(os.path.join(os.environ[f"SANDGATE_RUN{threads}"], "gauges.csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    names = outputs()
    flag = {"true": "1", "false": "0"}
    series = [[bits(float(flag.get(row[n], row[n]))) for n in names] for row in rows[1:]]
    assert series == reference


def test_the_series_shows_flow(reference):
    """Equal series of nothing would be equal too."""
    first, last = (dict(zip(outputs(), row)) for row in (reference[0], reference[-1]))
    moved = [name for name in last if name.startswith("inflow.") or name.startswith("gauge.discharge")]
    moved = [name for name in moved if name.endswith(".mass")]
    assert moved and all(last[name] != bits(0.0) for name in moved)
    assert last["energy.kinetic"] != first["energy.kinetic"]
    assert last["mass.error"] == bits(0.0)
