"""An ensemble of FMUs on Dask: 32 silos over friction angle, fill level and gate schedule.

    pip install fmpy dask distributed pyarrow
    python examples/ensemble/sweep.py --sandgate target/release/sandgate --out sweep --workers 2
    python examples/ensemble/sweep.py --out sweep --scheduler tcp://host:8786     # workers on many machines

A member is stepped in slices. After each slice its results and its saved FMU state come back and go to OUT/members; the
next slice starts from that state, on whatever worker is free. So a worker that is killed costs the slice it was
at, a member that fails is tried again from its last state, and the script goes on where it was when it is started again.
The states are exact: results have the same bits on one worker, on many, and after any number of restarts (`--serial`
computes them here without slices, to compare).

Workers need fmpy and nothing else: the FMU is sent to them. One serves all members: friction angle and fill level are its
parameters, the gate's opening is its input. Writes OUT/results.parquet (a row a member and step) and OUT/outflow.svg.
"""

import argparse
import base64
import itertools
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave

STEP = 1.0 / 128.0
STEPS = 24
SLICE = 6
TRIES = 3
FRICTION = [20.0, 24.0, 28.0, 32.0]  # [deg]
FILL = [0.05, 0.08]  # [m]
# Opening of the gate over time: (time [s], opening), straight in between.
SCHEDULES = {
    "wide": [(0.0, 1.0)],
    "half": [(0.0, 0.5)],
    "slow": [(0.0, 0.0), (0.15, 1.0)],
    "pulse": [(0.0, 1.0), (0.06, 1.0), (0.08, 0.0)],
}
OUTPUTS = ["gauge.level.depth", "outflow.drain.mass", "outflow.drain.rate", "mass.present"]


def members():
    """Every member: its number and what is swept."""
    sweep = itertools.product(FRICTION, FILL, SCHEDULES)
    return [
        dict(member=number, friction=friction, fill=fill, schedule=schedule)
        for number, (friction, fill, schedule) in enumerate(sweep)
    ]


def opening(schedule, t):
    """Opening at time t [s], held before the first and after the last point."""
    points = SCHEDULES[schedule]
    for (t0, o0), (t1, o1) in zip(points, points[1:]):
        if t <= t1:
            return o0 + (o1 - o0) * max(t - t0, 0.0) / (t1 - t0)
    return points[-1][1]


def pack(sandgate, library, folder):
    """The FMU, as bytes. Packing is skipped if it is there."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "silo.fmu"
    if not path.exists():
        scene = Path(__file__).with_name("silo.toml")
        extra = ["--library", library] if library else []
        command = [sandgate, "fmu", scene, "--fmi", "3", "--reference", "0", "-o", path, *extra]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return path.read_bytes()


def unpack(archive, folder):
    """The FMU made ready in a folder: its description, and the folder that it was extracted to."""
    path = Path(folder) / "silo.fmu"
    path.write_bytes(archive)
    return fmpy.read_model_description(str(path)), fmpy.extract(str(path), str(path.with_suffix("")))


def advance(ready, member, first, last, state):
    """Steps a member from communication step `first` to `last`: rows of results and the state at the end.

    `state` is None for a member that has not begun.
    """
    description, folder = ready
    fmu = FMU3Slave(
        guid=description.instantiationToken,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=f"member{member['member']}",
    )
    told = []
    fmu.instantiate(loggingOn=True, logMessage=lambda _, status, category, message: told.append(message.decode()))
    try:
        references = {v.name: v.valueReference for v in description.modelVariables}
        if state is None:
            fmu.enterInitializationMode(startTime=0.0)
            swept = {"material.grains.friction_angle": math.radians(member["friction"]), "body.fill.upper_y": member["fill"]}
            fmu.setFloat64([references[name] for name in swept], list(swept.values()))
            fmu.exitInitializationMode()
        else:
            # A state goes into an instance that was only instantiated, in any process; it holds the parameters too.
            saved = fmu.deserializeFMUState(state)
            fmu.setFMUState(saved)
            fmu.freeFMUState(saved)
        rows = []
        for k in range(first, last):
            t = k * STEP
            fmu.setFloat64([references["gate.main.opening"]], [opening(member["schedule"], t)])
            fmu.doStep(currentCommunicationPoint=t, communicationStepSize=STEP)
            rows.append([(k + 1) * STEP, *fmu.getFloat64([references[name] for name in OUTPUTS])])
        saved = fmu.getFMUState()
        state = bytes(fmu.serializeFMUState(saved))
        fmu.freeFMUState(saved)
    except FMICallException as error:
        raise RuntimeError(told[-1] if told else str(error)) from None
    finally:
        fmu.freeInstance()
    return rows, state


class Store:
    """What came back so far, on disk: one file a member, replaced as a whole."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def load(self, member):
        """(rows, state) of a member, ([], None) if it has not begun."""
        path = self.folder / f"{member['member']:03}.json"
        if not path.exists():
            return [], None
        found = json.loads(path.read_text())
        if found["what"] != member:
            sys.exit(f"{path} is of another sweep ({found['what']}); choose another --out or remove it")
        return found["rows"], base64.b64decode(found["state"])

    def save(self, member, rows, state):
        path = self.folder / f"{member['member']:03}.json"
        part = path.with_suffix(".part")
        part.write_text(json.dumps(dict(what=member, rows=rows, state=base64.b64encode(state).decode())))
        os.replace(part, path)


