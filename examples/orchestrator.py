"""Steps two served components against each other: what leaves the first falls into the second.

    sandgate serve cases/silo_gate.toml                 # prints where it listens
    sandgate serve cases/chute_inflow.toml              # in another terminal
    pip install eclipse-zenoh protobuf
    python examples/orchestrator.py tcp/127.0.0.1:PORT silo_gate tcp/127.0.0.1:PORT chute_inflow

Jacobi coupling: both step at the same time with what the other said at the last communication point. Each request has an
identifier of its own and says at which step it belongs, so that one that is sent again, after a time-out, does nothing
twice, and a step that somebody else made is a conflict and not a silent error.

What leaves comes particle by particle, so that the rate of a short step may be several times the mean and more than the inflow
takes: what is beyond its range is owed, and asked for later.
"""

import argparse
import sys
from concurrent.futures import ThreadPoolExecutor

from bus_client import Component, open_session


def variable(component, start, end, causality):
    """The one variable of that kind, with its range."""
    rows = component.ask("describe")["variables"]
    found = [v for v in rows if v["causality"] == causality and v["name"].startswith(start) and v["name"].endswith(end)]
    if not found:
        sys.exit(f"{component.base} has no {causality} {start}*{end}")
    return found[0]


def main():
    parser = argparse.ArgumentParser(description="steps two served components against each other")
    parser.add_argument("upper_endpoint")
    parser.add_argument("upper", help="instance with a gate and an outflow")
    parser.add_argument("lower_endpoint")
    parser.add_argument("lower", help="instance with an inflow")
    parser.add_argument("--steps", type=int, default=40)
    parser.add_argument("--dt-ms", type=float, default=5.0)
    arguments = parser.parse_args()
    dt_ns = round(arguments.dt_ms * 1e6)

    with open_session(arguments.upper_endpoint) as one, open_session(arguments.lower_endpoint) as two:
        upper = Component(one, arguments.upper, client="orchestrator")
        lower = Component(two, arguments.lower, client="orchestrator")
        gate = variable(upper, "gate.", ".opening", "input")["name"]
        outflow = variable(upper, "outflow.", ".rate", "output")["name"]
        inflow = variable(lower, "inflow.", ".rate", "input")
        admitted = variable(lower, "inflow.", ".actual_rate", "output")["name"]
        largest = inflow.get("max", float("inf"))

        owed, passed = 0.0, 0.0
        at = {c: c.ask("status")["step"] for c in (upper, lower)}
        with ThreadPoolExecutor(2) as pool:
            for step in range(arguments.steps):
                # Opens within the first half.
                opening = min(1.0, 2.0 * step / arguments.steps)
                wanted = min(owed / (dt_ns * 1e-9), largest)
                owed, passed = owed - wanted * dt_ns * 1e-9, passed + wanted * dt_ns * 1e-9
                jobs = [
                    pool.submit(c.ask, "step", dt_ns=dt_ns, inputs=inputs, outputs=[output], expect_step=at[c])
                    for c, inputs, output in ((upper, {gate: opening}, outflow), (lower, {inflow["name"]: wanted}, admitted))
                ]
                replies = [job.result() for job in jobs]
                at = {c: reply["step"] for c, reply in zip((upper, lower), replies)}
                rate = replies[0]["outputs"][outflow]
                owed += rate * dt_ns * 1e-9
                if step % 10 == 9:
                    t = replies[0]["t_ns"] * 1e-9
                    print(f"t = {t:.3f} s  out of {arguments.upper} {rate:.4f} kg/s, into {arguments.lower} "
                          f"{replies[1]['outputs'][admitted]:.4f} kg/s", flush=True)
        above, below = (c.ask("status")["ledger"] for c in (upper, lower))
        print(f"{arguments.upper}: {above['outflow']:.4f} kg out, account off by {above['error']} kg")
        print(f"{arguments.lower}: {below['inflow']:.4f} kg in of {passed:.4f} kg asked for, {owed:.4f} kg still "
              f"owed, account off by {below['error']} kg")


if __name__ == "__main__":
    main()
