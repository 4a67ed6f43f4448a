"""Subscribers that do not take what they get: nobody waits for them, and they see how much they missed.

`SANDGATE` is the program, `SANDGATE_ROOT` the source tree.
"""

import os
import signal
import subprocess
import sys
import threading
import time

import pytest

sys.path.insert(0, os.path.dirname(__file__))

from serving import BASE, ROOT, Server, Component, open_session, served

GAUGE = f"{BASE}/out/gauge/level.depth"


def watcher(endpoint, naps):
    command = [sys.executable, str(ROOT / "tests/python/watcher.py"), endpoint, "small_silo", "level.depth", str(naps)]
    child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "subscribed\n"
    return child


@pytest.mark.parametrize("how", ["stopped", "asleep in its callback"])
def test_a_subscriber_that_takes_nothing_holds_up_nobody(how):
    """Steps, replies and another subscriber go on; that one loses nothing, and the first one sees how much it missed."""
    with served() as (server, session, silo):
        Gauge = silo.message_classes()["sandgate.Gauge"]
        arrived, news = [], threading.Condition()

        def keep(sample):
            with news:
                arrived.append(Gauge.FromString(sample.payload.to_bytes()).sequence)
                news.notify()

        other = session.declare_subscriber(GAUGE, keep)
        child = watcher(server.endpoint, 0.0 if how == "stopped" else 1.0)
        try:
            if how == "stopped":
                child.send_signal(signal.SIGSTOP)
            slowest, latest, steps = 0.0, 0.0, 0
            # Longer than Zenoh waits before it closes a connection that must not lose anything (5 s).
            end = time.monotonic() + 7.0
            while time.monotonic() < end:
                began = time.monotonic()
                silo.ask("step", dt_ns=100_000)
                slowest = max(slowest, time.monotonic() - began)
                steps += 1
                with news:
                    # The start was published before anybody watched, so that the k-th step has the number k.
                    assert news.wait_for(lambda: arrived and arrived[-1] >= steps, 10), "the other subscriber gets nothing"
                latest = max(latest, time.monotonic() - began)
            assert arrived == list(range(arrived[0], steps + 1)) and arrived[0] <= 1
            assert silo.ask("status")["dropped_publications"] == 0
            # A step or a message that waited for the connection would take 5 s; 50 ms are waited for.
            assert slowest < 2.0 and latest < 2.0, (slowest, latest)
            if how == "stopped":
                child.send_signal(signal.SIGCONT)
            # By then what fits in the sockets has been taken; what comes now shows the gap.
            child.stdin.write(f"{steps + 1}\n")
            child.stdin.flush()
            said = []
            reader = threading.Thread(target=lambda: said.extend(map(int, child.stdout.readline().split())))
            reader.start()
            while reader.is_alive():
                steps += 1
                silo.ask("step", dt_ns=100_000)
                time.sleep(0.05)
            first, last, count, gaps = said
            assert gaps > 0 and first <= 1, said
            assert count + gaps == last - first + 1
        finally:
            child.kill()
            child.wait()
        other.undeclare()


@pytest.mark.parametrize("how", ["by a signal", "by a client"])
def test_a_subscriber_that_takes_nothing_keeps_no_server_from_ending(how, tmp_path):
    """Ended by either, with its log whole, though what is published has nowhere to go: particles fill the queue in which
    Zenoh's own last message waits."""
    log = tmp_path / "served.mcap"
    server = Server("--log", str(log))
    child = watcher(server.endpoint, 0.0)
    try:
        child.send_signal(signal.SIGSTOP)
        with open_session(server.endpoint) as session:
            silo = Component(session, "small_silo", client="pytest")
            for _ in range(2000):
                silo.ask("step", dt_ns=100_000)
            if how == "by a client":
                silo.ask("terminate")
        began = time.monotonic()
        if how == "by a signal":
            server.process.send_signal(signal.SIGTERM)
        # It gives up closing after 3 s; the rest is for a slow machine.
        said = server.process.communicate(timeout=20)[1]
        assert time.monotonic() - began < 15, said
        assert server.process.returncode == 0, said
        assert log.exists() and not os.path.exists(f"{log}.part")
    finally:
        child.kill()
        child.wait()
        server.process.kill()


def test_a_client_that_was_stopped_goes_on_asking():
    """It is not cut off for what it did not take, and what it asks is answered."""
    with served() as (server, _, silo):
        text = f"""
import sys, time
sys.path.insert(0, {str(ROOT / "examples")!r})
from bus_client import Component, open_session
with open_session({server.endpoint!r}) as session:
    own = Component(session, "small_silo", client="stopped", attempts=1)
    kept = session.declare_subscriber("{BASE}/out/**", lambda sample: None)
    print("subscribed", flush=True)
    while True:
        print(own.ask("status")["step"], flush=True)
        time.sleep(0.01)
"""
        child = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            assert child.stdout.readline() == "subscribed\n"
            child.stdout.readline()
            child.send_signal(signal.SIGSTOP)
            steps, end = 0, time.monotonic() + 7.0
            while time.monotonic() < end:
                began = time.monotonic()
                steps = silo.ask("step", dt_ns=100_000)["step"]
                assert time.monotonic() - began < 2.0
            child.send_signal(signal.SIGCONT)
            end = time.monotonic() + 60
            while time.monotonic() < end:
                line = child.stdout.readline()
                assert line, child.stderr.read()
                if int(line) >= steps:
                    break
            assert int(line) >= steps
        finally:
            child.kill()
            child.wait()
