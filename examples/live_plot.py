"""Plots gauges of a served component while it runs.

    sandgate serve cases/silo_gate.toml --realtime-factor 0.1     # prints where it listens
    pip install eclipse-zenoh protobuf matplotlib
    python examples/live_plot.py tcp/127.0.0.1:PORT silo_gate

Any gauge by name, otherwise all with one value. `--seconds 5 --output plot.png` needs no screen. A gap in the numbers of
the messages means that some were lost (this program was too slow); it is counted and shown.
"""

import argparse
import threading
import time

from bus_client import Component, open_session


class Curves:
    """Time and value of each gauge, filled by Zenoh's thread: its callback only keeps, it never draws."""

    def __init__(self, gauge_class, names):
        self.gauge_class, self.names = gauge_class, names
        self.lock = threading.Lock()
        self.points, self.units, self.next, self.lost = {}, {}, {}, 0

    def keep(self, sample):
        gauge = self.gauge_class.FromString(sample.payload.to_bytes())
        with self.lock:
            self.lost += max(0, gauge.sequence - self.next.get(gauge.name, gauge.sequence))
            self.next[gauge.name] = gauge.sequence + 1
            if len(gauge.values) == 1 and (not self.names or gauge.name in self.names):
                # A gauge that cannot measure leaves a hole in its curve.
                value = gauge.values[0] if gauge.validity == 0 else float("nan")
                self.points.setdefault(gauge.name, []).append((gauge.time, value))
                self.units[gauge.name] = gauge.unit

    def copy(self):
        with self.lock:
            return {name: list(points) for name, points in self.points.items()}, dict(self.units), self.lost


def draw(figure, curves):
    """One picture a unit."""
    points, units, lost = curves.copy()
    figure.clear()
    kinds = sorted(set(units.values()))
    axes = figure.subplots(max(len(kinds), 1), 1, sharex=True, squeeze=False)[:, 0]
    for axis, unit in zip(axes, kinds):
        for name in sorted(n for n in points if units[n] == unit):
            axis.plot(*zip(*points[name]), label=name.removeprefix("gauge."))
        axis.set_ylabel(f"[{unit}]")
        axis.grid(alpha=0.3)
        axis.legend(loc="upper left", fontsize="small")
    axes[-1].set_xlabel("simulated time [s]" + (f", {lost} messages lost" if lost else ""))


def main():
    parser = argparse.ArgumentParser(description="plots gauges of a served component while it runs")
    parser.add_argument("endpoint")
    parser.add_argument("instance")
    parser.add_argument("gauges", nargs="*", help="names such as gauge.level.depth; all if none are given")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="end after so long")
    parser.add_argument("--output", help="write a picture at the end and show no window")
    arguments = parser.parse_args()
    if arguments.output:
        import matplotlib

        matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=(9, 7), layout="constrained")
    with open_session(arguments.endpoint) as session:
        component = Component(session, arguments.instance, client="live_plot")
        curves = Curves(component.message_classes()["sandgate.Gauge"], arguments.gauges)
        subscriber = session.declare_subscriber(f"{component.base}/out/gauge/**", curves.keep)
        end = time.monotonic() + arguments.seconds
        while time.monotonic() < end and (arguments.output or plt.fignum_exists(figure.number)):
            if arguments.output:
                time.sleep(min(0.1, max(0.0, end - time.monotonic())))
            else:
                draw(figure, curves)
                plt.pause(0.1)
        subscriber.undeclare()
    draw(figure, curves)
    if arguments.output:
        figure.savefig(arguments.output, dpi=120)
    points, _, lost = curves.copy()
    print(f"{sum(map(len, points.values()))} values of {len(points)} gauges, {lost} messages lost")


if __name__ == "__main__":
    main()
