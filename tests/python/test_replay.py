"""Logs of what clients did run again with the same bits, and logs are replayed byte for byte.

SANDGATE is the program, SANDGATE_ROOT the source tree, SANDGATE_LOG the log of a run of the small silo.
"""

import json
import os
import pathlib
import queue
import random
import re
import signal
import socket
import subprocess
import sys
import time

import pytest
import zenoh
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

ROOT = pathlib.Path(os.environ["SANDGATE_ROOT"])
LOG = os.environ["SANDGATE_LOG"]
BASE = "sandgate/v1/small_silo"

sys.path.insert(0, str(ROOT / "examples"))
from bus_client import Component, open_session  # noqa: E402


def start(*arguments):
    """The program and the endpoint that it printed."""
    command = [os.environ["SANDGATE"], *map(str, arguments)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for line in process.stdout:
        if line.startswith("listening on "):
            return process, line.split()[-1]
    raise AssertionError(f"{command}: {process.stderr.read()}")


def end(process):
    process.send_signal(signal.SIGINT)
    try:
        return process.communicate(timeout=60)
    finally:
        process.kill()


def check(*paths):
    command = [os.environ["SANDGATE"], "log", "redrive", "--check", "--threads", "1", *map(str, paths)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


@pytest.mark.parametrize(
    "scene, inputs",
    [
        ("small_silo", {"gate.main.opening": 1.0}),
        ("devices", {"gate.sluice.opening": 1.0, "inflow.feed.rate": 0.3}),
        ("devices_3d", None),
    ],
)
def test_what_clients_did_at_random_runs_again(tmp_path, scene, inputs):
    """Set-points, requests, free running, a state that is restored and a reset: every file runs again by itself."""
    log = tmp_path / "served.mcap"
    scene_file = ROOT / f"tests/scenes/{scene}.toml"
    process, endpoint = start("serve", scene_file, "--threads", "1", "--log", log)
    dice = random.Random(7)
    with open_session(endpoint) as session:
        served = Component(session, scene)
        variables = served.ask("describe")["variables"]
        if inputs is None:
            inputs = {v["name"]: v.get("max") or 0.1 for v in variables if v["causality"] == "input"}
        else:
            assert set(inputs) == {v["name"] for v in variables if v["causality"] == "input"}

        def drive(rounds):
            for _ in range(rounds):
                for name, largest in inputs.items():
                    value = dice.uniform(0, largest)
                    if dice.random() < 0.5:
                        session.put(f"sandgate/v1/{scene}/in/{name}", json.dumps({"value": value, "client": "dice"}))
                    else:
                        served.ask("set", inputs={name: value})
                served.ask("step", dt_ns=dice.randrange(200_000, 2_000_000))

        drive(5)
        state = served.ask("save")["state"]
        drive(3)
        served.ask("restore", state=state)
        drive(3)
        served.ask("run", realtime_factor=1000.0)
        for _ in range(5):
            name, largest = dice.choice(list(inputs.items()))
            session.put(f"sandgate/v1/{scene}/in/{name}", json.dumps(dice.uniform(0, largest)))
            time.sleep(0.02)
        served.ask("pause")
        served.ask("reset")
        drive(3)
        # Set, but no step uses it any more.
        served.ask("set", inputs={name: largest})
        served.ask("terminate")
    process.communicate(timeout=60)
    files = sorted(tmp_path.glob("*.mcap"))
    assert len(files) == 3
    done = check(*files)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) == 3 and all("same bits" in line for line in lines), done.stdout
    assert "and the state at the end" in done.stdout


def recorded():
    """The messages below out/ by topic, as bytes."""
    topics = {}
    with open(LOG, "rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages(log_time_order=False):
            if "/out/" in channel.topic:
                topics.setdefault(channel.topic, []).append((schema.name, message.data))
    return topics


def replay(*arguments, take=lambda: None, buffers=""):
    """What a subscriber that spends `take` on every message gets of a replay, by topic, and what the program said."""
    process, endpoint = start("log", "replay", LOG, "--wait", "--listen", f"tcp/127.0.0.1:0{buffers}", *arguments)
    arrived = queue.Queue()

    def arrive(sample):
        take()
        arrived.put(sample)

    with open_session(endpoint) as session:
        subscriber = session.declare_subscriber(f"{BASE}/out/**", arrive)
        out, err = process.communicate(timeout=120)
        assert process.returncode == 0, err
        # What was sent is on its way to this thread when the program has ended.
        published = int(re.search(r"published (\d+) messages", out).group(1))
        patience = time.monotonic() + 60
        while arrived.qsize() < published and time.monotonic() < patience:
            time.sleep(0.01)
        subscriber.undeclare()
    topics = {}
    while not arrived.empty():
        sample = arrived.get()
        encoding, key = str(sample.encoding), str(sample.key_expr)
        assert encoding.startswith("application/protobuf;")
        # Each frame has a key of its own, and all of them share a topic of the log.
        if "/out/frames/" in key:
            key, name = key.rsplit("/", 1)
            assert frame(sample.payload.to_bytes()).decode() == name
        topics.setdefault(key, []).append((encoding.split(";")[1], sample.payload.to_bytes()))
    return topics, out


def test_a_replay_is_what_was_recorded_byte_for_byte():
    topics, out = replay("--speed", "inf")
    assert topics == recorded()
    assert f"published {sum(map(len, topics.values()))} messages" in out


def test_a_replay_waits_for_who_reads_slowly():
    """Sockets that hold little and 2 ms a message: most of it is on its way when the last message is published."""
    topics, _ = replay("--speed", "inf", take=lambda: time.sleep(0.002), buffers="#so_sndbuf=4096;so_rcvbuf=4096")
    assert topics == recorded()


def test_a_replay_keeps_its_time_and_its_window():
    began = time.monotonic()
    topics, out = replay("--speed", "0.5", "--topic", "out/gauge/*", "--from", "50 ms", "--until", "150 ms")
    assert time.monotonic() - began > 0.2
    gauges = {topic: messages for topic, messages in recorded().items() if "/out/gauge/" in topic}
    assert topics == {topic: messages[10:31] for topic, messages in gauges.items()}
    took, late = map(float, re.search(r"in (\S+) s, at most (\S+) ms late", out).groups())
    # Half of real time, to the last message; how late it may be is a matter for a quiet machine (docs/logs.md).
    assert took >= 0.2 and late < 1000


def frame(message):
    """The frame that a `foxglove.FrameTransform` places: field 3, a text."""
    at = message.index(b"\x1a", message.index(b"\x12"))
    return message[at + 2 : at + 2 + message[at + 1]]


def test_before_a_window_come_the_last_scene_and_the_last_of_each_frame():
    topics, _ = replay("--speed", "inf", "--from", "100 ms")
    whole = recorded()
    gauge, frames, scene = (f"{BASE}/out/{leaf}" for leaf in ("gauge/level.depth", "frames", "scene"))
    inside = len(topics[gauge])
    assert 0 < inside < len(whole[gauge])
    kinds = {frame(message) for _, message in whole[frames]}
    moved = len(topics[frames]) - len(kinds)
    # The newest before the window, then all of the window.
    assert kinds and topics[frames] == whole[frames][-len(topics[frames]) :]
    assert 0 <= moved < len(whole[frames]) - len(kinds)
    assert topics[scene] == whole[scene][-1:]


def test_a_window_without_messages_is_said():
    command = [os.environ["SANDGATE"], "log", "replay", LOG, "--speed", "inf", "--from", "1000 s"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 5 and "no message of these topics lies between" in done.stderr, done


def test_a_log_that_goes_back_in_time_is_replayed_to_its_end(tmp_path):
    """As an FMU's, whose importer goes back to a saved state."""
    path, times = tmp_path / "back.mcap", [0, 10, 20, 30, 10, 20, 40]
    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.NONE)
        writer.start()
        schema = writer.register_schema("sandgate.StepStats", "protobuf", b"")
        channel = writer.register_channel(f"{BASE}/out/stats", "protobuf", schema)
        for number, time_ms in enumerate(times):
            at = time_ms * 1_000_000
            writer.add_message(channel, at, bytes([number]), at, number)
        writer.finish()
    process, endpoint = start("log", "replay", path, "--wait", "--until", "25 ms")
    arrived = queue.Queue()
    with open_session(endpoint) as session:
        subscriber = session.declare_subscriber(f"{BASE}/out/**", arrived.put)
        out, err = process.communicate(timeout=120)
        got = [arrived.get(timeout=60).payload.to_bytes()[0] for _ in range(5)]
        subscriber.undeclare()
    assert process.returncode == 0 and "published 5 messages" in out, out + err
    assert got == [0, 1, 2, 4, 5]


def test_a_replay_can_have_another_name_and_go_round():
    process, endpoint = start("log", "replay", LOG, "--speed", "inf", "--loop", "--wait", "--instance", "ghost")
    with open_session(endpoint) as session:
        arrived = queue.Queue()
        subscriber = session.declare_subscriber("sandgate/v1/ghost/out/stats", arrived.put)
        count = len(recorded()[f"{BASE}/out/stats"])
        first = arrived.get(timeout=60).payload.to_bytes()
        # Every round has the same messages in the same order; the subscriber may have come in the middle of one.
        rounds = [first] + [arrived.get(timeout=60).payload.to_bytes() for _ in range(3 * count - 1)]
        assert rounds[:count] == rounds[count : 2 * count] == rounds[2 * count :]
        assert len(set(rounds)) == count
        late = session.get("sandgate/v1/ghost/out/scene", timeout=20.0)
        assert [str(reply.ok.key_expr) for reply in late] == ["sandgate/v1/ghost/out/scene"]
        subscriber.undeclare()
    out, _ = end(process)
    assert "published" in out


def test_a_replay_never_speaks_for_a_live_component():
    process, endpoint = start("serve", ROOT / "tests/scenes/small_silo.toml", "--threads", "1")
    try:
        command = [os.environ["SANDGATE"], "log", "replay", LOG, "--speed", "inf", "--connect", endpoint]
        refused = subprocess.run(command, capture_output=True, text=True, timeout=60)
        assert refused.returncode == 6 and "small_silo" in refused.stderr, refused
        forced = subprocess.run([*command, "--force"], capture_output=True, text=True, timeout=60)
        assert forced.returncode == 0, forced.stderr
        other = subprocess.run([*command, "--instance", "other"], capture_output=True, text=True, timeout=60)
        assert other.returncode == 0, other.stderr
    finally:
        end(process)


def test_nor_where_both_have_joined_a_router():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", json.dumps([endpoint]))
    config.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(config):
        scene = str(ROOT / "tests/scenes/small_silo.toml")
        command = [os.environ["SANDGATE"], "serve", scene, "--threads", "1", "--connect", endpoint]
        live = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            next(line for line in live.stdout if "(Ctrl-C ends)" in line)
            command = [os.environ["SANDGATE"], "log", "replay", LOG, "--speed", "inf", "--connect", endpoint]
            refused = subprocess.run(command, capture_output=True, text=True, timeout=60)
            assert refused.returncode == 6 and "small_silo" in refused.stderr, refused
            forced = subprocess.run([*command, "--force"], capture_output=True, text=True, timeout=60)
            assert forced.returncode == 0, forced.stderr
        finally:
            end(live)