def serial(archive):
    """All members here, one after the other, each in one go: no slices and no states."""
    with tempfile.TemporaryDirectory() as folder:
        ready = unpack(archive, folder)
        return {m["member"]: advance(ready, m, 0, STEPS, None)[0] for m in members()}


def ensemble(client, archive, store, on_slice=lambda done: None):
    """All members on the workers of a Dask client; rows by member. Members that failed TRIES times are left out.

    `on_slice` is told how many slices have come back.
    """
    from dask.distributed import WorkerPlugin, as_completed, get_worker

    class Archive(WorkerPlugin):
        """Puts the FMU on every worker, also on one that joins or is started again."""

        def setup(self, worker):
            worker.fmu = unpack(archive, tempfile.mkdtemp(dir=worker.local_directory))

    def slice_of(member, first, last, state):
        worker = get_worker()
        worker.log_event("slices", dict(member=member["member"], first=first))
        return advance(worker.fmu, member, first, last, state)

    client.register_plugin(Archive(), name="fmu")
    found, states, tries, running = {}, {}, {}, {}
    queue = as_completed(with_results=True, raise_errors=False)

    def submit(member):
        number, first = member["member"], len(found[member["member"]])
        last = min(first + SLICE, STEPS)
        # Members in order of their number; `pure=False`: a slice that is tried again is another task.
        future = client.submit(slice_of, member, first, last, states[number], pure=False, priority=-number)
        running[future.key] = member
        queue.add(future)

    for member in members():
        number = member["member"]
        found[number], states[number] = store.load(member)
        tries[number] = 0
        if len(found[number]) < STEPS:
            submit(member)
    total, slices, began = len(found) * STEPS, 0, time.monotonic()
    for future, result in queue:
        member = running.pop(future.key)
        number = member["member"]
        if future.status == "finished":
            rows, states[number] = result
            found[number] = found[number] + rows
            store.save(member, found[number], states[number])
            tries[number] = 0
            slices += 1
            steps = sum(map(len, found.values()))
            print(f"{steps}/{total} steps, {len(running)} members at work, {time.monotonic() - began:.1f} s", flush=True)
            on_slice(slices)
        elif future.status not in ("error", "cancelled"):
            # The worker ended before it handed over what it had computed: the scheduler has the same task computed again.
            running[future.key] = member
            queue.add(future)
            continue
        else:
            tries[number] += 1
            print(f"member {number} failed at step {len(found[number])}: {future.exception()}", flush=True)
        if len(found[number]) < STEPS and tries[number] < TRIES:
            submit(member)
    return {number: rows for number, rows in found.items() if len(rows) == STEPS}


