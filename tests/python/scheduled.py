"""The scene that a test file is about, stepped along its own schedules by any instance.

SANDGATE_SCENE  the scene, with all numbers of its run and schedules as plain SI
SANDGATE_FMU2   the scene packed for FMI 2
SANDGATE_FMU3   and for FMI 3
SANDGATE_LIBRARY  the shared library
"""

import bisect
import os
import tomllib

import fmpy
import numpy as np

from importer import Library, bits

FMUS = {2: os.environ["SANDGATE_FMU2"], 3: os.environ["SANDGATE_FMU3"]}
LIBRARY, PATH = os.environ["SANDGATE_LIBRARY"], os.environ["SANDGATE_SCENE"]

with open(PATH, "rb") as file:
    SCENE = tomllib.load(file)
H = SCENE["run"]["step"]
STEPS = round(SCENE["run"]["until"] / H)
INPUTS = {s["input"]: s for s in SCENE["schedule"]}


def outputs():
    """Names of all scalar outputs, integers and flags included."""
    description = fmpy.read_model_description(FMUS[2])
    return [v.name for v in description.modelVariables if v.causality == "output"]


def wanted(name, t):
    """Value of a schedule. Where it is a line, times and values are dyadic: every way of computing it gives the same bits."""
    times, values = zip(*INPUTS[name]["points"])
    if INPUTS[name].get("interpolation") == "hold":
        return float(values[max(bisect.bisect_right(times, t) - 1, 0)])
    return float(np.interp(t, times, values))


def table():
    """All schedules as FMPy wants inputs: a held value has a second row where it jumps."""
    rows = []
    for t in sorted({t for schedule in INPUTS.values() for t, _ in schedule["points"]}):
        before = tuple(wanted(name, np.nextafter(t, -np.inf)) for name in INPUTS)
        after = tuple(wanted(name, t) for name in INPUTS)
        jumps = any(schedule.get("interpolation") == "hold" for schedule in INPUTS.values())
        if jumps and rows and before != after:
            rows.append((t, *before))
        rows.append((t, *after))
    return np.array(rows, dtype=[("time", float)] + [(name, float) for name in INPUTS])


def run(instance, first=0, last=STEPS, names=None):
    """Steps an instance along the schedules; all outputs after each step, as bits."""
    names = names or outputs()
    series = []
    for k in range(first, last):
        t = k * H
        for name in INPUTS:
            instance.set(name, wanted(name, t))
        instance.step(t, (k + 1) * H - t)
        series.append([bits(v) for v in instance.get(names)])
    return series


def through_the_c_interface(threads=1):
    """The whole series from the plain C interface."""
    library = Library(LIBRARY, PATH).initialize(threads=threads)
    series = run(library)
    library.free()
    return series
