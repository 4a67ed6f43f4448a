"""A controller holds the depth before a sluice gate by moving the gate: two FMUs coupled by two kinds of master.

    sandgate fmu examples/coupling/chute.toml --fmi 3 -o chute.fmu
    python examples/coupling/hold_level.py chute.fmu --master rollback --out level

The controller's FMU is built here, for the same version of FMI: `level_pi_fmi2.py` by pythonfmu, `level_pi_fmi3.py` by
pythonfmu3. `--master fixed` steps each FMU once a communication step. `--master rollback` does each step three times
from saved states, as an iterating master does: twice with guesses for the opening, then with the controller's. Both
must give the same trajectory, to the bit. Writes OUT.csv and OUT.svg. Needs fmpy, pythonfmu and pythonfmu3.
"""

import argparse
import csv
import os
import tempfile
from pathlib import Path

import fmpy

from slave import Slave

STEP = 1.0 / 128.0
WANTED = 0.036


def build_controller(two, folder):
    """The controller's FMU for one version of the standard."""
    if two:
        from pythonfmu.builder import FmuBuilder as Builder
    else:
        from pythonfmu3.builder import FmuBuilder as Builder
    script = Path(__file__).with_name("level_pi_fmi2.py" if two else "level_pi_fmi3.py")
    # Both packages have a variable name for each state function, so that what they save can be set again.
    state = dict(canGetAndSetFMUstate=True) if two else dict(canGetAndSetFMUState=True)
    Builder.build_FMU(script, dest=folder, **state)
    (fmu,) = Path(folder).glob("*.fmu")
    return fmu


def fixed(chute, controller, t):
    """One communication step: the controller first, from the depth of now; the chute with its answer."""
    controller.set("level", chute.get("gauge.level.depth"))
    controller.step(t, STEP)
    opening = controller.get("opening")
    chute.set("gate.sluice.opening", opening)
    chute.step(t, STEP)
    return opening


def rollback(chute, controller, t):
    """The same step, after two with guesses that are taken back."""
    before = chute.save(), controller.save()
    for guess in (0.0, 1.0):
        controller.set("level", chute.get("gauge.level.depth") + 0.01)
        controller.step(t, STEP)
        chute.set("gate.sluice.opening", guess)
        chute.step(t, STEP)
        chute.restore(before[0])
        controller.restore(before[1])
    opening = fixed(chute, controller, t)
    chute.forget(before[0])
    controller.forget(before[1])
    return opening


def simulate(path, master, until):
    """Rows (time, depth, opening) after each communication step."""
    two = fmpy.read_model_description(path).fmiVersion.startswith("2")
    with tempfile.TemporaryDirectory() as folder:
        chute = Slave(path)
        controller = Slave(str(build_controller(two, folder)), wanted=WANTED)
        rows = []
        for k in range(round(until / STEP)):
            opening = master(chute, controller, k * STEP)
            rows.append(((k + 1) * STEP, chute.get("gauge.level.depth"), opening))
        controller.free()
        chute.free()
    return rows


def write_csv(rows, path):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time [s]", "depth [m]", "opening [1]"])
        writer.writerows([repr(value) for value in row] for row in rows)


def write_svg(rows, path):
    """Depth and opening over time, and the band of 5 % about the wanted depth."""
    width, height, end = 640, 300, rows[-1][0]

    def line(column, full):
        return " ".join(f"{40 + row[0] / end * width:.1f},{20 + (1 - row[column] / full) * height:.1f}" for row in rows)

    full = 1.5 * WANTED
    top, bottom = (20 + (1 - share * WANTED / full) * height for share in (1.05, 0.95))
    Path(path).write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width + 60} {height + 50}" font-family="sans-serif" '
        f'font-size="12"><rect width="100%" height="100%" fill="white"/>'
        f'<rect x="40" y="{top:.1f}" width="{width}" height="{bottom - top:.1f}" fill="#cde"/>'
        f'<polyline points="{line(1, full)}" fill="none" stroke="#0072b2" stroke-width="1.5"/>'
        f'<polyline points="{line(2, 1.0)}" fill="none" stroke="#d55e00" stroke-width="1.5"/>'
        f'<path d="M40 20v{height}h{width}" fill="none" stroke="#333"/>'
        f'<text x="48" y="34" fill="#0072b2">depth, full height {full * 1000:.0f} mm; wanted +- 5 % shaded</text>'
        f'<text x="48" y="50" fill="#d55e00">opening, full height 1</text>'
        f'<text x="{width}" y="{height + 36}">{end:g} s</text></svg>\n'
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fmu", help="examples/coupling/chute.toml, packed for FMI 2 or 3")
    parser.add_argument("--master", choices=["fixed", "rollback"], default="fixed")
    parser.add_argument("--until", type=float, default=2.0, help="end [s]")
    parser.add_argument("--out", default="level", help="OUT.csv and OUT.svg are written")
    arguments = parser.parse_args()
    # The controllers' modules are imported from inside their FMUs; no copies of them may lie about.
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    rows = simulate(arguments.fmu, {"fixed": fixed, "rollback": rollback}[arguments.master], arguments.until)
    write_csv(rows, arguments.out + ".csv")
    write_svg(rows, arguments.out + ".svg")
    for time, depth, opening in rows[15::16]:
        print(f"t {time:6.3f} s   depth {depth * 1000:6.2f} mm   opening {opening:5.3f}")
    settled = [depth for time, depth, _ in rows if time >= arguments.until - 0.5]
    worst = max(abs(depth / WANTED - 1.0) for depth in settled)
    print(f"wanted {WANTED * 1000:.1f} mm; in the last 0.5 s within {100 * worst:.1f} %")


if __name__ == "__main__":
    main()