def write_parquet(results, path):
    import pyarrow
    import pyarrow.parquet

    columns = {name: [] for name in ["member", "friction", "fill", "schedule", "time", *OUTPUTS]}
    for member in members():
        for row in results.get(member["member"], []):
            for name in ("member", "friction", "fill", "schedule"):
                columns[name].append(member[name])
            for name, value in zip(["time", *OUTPUTS], row):
                columns[name].append(value)
    pyarrow.parquet.write_table(pyarrow.table(columns), path)


def write_svg(results, path):
    """Mass that left over time, one panel a fill level, one colour a schedule, paler for smaller friction."""
    width, height, colours = 340, 260, dict(zip(SCHEDULES, ["#0072b2", "#d55e00", "#009e73", "#a3397f"]))
    column = 1 + OUTPUTS.index("outflow.drain.mass")
    most = max((rows[-1][column] for rows in results.values()), default=1.0) or 1.0
    svg = []
    for panel, fill in enumerate(FILL):
        left = 50 + panel * (width + 30)
        svg.append(f'<path d="M{left} 30v{height}h{width}" fill="none" stroke="#333"/>')
        svg.append(f'<text x="{left + 6}" y="26">filled to {100 * fill:g} cm; mass out, full height {most:.3f} kg</text>')
        for member in members():
            rows = results.get(member["member"])
            if rows and member["fill"] == fill:
                points = " ".join(
                    f"{left + row[0] / (STEPS * STEP) * width:.1f},{30 + (1 - row[column] / most) * height:.1f}"
                    for row in rows
                )
                pale = 0.35 + 0.65 * FRICTION.index(member["friction"]) / (len(FRICTION) - 1)
                svg.append(
                    f'<polyline points="{points}" fill="none" stroke="{colours[member["schedule"]]}" '
                    f'stroke-opacity="{pale:.2f}"/>'
                )
    for k, (schedule, colour) in enumerate(colours.items()):
        svg.append(f'<text x="{50 + 90 * k}" y="{height + 58}" fill="{colour}">{schedule}</text>')
    svg.append(f'<text x="430" y="{height + 58}">0 to {STEPS * STEP:g} s; darker: larger friction angle</text>')
    Path(path).write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 800 {height + 70}" font-family="sans-serif" '
        f'font-size="12"><rect width="100%" height="100%" fill="white"/>{"".join(svg)}</svg>\n'
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("sweep"), help="folder for the FMU, members and results")
    parser.add_argument("--sandgate", default=shutil.which("sandgate") or "sandgate", help="the program that packs FMUs")
    parser.add_argument("--library", help="the shared library to pack, if the program shall not look for it")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--workers", type=int, default=2, help="processes of a cluster on this machine")
    where.add_argument("--scheduler", help="address of a Dask scheduler with workers of its own")
    where.add_argument("--serial", action="store_true", help="no Dask and no slices: to compare with")
    arguments = parser.parse_args()

    archive = pack(arguments.sandgate, arguments.library, arguments.out)
    if arguments.serial:
        results = serial(archive)
    else:
        from dask.distributed import Client, LocalCluster

        store = Store(arguments.out / "members")
        if arguments.scheduler:
            with Client(arguments.scheduler) as client:
                results = ensemble(client, archive, store)
        else:
            # One thread a worker: importers change the working directory of their process.
            with LocalCluster(n_workers=arguments.workers, threads_per_worker=1) as cluster, Client(cluster) as client:
                results = ensemble(client, archive, store)
    write_parquet(results, arguments.out / "results.parquet")
    write_svg(results, arguments.out / "outflow.svg")
    missing = len(members()) - len(results)
    print(f"{len(results)} members in {arguments.out / 'results.parquet'}")
    if missing:
        sys.exit(f"{missing} members failed {TRIES} times; the same command tries them again from their last state")


if __name__ == "__main__":
    main()
