"""Drives a served silo: opens its gate, steps it and prints what its gauges say.

    sandgate serve cases/silo_gate.toml                 # prints where it listens
    pip install eclipse-zenoh protobuf
    python examples/bus_client.py tcp/127.0.0.1:PORT silo_gate
"""

import base64
import json
import sys
import threading
import time
import uuid

import zenoh
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory


def open_session(endpoint):
    """A session that connects to one endpoint and looks for nobody else."""
    config = zenoh.Config()
    config.insert_json5("mode", json.dumps("client"))
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


class Refused(Exception):
    """A request was refused; `reply` says why (code, message) and where the component stands."""

    def __init__(self, reply):
        super().__init__(f"{reply['code']}: {reply['message']}")
        self.reply = reply


class Component:
    """A served component, asked by request and reply."""

    def __init__(self, session, instance, client="example", attempts=3):
        self.session = session
        self.base = f"sandgate/v1/{instance}"
        self.client = client
        self.attempts = attempts

    def ask(self, verb, timeout=60.0, **fields):
        """One request. If nobody answers it is sent again, for the connection may have broken and be there again; its identifier
        sees to it that it is carried out once."""
        body = json.dumps({"req": uuid.uuid4().hex, "client": self.client, **fields})
        for left in reversed(range(self.attempts)):
            replies = list(self.session.get(f"{self.base}/@rpc/{verb}", payload=body, timeout=timeout))
            if replies or not left:
                break
            time.sleep(1.0)
        if not replies:
            raise TimeoutError(f"nobody answers at {self.base}")
        text = (replies[0].ok or replies[0].err).payload.to_string()
        try:
            reply = json.loads(text)
        except json.JSONDecodeError:  # Zenoh's own words, such as "Timeout" when the component ends before it answers
            raise TimeoutError(f"no answer from {self.base}: {text}") from None
        if not reply["ok"]:
            raise Refused(reply)
        return reply

    def watch_end(self, ended):
        """Calls `ended()` when the component is gone, at once if its process ends. Keep what this returns for as long as you
        want to know. With `history`, without which a client is not told that a component which was there before it was killed."""

        def tell(sample):
            if sample.kind == zenoh.SampleKind.DELETE:
                ended()

        return self.session.liveliness().declare_subscriber(f"{self.base}/@alive", tell, history=True)

    def message_classes(self):
        """Classes that decode what is published, by name: `sandgate.Gauge`, ..."""
        classes = {}
        for name, text in self.ask("describe")["schemas"].items():
            files = descriptor_pb2.FileDescriptorSet.FromString(base64.b64decode(text)).file
            pool = descriptor_pool.DescriptorPool()
            for file in files:  # each stands behind those that it imports
                pool.Add(file)
            classes[name] = message_factory.GetMessageClass(pool.FindMessageTypeByName(name))
        return classes


def main(endpoint, instance):
    with open_session(endpoint) as session:
        silo = Component(session, instance)
        Gauge = silo.message_classes()["sandgate.Gauge"]
        gauges, arrived = {}, threading.Condition()

        def keep(sample):
            gauge = Gauge.FromString(sample.payload.to_bytes())
            with arrived:
                gauges[gauge.name] = gauge
                arrived.notify_all()

        subscriber = session.declare_subscriber(f"{silo.base}/out/gauge/**", keep)
        watch = silo.watch_end(lambda: print("the silo has gone", file=sys.stderr))

        # A set-point, as a PLC would send it; it takes effect with the next step.
        session.put(f"{silo.base}/in/gate.main.opening", "0.5")
        for _ in range(10):
            reply = silo.ask("step", dt_ns=5_000_000, outputs=["gate.main.actual_opening"])
        print(f"step {reply['step']}: gate at {reply['outputs']['gate.main.actual_opening']:.2f}")

        last = reply["step"]
        with arrived:
            arrived.wait_for(lambda: gauges and all(g.step >= last for g in gauges.values()), 10)
        for name, gauge in sorted(gauges.items()):
            values = " ".join(f"{value:.4g}" for value in gauge.values)
            print(f"t = {gauge.time:.3f} s  {name} = {values} {gauge.unit}")
        ledger = silo.ask("status")["ledger"]
        print(f"mass present {ledger['present']:.4f} kg, account off by {ledger['error']} kg")
        watch.undeclare()
        subscriber.undeclare()


if __name__ == "__main__":
    main(*sys.argv[1:3])
