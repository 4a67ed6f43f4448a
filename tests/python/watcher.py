"""A subscriber to everything, in a process of its own: `watcher.py ENDPOINT INSTANCE GAUGE [SECONDS]`.

It sleeps so many seconds in its callback at each message, 0 if it is not told. After a line with a number on its input it
sleeps no more, and once the message of the gauge with that number or a later one has come it prints the first and the last
number that it got, how many it got, and how many it missed between them.
"""

import pathlib
import sys
import threading

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples"))

from bus_client import Component, open_session


def main(endpoint, instance, gauge, naps=0.0):
    numbers, awake, news = [], threading.Event(), threading.Condition()
    with open_session(endpoint) as session:
        component = Component(session, instance, client="watcher")
        Gauge = component.message_classes()["sandgate.Gauge"]

        def keep(sample):
            if not awake.is_set() and naps:
                awake.wait(naps)
            if str(sample.key_expr).endswith(f"/out/gauge/{gauge}"):
                with news:
                    numbers.append(Gauge.FromString(sample.payload.to_bytes()).sequence)
                    news.notify()

        subscriber = session.declare_subscriber(f"{component.base}/out/**", keep)
        # Answered behind the subscription: from here on it is known.
        component.ask("status")
        print("subscribed", flush=True)
        last = int(sys.stdin.readline())
        awake.set()
        with news:
            news.wait_for(lambda: numbers and numbers[-1] >= last, 60)
        gaps = sum(b - a - 1 for a, b in zip(numbers, numbers[1:]))
        print(numbers[0], numbers[-1], len(numbers), gaps, flush=True)
        subscriber.undeclare()


if __name__ == "__main__":
    main(*sys.argv[1:4], *map(float, sys.argv[4:]))
