"""What a log costs: CPU time of a case stepped through the C library with and without one, in pairs.

Run by hand, not by the tests (docs/fmi.md, "Cost", has what a run gave):

    cargo build --release -p sandgate-fmu
    python tests/python/cost_of_log.py                  # Python alone will do

Pairs follow one another and change their order, so that what else the machine does falls on both.
"""

import argparse
import ctypes
import os
import pathlib
import statistics
import tempfile
import time

from importer import Library

ROOT = pathlib.Path(__file__).resolve().parents[2]


def cost(library, scene, steps, h, log):
    """CPU time of all threads for the steps [s]."""
    silo = Library(library, scene)
    if log:
        reference = ctypes.c_uint32(silo.references["log.path"])
        silo.check(silo.lib.sandgate_set_text(silo.handle, reference, log.encode()))
    silo.initialize()
    silo.set("gate.main.opening", 1.0)
    begin = time.process_time()
    for k in range(steps):
        silo.step(k * h, (k + 1) * h - k * h)
    took = time.process_time() - begin
    silo.free()
    return took


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--library", default=str(ROOT / "target/release/libsandgate_fmu.so"))
    parser.add_argument("--scene", default=str(ROOT / "cases/silo_gate.toml"))
    parser.add_argument("--pairs", type=int, default=15)
    parser.add_argument("--steps", type=int, default=20)
    parser.add_argument("--h", type=float, default=0.01, help="communication step [s]")
    arguments = parser.parse_args()
    shares = []
    with tempfile.TemporaryDirectory() as folder:
        for k in range(arguments.pairs):
            took = {}
            for logged in (k % 2 == 0, k % 2 == 1):
                path = os.path.join(folder, f"{k}.mcap") if logged else None
                took[logged] = cost(arguments.library, arguments.scene, arguments.steps, arguments.h, path)
            shares.append(took[True] / took[False] - 1.0)
            print(f"pair {k + 1}: {took[False]:.3f} s without, {took[True]:.3f} s with a log: {100 * shares[-1]:+.2f} %", flush=True)
        size = os.path.getsize(os.path.join(folder, "0.mcap"))
    print(f"median {100 * statistics.median(shares):+.2f} %; a log has {size / 1e6:.2f} MB after {arguments.steps} steps")


if __name__ == "__main__":
    main()
