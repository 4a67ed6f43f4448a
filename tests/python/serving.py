"""A served silo for tests: `SANDGATE` is the program, `SANDGATE_ROOT` the source tree."""

import contextlib
import json
import os
import pathlib
import queue
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(os.environ["SANDGATE_ROOT"])
SCENE = ROOT / "tests/scenes/small_silo.toml"
BASE = "sandgate/v1/small_silo"
GATE = "gate.main.opening"

sys.path.insert(0, str(ROOT / "examples"))
from bus_client import Component, open_session  # noqa: E402


class Server:
    """The program, serving; its endpoint is the one that it printed."""

    def __init__(self, *arguments, scene=SCENE):
        command = [os.environ["SANDGATE"], "serve", str(scene), "--threads", "1", *arguments]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.endpoint = None
        for line in self.process.stdout:
            if line.startswith("listening on "):
                self.endpoint = line.split()[-1]
            if "(Ctrl-C ends)" in line:
                return
        raise AssertionError(f"{command} did not serve: {self.process.stderr.read()}")

    def end(self):
        """Ends it politely and gives what it printed."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            return self.process.communicate(timeout=60)
        finally:
            self.process.kill()


@contextlib.contextmanager
def served(*arguments, scene=SCENE):
    server = Server(*arguments, scene=scene)
    try:
        with open_session(server.endpoint) as session:
            yield server, session, Component(session, "small_silo", client="pytest")
    finally:
        server.end()


def subscribe(session, key):
    arrived = queue.Queue()
    return session.declare_subscriber(key, arrived.put), arrived


def raw(session, key, payload=None, timeout=20.0):
    """Every answer to a query as (is it an error, JSON)."""
    replies = session.get(key, payload=payload, timeout=timeout)
    return [(r.ok is None, json.loads((r.ok or r.err).payload.to_string())) for r in replies]


def until(condition, seconds=20.0):
    """Waits for what must become true; polls, so that a slow machine only takes longer."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)
