"""A served silo, watched and driven by Python clients: `SANDGATE` is the program, `SANDGATE_ROOT` the source tree."""

import base64
import json
import os
import pathlib
import queue
import random
import re
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

import pytest
import zenoh
from google.protobuf.descriptor_pb2 import FileDescriptorSet

sys.path.insert(0, os.path.dirname(__file__))

from serving import BASE, GATE, ROOT, SCENE, Server, raw, served, subscribe, until
from bus_client import Component, Refused, open_session

STEP_NS = 5_000_000


@pytest.fixture(scope="module")
def shared():
    """One server for all tests that leave it as they found it, but for time."""
    with served() as parts:
        yield parts


@pytest.fixture
def silo(shared):
    silo = shared[2]
    silo.ask("reset")
    return silo


@pytest.fixture
def session(shared):
    return shared[1]


def test_gauges_are_published_as_they_are_computed(session, silo):
    classes = silo.message_classes()
    subscriber, arrived = subscribe(session, f"{BASE}/out/**")
    until(lambda: silo.ask("step") and not arrived.empty())
    first = silo.ask("status")["step"]
    for _ in range(5):
        reply = silo.ask("step")
    outputs = silo.ask("get")["outputs"]
    last = reply["step"]

    by_key = {}
    while not by_key.get(f"{BASE}/out/stats") or by_key[f"{BASE}/out/stats"][-1].step < last:
        sample = arrived.get(timeout=20)
        encoding, schema = str(sample.encoding).split(";")
        assert encoding == "application/protobuf"
        message = classes[schema].FromString(sample.payload.to_bytes())
        by_key.setdefault(str(sample.key_expr), []).append(message)
    subscriber.undeclare()

    names = {key.removeprefix(f"{BASE}/out/").replace("/", ".", 1): key for key in by_key}
    for name in ["gauge.level.depth", "gauge.surface.depth", "gauge.outlet.discharge", "gauge.load.force_y"]:
        gauges = [g for g in by_key[names[name]] if g.step > first]
        assert [g.step for g in gauges] == list(range(first + 1, last + 1)), name
        sequence = [g.sequence for g in gauges]
        assert sequence == list(range(sequence[0], sequence[0] + 5)), name
        assert gauges[-1].name == name
        assert gauges[-1].time == pytest.approx(last * STEP_NS * 1e-9, abs=1e-12)
        value = outputs[name]
        assert list(gauges[-1].values) == (value if isinstance(value, list) else [value]), name
        assert gauges[-1].validity == outputs[f"{name.rsplit('.', 1)[0]}.validity"]
    stats = by_key[f"{BASE}/out/stats"][-1]
    ledger = stats.ledger
    assert ledger.initial + ledger.inflow - ledger.outflow == ledger.present > 0
    applied = [a for a in by_key[f"{BASE}/out/applied"] if a.step > first]
    assert [a.step for a in applied] == list(range(first + 1, last + 1))


def test_the_gate_moves_by_set_point_and_by_request(session, silo):
    classes = silo.message_classes()
    subscriber, arrived = subscribe(session, f"{BASE}/out/applied")
    session.put(f"{BASE}/in/{GATE}", '{"value": 0.5, "client": "plc"}')
    until(lambda: silo.ask("get", outputs=[GATE])["outputs"][GATE] == 0.5)
    opened = silo.ask("step", outputs=["gate.main.actual_opening"])
    assert 0 < opened["outputs"]["gate.main.actual_opening"] <= 0.5
    silo.ask("set", inputs={GATE: 0.25})
    silo.ask("step", inputs={GATE: 0.125})
    inputs = []
    while len(inputs) < 3:
        applied = classes["sandgate.Applied"].FromString(arrived.get(timeout=20).payload.to_bytes())
        inputs += [(applied.step, i.name, i.values[0], i.source) for i in applied.inputs]
    assert inputs == [(1, GATE, 0.5, "plc"), (2, GATE, 0.25, "pytest"), (2, GATE, 0.125, "pytest")]
    subscriber.undeclare()


def test_a_plain_number_is_a_set_point(session, silo):
    session.put(f"{BASE}/in/{GATE}", "0.75")
    until(lambda: silo.ask("get", outputs=[GATE])["outputs"][GATE] == 0.75)


def test_status_is_answered_while_a_step_runs(silo):
    done = queue.Queue()
    long = threading.Thread(target=lambda: done.put(silo.ask("step", dt_ns=1_000_000_000)))
    long.start()
    seen, slowest = [], 0.0
    while done.empty():
        asked = time.monotonic()
        status = silo.ask("status")
        slowest = max(slowest, time.monotonic() - asked)
        seen.append(status)
    long.join()
    busy = [s for s in seen if s["busy"] and s["busy"]["verb"] == "step"]
    assert len(busy) >= 2, f"{len(seen)} replies while a step of 1 s ran"
    assert all(s["step"] == 0 and s["busy"]["client"] == "pytest" for s in busy)
    assert done.get()["t_ns"] == 1_000_000_000
    # The step takes much longer than this; a status that had to wait for it would show.
    assert slowest < 1.0
    assert silo.ask("status")["busy"] is None


def test_bad_messages_get_one_reply_each_and_nothing_happens(session, silo):
    before = silo.ask("save")["state_hash"]
    step = f"{BASE}/@rpc/step"
    table = [
        (step, "{", "bad_request"),
        (step, "\xff\x00", "bad_request"),
        (step, '{"req":"1","dt_ns":NaN}', "bad_request"),
        (step, '{"req":"2","dt":1}', "bad_request"),
        (step, None, "bad_request"),
        (step, '{"req":"3","dt_ns":"5 ms"}', "type"),
        (step, '{"req":"4","dt_ns":0}', "range"),
        (step, " " * (1 << 20) + "{}", "too_large"),
        (step + "?dt_ns=5", '{"req":"5"}', "bad_request"),
        (f"{BASE}/@rpc/stepp", '{"req":"6"}', "bad_request"),
        (f"{BASE}/@rpc/step/now", '{"req":"7"}', "bad_request"),
        (f"{BASE}/@rpc/set", '{"req":"8","inputs":{"gate.none.opening":1}}', "unknown_variable"),
        (f"{BASE}/@rpc/set", '{"req":"9","inputs":{"gate.main.opening":2}}', "range"),
        (f"{BASE}/@rpc/*", '{"req":"10"}', "wildcard"),
        (f"{BASE}/@rpc/**", '{"req":"11"}', "wildcard"),
        ("sandgate/v1/*/@rpc/step", '{"req":"12"}', "wildcard"),
        ("sandgate/v1/*/@rpc/*", '{"req":"13"}', "wildcard"),
    ]
    for key, payload, code in table:
        replies = raw(session, key, payload)
        assert len(replies) == 1, (key, replies)
        is_error, reply = replies[0]
        assert reply["ok"] is False and reply["code"] == code, (key, reply)
        assert is_error == (code == "wildcard")
        assert reply["step"] == 0 and reply["mode"] == "stepping"
    assert silo.ask("save")["state_hash"] == before


def noise(dice):
    """A message that somebody with a broken program might send: key, payload, and whether it is a query."""
    verbs = ["describe", "status", "get", "set", "step", "run", "pause", "reset", "save", "restore", "terminate", "*", "", "x"]
    deep = "[" * dice.randrange(1, 300) + "]" * dice.randrange(0, 300)
    numbers = ["NaN", "Infinity", "-Infinity", "1e999", "-1", "1e-400", "0x10", "true", "null", "9" * 400, deep, '""', "{}", "[1,2]"]
    texts = ['"\\u0000"', '"' + "a" * dice.randrange(0, 5000) + '"', '"\\ud800"', "7", "null", "[]"]
    fields = {
        "req": texts + ['""'], "client": texts, "t_ns": numbers, "dt_ns": numbers, "expect_step": numbers + ["12345"],
        "inputs": numbers + [f'{{"{GATE}": {dice.choice(numbers)}}}', '{"gate.none.opening": 1}', f'{{"{GATE}":1,"{GATE}":1}}'],
        "outputs": numbers + ['["no"]', "[1]"], "state": texts, "realtime_factor": numbers, "unknown": ["1"],
    }
    names = dice.sample(sorted(fields), dice.randrange(0, 6))
    body = "{" + ",".join(f'"{name}":{dice.choice(fields[name])}' for name in names) + "}"
    kind = dice.randrange(6)
    if kind == 0:
        payload = dice.randbytes(dice.randrange(0, 400))
    elif kind == 1:
        payload = body.encode()[: dice.randrange(0, len(body) + 1)]
    elif kind == 2:
        payload = body.encode() + dice.randbytes(3)
    elif kind == 3 and dice.random() < 0.02:
        payload = body.encode() + b" " * (1 << 20)
    else:
        payload = body.encode()
    if dice.random() < 0.5:
        return f"{BASE}/@rpc/{dice.choice(verbs)}".rstrip("/"), payload, True
    leaf = dice.choice([GATE, "gate.none.opening", "*", "**", f"{GATE}/x", "gauge.level.depth"])
    if leaf == GATE and kind > 2:
        payload = dice.choice(numbers[:5] + ['"open"', '{"value":NaN}', '{"value":2}', '{"value":[0,1]}', "{}"]).encode()
    return f"{BASE}/in/{leaf}", payload, False


def test_a_thousand_broken_messages_change_nothing(tmp_path):
    """Requests without a usable `req` or body, set-points out of range, deletes: all refused, all counted."""
    with served() as (server, session, silo):
        silo.ask("step")
        before = silo.ask("save")["state_hash"]
        dice = random.Random(1)
        asked = answered = sent = 0
        while asked + sent < 1000:
            key, payload, is_query = noise(dice)
            try:
                body = json.loads(payload)
            except (ValueError, RecursionError):
                body = None
            # What happens to be right is no noise: it is left out here, as are wishes to run or to end.
            usable = isinstance(body, dict) and isinstance(body.get("req"), str) and body.get("expect_step") != 12345
            if is_query and usable and key.rsplit("/", 1)[-1] not in ("describe", "status", "get"):
                continue
            if is_query:
                asked += 1
                answered += sum(1 for _ in session.get(key, payload=payload, timeout=30.0))
            elif dice.random() < 0.1:
                sent += 1
                session.delete(key.replace("**", "x").replace("*", "x"))
            else:
                sent += 1
                session.put(key, payload)
        assert answered == asked > 300 and sent > 300
        until(lambda: silo.ask("status")["refused_set_points"] >= sent)
        status = silo.ask("status")
        assert status["refused_set_points"] == sent and status["step"] == 1
        assert silo.ask("save")["state_hash"] == before
        assert server.process.poll() is None
        _, errors = server.end()
        assert "panick" not in errors


def test_a_repeated_request_gets_the_same_reply_and_no_second_step(session, silo):
    body = '{"req":"c7e1","client":"orch-1","dt_ns":5000000}'
    first = raw(session, f"{BASE}/@rpc/step", body)
    again = raw(session, f"{BASE}/@rpc/step", body)
    assert first == again and first[0][1]["ok"]
    assert silo.ask("status")["step"] == 1
    [(_, other)] = raw(session, f"{BASE}/@rpc/step", body.replace("5000000", "6000000"))
    assert other["code"] == "conflict"


def test_two_clients_that_step_at_once_make_as_many_steps_as_replies_say(session, silo):
    """Half of the requests say where they believe the component to be: these are conflicts or steps, nothing between."""
    replies, lock = {"a": [], "b": []}, threading.Lock()

    def drive(name):
        own = Component(session, "small_silo", client=name)
        expected = 0
        for k in range(60):
            fields = {"expect_step": expected} if k % 2 else {}
            try:
                reply = own.ask("step", dt_ns=100_000, **fields)
            except Refused as refused:
                reply = refused.reply
            expected = reply["step"]
            with lock:
                replies[name].append(reply)

    threads = [threading.Thread(target=drive, args=[name]) for name in replies]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    everything = replies["a"] + replies["b"]
    assert len(everything) == 120 and len({reply["req"] for reply in everything}) == 120
    made = [reply["step"] for reply in everything if reply["ok"]]
    refused = [reply for reply in everything if not reply["ok"]]
    assert all(reply["code"] == "conflict" for reply in refused)
    # Each step was made once, and for one reply.
    assert sorted(made) == list(range(1, len(made) + 1)) and len(made) >= 60
    assert silo.ask("status")["step"] == len(made)
    # Both were served: neither waited until the other was done.
    assert all(any(reply["ok"] for reply in mine) for mine in replies.values())


def test_a_wrong_expectation_is_a_conflict(silo):
    silo.ask("step", expect_step=0, t_ns=0)
    for wrong in [{"expect_step": 0}, {"t_ns": 0}]:
        with pytest.raises(Refused, match="^conflict: ") as refused:
            silo.ask("step", **wrong)
        assert refused.value.reply["step"] == 1
    assert silo.ask("step", expect_step=1, t_ns=STEP_NS)["step"] == 2


def test_bad_set_points_are_counted_and_told_and_change_nothing(session, silo):
    classes = silo.message_classes()
    subscriber, arrived = subscribe(session, f"{BASE}/out/log")
    refused = silo.ask("status")["refused_set_points"]
    session.put(f"{BASE}/in/*", "1")
    session.put(f"{BASE}/in/**", "1")
    session.put("sandgate/v1/*/in/gate.main.opening", "1")
    session.delete(f"{BASE}/in/{GATE}")
    session.put(f"{BASE}/in/{GATE}", "NaN")
    session.put(f"{BASE}/in/{GATE}", "1.5")
    session.put(f"{BASE}/in/gate.none.opening", "1")
    until(lambda: silo.ask("status")["refused_set_points"] == refused + 7)
    lines = [classes["foxglove.Log"].FromString(arrived.get(timeout=20).payload.to_bytes()) for _ in range(7)]
    assert all(line.message.startswith("set-point refused: ") for line in lines)
    assert sum("wildcard" in line.message for line in lines) == 3
    assert silo.ask("get", outputs=[GATE])["outputs"][GATE] == 0
    subscriber.undeclare()


def test_a_state_goes_to_the_client_and_back(silo):
    silo.ask("step", inputs={GATE: 1})
    saved = silo.ask("save")
    silo.ask("step")
    gone_on = silo.ask("save")["state_hash"]
    restored = silo.ask("restore", state=saved["state"])
    assert restored["state_hash"] == saved["state_hash"] and restored["step"] == 1
    silo.ask("step")
    assert silo.ask("save")["state_hash"] == gone_on


def test_who_comes_late_gets_the_last_values(session, silo):
    silo.ask("step")
    depth = silo.ask("get", outputs=["gauge.level.depth"])["outputs"]["gauge.level.depth"]
    Gauge = silo.message_classes()["sandgate.Gauge"]
    [reply] = session.get(f"{BASE}/out/gauge/level.depth")
    gauge = Gauge.FromString(reply.ok.payload.to_bytes())
    assert (gauge.step, gauge.values[0]) == (1, depth)
    every = {str(r.ok.key_expr) for r in session.get(f"{BASE}/out/gauge/**")}
    variables = silo.ask("describe")["variables"]
    names = [v["name"] for v in variables if v["causality"] == "output"]
    names = [n for n in names if n.startswith("gauge.") and not n.endswith(".validity")]
    assert every == {f"{BASE}/out/{name.replace('.', '/', 1)}" for name in names} and len(every) > 4
    assert len(list(session.get(f"{BASE}/out/scene"))) == 1
    [(is_error, reply)] = raw(session, f"{BASE}/out/nothing")
    assert is_error and "nothing was published" in reply["message"]
    for part in ("level.validity", "surface.depth[1]"):
        [(is_error, reply)] = raw(session, f"{BASE}/out/gauge/{part}")
        assert is_error and "stand in the message of their output" in reply["message"], part


def test_the_newest_set_point_counts_however_many_came(tmp_path):
    """A thousand while a step runs: the last of each variable is taken, and the log says what became of the others."""
    path = tmp_path / "served.mcap"
    block = {"congestion_control": zenoh.CongestionControl.BLOCK}
    with served("--log", str(path)) as (server, session, silo):
        step = threading.Thread(target=lambda: silo.ask("step", dt_ns=1_000_000_000))
        step.start()
        until(lambda: silo.ask("status")["busy"])
        session.put(f"{BASE}/in/saturate_inputs", json.dumps({"value": True, "client": "quiet"}), **block)
        for n in range(1000):
            session.put(f"{BASE}/in/{GATE}", json.dumps({"value": n / 1000, "client": "chatty"}), **block)
        # One that is out of range takes no place of one that counts.
        session.put(f"{BASE}/in/{GATE}", "7", **block)
        assert silo.ask("status")["busy"], "the step must outlast the set-points"
        step.join()
        names = [GATE, "saturate_inputs"]
        taken = {GATE: 1.0, "saturate_inputs": True}
        until(lambda: silo.ask("get", outputs=names)["outputs"] == taken)
        assert silo.ask("status")["refused_set_points"] == 0
        silo.ask("step")
        server.end()
    points = [p for p in logged(path)["@in/set-point/request"] if p.client == "chatty"]
    assert {p.status for p in points[:-1]} == {"superseded"}
    assert points[-1].status == "ok" and json.loads(points[-1].body)["value"] == 0.999
    assert len(points) == 1000
    command = [os.environ["SANDGATE"], "log", "redrive", "--check", "--threads", "1", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr


def test_who_comes_late_gets_the_place_of_each_gate(tmp_path):
    scene = tmp_path / "two.toml"
    plate = '[gates.lid]\nfrom = ["3 cm", "14 cm"]\nto = ["5 cm", "14 cm"]\n\n'
    scene.write_text(SCENE.read_text().replace("[outflows.drain]", plate + "[outflows.drain]"))
    with served(scene=scene) as (_, session, silo):
        silo.ask("step")
        FrameTransform = silo.message_classes()["foxglove.FrameTransform"]
        found = {}
        for reply in session.get(f"{BASE}/out/**"):
            if "/out/frames/" in (key := str(reply.ok.key_expr)):
                found[key] = FrameTransform.FromString(reply.ok.payload.to_bytes()).child_frame_id
        assert found == {f"{BASE}/out/frames/gate.{name}": f"gate.{name}" for name in ("lid", "main")}


def test_going_to_a_state_of_other_parameters_publishes_its_scene(session, silo):
    SceneUpdate = silo.message_classes()["foxglove.SceneUpdate"]

    def drawn():
        [reply] = session.get(f"{BASE}/out/scene")
        return [e.cubes for e in SceneUpdate.FromString(reply.ok.payload.to_bytes()).entities if e.id == "gate.main"]

    silo.ask("step")
    state, first = silo.ask("save")["state"], drawn()
    silo.ask("reset", inputs={"solver.resolution_scale": 1.25})
    assert drawn() != first
    subscriber, arrived = subscribe(session, f"{BASE}/out/scene")
    silo.ask("restore", state=state)
    assert drawn() == first
    until(lambda: not arrived.empty())
    # To a state of the same scene: nothing new to draw.
    silo.ask("restore", state=state)
    silo.ask("status")
    assert arrived.qsize() == 1
    subscriber.undeclare()


def test_particles_of_the_time_before_are_not_kept_over_a_jump():
    with served() as (_, session, silo):
        subscriber, arrived = subscribe(session, f"{BASE}/out/particles")
        until(lambda: silo.ask("step") and not arrived.empty())
        subscriber.undeclare()

        def forgotten():
            silo.ask("reset")
            [reply] = session.get(f"{BASE}/out/particles")
            return reply.ok is None

        # Until the component knows that nobody wants them any more, they are those of the time after.
        until(forgotten)


def test_schemas_stand_behind_those_they_need(silo):
    for text in silo.ask("describe")["schemas"].values():
        known = set()
        for file in FileDescriptorSet.FromString(base64.b64decode(text)).file:
            assert known.issuperset(file.dependency), file.name
            known.add(file.name)


def test_equal_requests_give_equal_deterministic_logs(tmp_path):
    scene = tmp_path / "silo.toml"
    usual = 'particles_every = "50 ms"'
    scene.write_text(SCENE.read_text().replace(usual, f"{usual}\ndeterministic = true"))
    logs = [tmp_path / "first" / "served.mcap", tmp_path / "second" / "served.mcap"]
    for log in logs:
        log.parent.mkdir()
        with served("--log", str(log), scene=scene) as (server, session, _):
            for n in range(5):
                body = json.dumps({"req": str(n), "inputs": {GATE: n / 5}})
                [(_, reply)] = raw(session, f"{BASE}/@rpc/step", body)
                assert reply["wall_us"] > 0
            server.end()
    assert logs[0].read_bytes() == logs[1].read_bytes()


def test_particles_are_made_only_for_somebody():
    with served() as (_, session, silo):
        silo.ask("step")
        [(is_error, _)] = raw(session, f"{BASE}/out/particles")
        assert is_error
        subscriber, arrived = subscribe(session, f"{BASE}/out/particles")
        until(lambda: silo.ask("step") and not arrived.empty())
        PointCloud = silo.message_classes()["foxglove.PointCloud"]
        cloud = PointCloud.FromString(arrived.get().payload.to_bytes())
        particles = silo.ask("status")["statistics"]["particles"]
        assert len(cloud.data) == particles * cloud.point_stride > 0
        subscriber.undeclare()


def test_it_runs_by_itself_at_the_pace_it_was_told():
    with served("--realtime-factor", "0.5") as (_, _, silo):
        with pytest.raises(Refused, match="^state: .*pause"):
            silo.ask("step")
        began, first = time.monotonic(), silo.ask("status")["t_ns"]
        until(lambda: silo.ask("status")["t_ns"] >= first + 300_000_000)
        assert time.monotonic() - began > 0.4, "0.3 s at half pace take at least 0.6 s, less what status lags"
        paused = silo.ask("pause")
        assert silo.ask("step")["step"] == paused["step"] + 1


def test_a_client_of_the_example_sees_the_end_of_a_killed_component():
    server = Server()
    with open_session(server.endpoint) as session:
        silo, gone = Component(session, "small_silo", client="pytest"), threading.Event()
        watch = silo.watch_end(gone.set)
        silo.ask("status")
        assert not gone.is_set()
        server.process.kill()
        assert gone.wait(20)
        watch.undeclare()
    server.end()


def test_the_liveliness_token_ends_with_the_process():
    server = Server()
    # The watcher listens, so that it does not depend on what it watches.
    with open_session(server.endpoint) as session:
        states = queue.Queue()
        watch = session.liveliness().declare_subscriber(f"{BASE}/@alive", states.put, history=True)
        assert states.get(timeout=20).kind == zenoh.SampleKind.PUT
        server.process.kill()
        assert states.get(timeout=20).kind == zenoh.SampleKind.DELETE
        watch.undeclare()
    server.end()


def test_terminate_ends_the_program():
    with served() as (server, _, silo):
        assert silo.ask("terminate")["mode"] == "terminated"
        out, err = server.process.communicate(timeout=60)
        assert server.process.returncode == 0, err
        assert "terminated by a client at t = 0 s after 0 communication steps" in out


def test_an_orchestrator_that_falls_silent_is_noticed():
    with served("--lost-after", "0.5 s") as (_, session, silo):
        subscriber, told = subscribe(session, f"{BASE}/out/log")
        time.sleep(0.7)
        # Nobody has driven it yet, so nobody is lost.
        assert told.empty() and silo.ask("status")["orchestrator_lost"] is False
        step = silo.ask("step")["step"]
        until(lambda: silo.ask("status")["orchestrator_lost"])
        line = told.get(timeout=20).payload.to_bytes()
        assert b"orchestrator lost: no request for 0.5 s; the component waits" in line
        assert silo.ask("status")["step"] == step
        assert silo.ask("step")["step"] == step + 1
        assert silo.ask("status")["orchestrator_lost"] is False
        subscriber.undeclare()


def test_a_heartbeat_keeps_an_orchestrator_that_thinks_for_long():
    with served("--lost-after", "2 s") as (_, session, silo):
        subscriber, told = subscribe(session, f"{BASE}/out/log")
        step = silo.ask("step")["step"]
        began = time.monotonic()
        while time.monotonic() - began < 3.0:
            assert silo.ask("pause")["step"] == step
            assert silo.ask("status")["orchestrator_lost"] is False
            time.sleep(0.1)
        assert told.empty()
        until(lambda: silo.ask("status")["orchestrator_lost"])
        subscriber.undeclare()


def test_a_component_goes_on_without_its_orchestrator():
    with served("--lost-after", "0.3 s", "--when-lost", "continue") as (_, _, silo):
        step = silo.ask("step")["step"]
        until(lambda: silo.ask("status")["step"] > step + 3)
        assert silo.ask("status")["realtime_factor"] == 1.0
        paused = silo.ask("pause")["step"]
        assert silo.ask("step")["step"] == paused + 1


def test_a_component_ends_without_its_orchestrator():
    with served("--lost-after", "0.3 s", "--when-lost", "terminate") as (server, _, silo):
        silo.ask("step")
        out, _ = server.process.communicate(timeout=60)
        assert "terminated at t = 0.005 s after 1 communication steps" in out and server.process.returncode == 0


def test_everybody_who_waits_is_answered_when_the_program_ends():
    with served() as (server, session, silo):
        answers = queue.Queue()

        def ask(n):
            body = json.dumps({"req": str(n), "dt_ns": 300_000_000})
            answers.put(raw(session, f"{BASE}/@rpc/step", body, timeout=60))

        threads = [threading.Thread(target=ask, args=[n]) for n in range(4)]
        for thread in threads:
            thread.start()
        until(lambda: silo.ask("status")["busy"])
        server.process.send_signal(signal.SIGINT)
        for thread in threads:
            thread.join()
        replies = [answers.get() for _ in threads]
        assert all(len(each) == 1 for each in replies), replies
        ended = [each[0][1] for each in replies if not each[0][1]["ok"]]
        assert ended and all(e["code"] == "state" and "the server ended" in e["message"] for e in ended)
        assert server.process.wait(timeout=60) == 0


def test_a_listener_for_everybody_must_be_meant():
    command = [os.environ["SANDGATE"], "serve", str(SCENE), "--listen", "tcp/0.0.0.0:0"]
    refused = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert refused.returncode == 2
    assert "--allow-open-listener" in refused.stderr and "can be reached from other machines" in refused.stderr
    with served("--listen", "tcp/0.0.0.0:0", "--allow-open-listener") as (server, _, _):
        assert server.endpoint.startswith("tcp/0.0.0.0:")


def documented(kind):
    """The configuration that docs/security.md gives under a heading."""
    page = (ROOT / "docs/security.md").read_text()
    return page.split(f"## {kind}\n")[1].split("```json5\n")[1].split("```")[0]


def session_of(endpoint, user=None, password=None):
    config = zenoh.Config()
    config.insert_json5("mode", json.dumps("client"))
    config.insert_json5("connect", json.dumps({"endpoints": [endpoint], "timeout_ms": 2000, "exit_on_failure": True}))
    config.insert_json5("scouting/multicast/enabled", "false")
    if user:
        config.insert_json5("transport/auth/usrpwd/user", json.dumps(user))
        config.insert_json5("transport/auth/usrpwd/password", json.dumps(password))
    return zenoh.open(config)


def test_only_users_with_their_password_get_in_and_do_what_the_list_allows(tmp_path):
    """As docs/security.md has it: users and passwords, and access lists by user."""
    users = tmp_path / "users"
    users.write_text("plc:secret\nguest:guest\n")
    password = documented("User and password").replace("/etc/sandgate/users", str(users)).replace(":7447", ":0")
    access = documented("Access lists")
    config = tmp_path / "zenoh.json5"
    config.write_text(password.rstrip().removesuffix("}") + access.lstrip().removeprefix("{"))
    server = Server("--zenoh-config", str(config))
    try:
        for user, secret in ((None, None), ("plc", "wrong"), ("nobody", "secret")):
            with pytest.raises(zenoh.ZError):
                session_of(server.endpoint, user, secret)
        with session_of(server.endpoint, "plc", "secret") as plc, session_of(server.endpoint, "guest", "guest") as guest:
            assert Component(guest, "small_silo").ask("status")["step"] == 0
            assert Component(guest, "small_silo").ask("describe")["schemas"]
            told = []
            watch = guest.liveliness().declare_subscriber(f"{BASE}/@alive", told.append, history=True)
            until(lambda: told)
            assert told[0].kind == zenoh.SampleKind.PUT
            watch.undeclare()
            # Not in the list: nobody answers.
            for session in (plc, guest):
                with pytest.raises(TimeoutError):
                    Component(session, "small_silo").ask("step", timeout=1.0)
            # A set-point that is refused for its value is counted: the guest's does not even arrive.
            counted = lambda: Component(plc, "small_silo").ask("status")["refused_set_points"]
            guest.put(f"{BASE}/in/{GATE}", "7")
            Component(guest, "small_silo").ask("status")
            plc.put(f"{BASE}/in/{GATE}", "8")
            until(lambda: counted() == 1)
            assert Component(guest, "small_silo").ask("status")["refused_set_points"] == 1
            # Who watches sends nothing in a component's name: what it put came before the answer to what it asks then.
            ghost = "sandgate/v1/ghost"
            seen = []
            listener = plc.declare_subscriber(f"{BASE}/out/**", seen.append)
            Component(plc, "small_silo").ask("status")
            guest.put(f"{BASE}/out/gauge/forged", "1")
            token = guest.liveliness().declare_token(f"{ghost}/@alive")
            answers = guest.declare_queryable(f"{ghost}/@rpc/status", lambda query: query.reply(query.key_expr, "1"))
            Component(guest, "small_silo").ask("status")
            Component(plc, "small_silo").ask("status")
            assert not any("forged" in str(sample.key_expr) for sample in seen)
            assert not list(plc.liveliness().get(f"{ghost}/@alive", timeout=1.0))
            assert not any(reply.ok for reply in plc.get(f"{ghost}/@rpc/status", timeout=1.0))
            for declared in (listener, token, answers):
                declared.undeclare()
    finally:
        server.end()


def test_whom_to_join_is_checked_before_it_is_looked_for():
    for endpoint in ("tcp/127.0.0.1", "nonsense", "tcp/:7447"):
        command = [os.environ["SANDGATE"], "serve", str(SCENE), "--connect", endpoint]
        refused = subprocess.run(command, capture_output=True, text=True, timeout=60)
        assert refused.returncode == 2 and "allowed is tcp/HOST:PORT" in refused.stderr, refused


def test_the_name_may_stand_in_the_configuration(tmp_path):
    config = tmp_path / "zenoh.json5"
    config.write_text("{metadata: {sandgate: {instance: 'silo-7'}}}")
    for more, name in ([], "silo-7"), (["--instance", "silo-8"], "silo-8"):
        server = Server("--zenoh-config", str(config), *more)
        try:
            with open_session(server.endpoint) as session:
                assert Component(session, name).ask("status")["ok"]
        finally:
            server.end()
    config.write_text("{metadata: {sandgate: {name: 'silo-7'}}}")
    command = [os.environ["SANDGATE"], "serve", str(SCENE), "--zenoh-config", str(config)]
    refused = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert refused.returncode == 2 and "allowed are instance" in refused.stderr, refused


def test_a_session_that_cannot_open_says_why(tmp_path):
    """Only a port that cannot be had gets the advice to choose another."""
    config = tmp_path / "zenoh.json5"
    config.write_text("{transport: {auth: {usrpwd: {dictionary_file: '/no/such/file'}}}}")
    command = [os.environ["SANDGATE"], "serve", str(SCENE)]
    refused = subprocess.run([*command, "--zenoh-config", str(config)], capture_output=True, text=True, timeout=60)
    assert refused.returncode == 2 and 'usrpwd/dictionary_file = "/no/such/file": No such file' in refused.stderr, refused
    assert "port in use" not in refused.stderr
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        endpoint = f"tcp/127.0.0.1:{taken.getsockname()[1]}"
        refused = subprocess.run([*command, "--listen", endpoint], capture_output=True, text=True, timeout=60)
    assert refused.returncode != 0, refused
    assert f"cannot listen on {endpoint}: " in refused.stderr and "choose another with --listen" in refused.stderr


def test_a_name_is_served_once():
    with served() as (server, _, _):
        command = [os.environ["SANDGATE"], "serve", str(SCENE), "--connect", server.endpoint]
        twin = subprocess.run(command, capture_output=True, text=True, timeout=60)
        assert twin.returncode == 6 and "choose another name with --instance" in twin.stderr
        other = Server("--connect", server.endpoint, "--instance", "second")
        with open_session(server.endpoint) as session:
            until(lambda: raw(session, "sandgate/v1/second/@rpc/status", timeout=1))
        other.end()


def router(endpoint, mode="router"):
    """A router, as `zenohd` is one, at an endpoint that others know."""
    config = zenoh.Config()
    config.insert_json5("mode", json.dumps(mode))
    config.insert_json5("listen/endpoints", json.dumps([endpoint]))
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


def user(endpoint, mode):
    """Who looks for a component at a router, in a mode of his own."""
    config = zenoh.Config()
    config.insert_json5("mode", json.dumps(mode))
    config.insert_json5("listen/endpoints", "[]")
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


def free_endpoint():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{free.getsockname()[1]}"


@pytest.mark.parametrize("hub", ["router", "peer"])
def test_at_a_router_or_peer_a_name_is_served_once_and_everybody_finds_it(hub):
    endpoint = free_endpoint()
    with router(endpoint, hub):
        server = Server("--connect", endpoint)
        try:
            assert server.endpoint is None
            for mode in ("client", "peer"):
                with user(endpoint, mode) as session:
                    until(lambda: raw(session, f"{BASE}/@rpc/status", timeout=1))
                    assert [str(t.ok.key_expr) for t in session.liveliness().get(f"{BASE}/@alive")] == [f"{BASE}/@alive"]
                    subscriber, arrived = subscribe(session, f"{BASE}/out/stats")
                    silo = Component(session, "small_silo")
                    until(lambda: silo.ask("step") and not arrived.empty())
                    subscriber.undeclare()
            # A twin, however it joins.
            for more in ([], ["--listen", "tcp/127.0.0.1:0"]):
                command = [os.environ["SANDGATE"], "serve", str(SCENE), "--connect", endpoint, *more]
                twin = subprocess.run(command, capture_output=True, text=True, timeout=60)
                assert twin.returncode == 6 and "choose another name with --instance" in twin.stderr, twin
        finally:
            server.end()


def test_a_router_that_is_not_there_yet_is_looked_for():
    endpoint = free_endpoint()
    server = Server("--connect", endpoint)
    try:
        with router(endpoint) as late:
            until(lambda: raw(late, f"{BASE}/@rpc/status", timeout=1), seconds=60)
            with user(endpoint, "peer") as session:
                until(lambda: raw(session, f"{BASE}/@rpc/status", timeout=1))
    finally:
        server.end()


def test_a_client_with_a_listener_is_refused(tmp_path):
    config = tmp_path / "client.json5"
    config.write_text("{mode: 'client'}")
    command = [os.environ["SANDGATE"], "serve", str(SCENE), "--zenoh-config", str(config)]
    for more, word in (["--listen", "tcp/127.0.0.1:0"], "listens nowhere"), ([], "nobody to connect to"):
        refused = subprocess.run([*command, *more], capture_output=True, text=True, timeout=60)
        assert refused.returncode == 2 and word in refused.stderr, refused
    config.write_text("{mode: 7}")
    refused = subprocess.run(command, capture_output=True, text=True, timeout=60)
    # What Zenoh says of it, without the path on the machine that built it.
    assert refused.returncode == 2 and ".rs:" not in refused.stderr and "client.json5" in refused.stderr, refused


def test_a_router_that_comes_back_is_found_again():
    endpoint = free_endpoint()
    first = router(endpoint)
    server = Server("--connect", endpoint)
    try:
        until(lambda: raw(first, f"{BASE}/@rpc/status", timeout=1))
        Component(first, "small_silo").ask("step")
        first.close()
        with router(endpoint) as second:
            until(lambda: raw(second, f"{BASE}/@rpc/status", timeout=1), seconds=60)
            assert Component(second, "small_silo").ask("step")["step"] == 2
            # What it publishes arrives there, too.
            subscriber, arrived = subscribe(second, f"{BASE}/out/stats")
            until(lambda: Component(second, "small_silo").ask("step") and not arrived.empty())
            subscriber.undeclare()
    finally:
        server.end()


def test_all_traffic_is_logged(tmp_path):
    from mcap_protobuf.decoder import DecoderFactory
    from mcap.reader import make_reader

    path = tmp_path / "served.mcap"
    with served("--log", str(path)) as (server, session, silo):
        silo.ask("step", inputs={GATE: 0.5})
        silo.ask("status")
        raw(session, f"{BASE}/@rpc/step", "{")
        session.put(f"{BASE}/in/{GATE}", "0.25")
        until(lambda: silo.ask("get", outputs=[GATE])["outputs"][GATE] == 0.25)
        silo.ask("step")
        out, _ = server.end()
        assert str(path) in out
    seen = {}
    with path.open("rb") as file:
        for _, channel, _, message in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            seen.setdefault(channel.topic, []).append(message)
    asked = seen[f"{BASE}/@rpc/step/request"]
    answered = seen[f"{BASE}/@rpc/step/reply"]
    assert sorted(a.status for a in answered) == ["bad_request", "ok", "ok"]
    assert json.loads(asked[0].body)["inputs"] == {GATE: 0.5} and asked[0].client == "pytest"
    assert seen[f"{BASE}/@rpc/status/reply"]
    inputs = [(a.step, [(i.values[0], i.source) for i in a.inputs]) for a in seen[f"{BASE}/out/applied"] if a.step]
    assert inputs == [(1, [(0.5, "pytest")]), (2, [(0.25, "set-point")])]


def logged(path):
    """Messages of a log by topic, also of one that was cut."""
    from mcap_protobuf.decoder import DecoderFactory
    from mcap.reader import make_reader

    if path.suffix == ".part":
        whole = path.with_suffix(".whole")
        subprocess.run([os.environ["SANDGATE"], "log", "recover", path, whole], check=True, capture_output=True)
        path = whole
    seen = {}
    with path.open("rb") as file:
        for _, channel, _, message in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            seen.setdefault(channel.topic.removeprefix(f"{BASE}/"), []).append(message)
    return seen


def test_who_asks_for_what_there_is_not_opens_no_topics(tmp_path):
    path = tmp_path / "served.mcap"
    with served("--log", str(path)) as (server, session, silo):
        silo.ask("step")
        for n in range(50):
            [(_, reply)] = raw(session, f"{BASE}/@rpc/verb{n}", json.dumps({"req": str(n), "client": f"c{n}"}))
            assert reply["code"] == "bad_request"
            session.put(f"{BASE}/in/no.variable{n}", json.dumps({"value": 1, "client": f"c{n}"}))
        raw(session, f"{BASE}/@rpc/{'v' * 30_000}", "{}")
        until(lambda: silo.ask("status")["refused_set_points"] == 50)
        server.end()
    seen = logged(path)
    assert {topic for topic in seen if topic.startswith("@")} == {
        *(f"@rpc/{verb}/{half}" for verb in ("step", "status", "unknown") for half in ("request", "reply")),
        "@in/set-point/request",
    }
    asked = seen["@rpc/unknown/request"]
    assert [(a.verb, a.request, a.client) for a in asked[:50]] == [(f"verb{n}", str(n), f"c{n}") for n in range(50)]
    assert asked[50].verb == "v" * 64 + "..."
    points = seen["@in/set-point/request"]
    assert [(p.verb, p.client, p.status) for p in points] == [(f"no.variable{n}", f"c{n}", "unknown_variable") for n in range(50)]
    assert all(json.loads(p.body)["value"] == 1 for p in points)


def test_what_was_answered_or_taken_is_in_the_log_of_a_killed_program(tmp_path):
    path = tmp_path / "served.mcap"
    with served("--log", str(path)) as (server, session, silo):
        session.put(f"{BASE}/in/{GATE}", json.dumps({"value": 0.25, "client": "plc"}))
        until(lambda: silo.ask("get", outputs=[GATE])["outputs"][GATE] == 0.25)
        silo.ask("log", message="before the long step")
        body = json.dumps({"req": "long", "dt_ns": 3_600_000_000_000})
        step = threading.Thread(target=lambda: raw(session, f"{BASE}/@rpc/step", body, timeout=5.0))
        step.start()
        until(lambda: silo.ask("status")["busy"])
        body = json.dumps({"req": "meanwhile", "client": "watcher"})
        assert raw(session, f"{BASE}/@rpc/status", body)[0][1]["ok"]
        time.sleep(1.5)
        server.process.kill()
        step.join()
    seen = logged(path.with_suffix(".mcap.part"))
    [point] = seen["@in/set-point/request"]
    assert (point.verb, point.client, point.status) == (GATE, "plc", "ok")
    assert "meanwhile" in [a.request for a in seen["@rpc/status/request"]]
    assert len(seen["@rpc/status/request"]) == len(seen["@rpc/status/reply"])


def test_what_still_waits_as_the_program_ends_is_in_the_log(tmp_path):
    path = tmp_path / "served.mcap"
    with served("--log", str(path)) as (server, session, silo):
        answers = queue.Queue()

        def ask(n):
            body = json.dumps({"req": str(n), "dt_ns": 300_000_000})
            answers.put(raw(session, f"{BASE}/@rpc/step", body, timeout=60))

        threads = [threading.Thread(target=ask, args=[n]) for n in range(4)]
        for thread in threads:
            thread.start()
        until(lambda: silo.ask("status")["busy"])
        server.process.send_signal(signal.SIGINT)
        for thread in threads:
            thread.join()
        server.process.wait(timeout=60)
    replies = sorted((r["req"], r.get("code", "ok")) for [(_, r)] in (answers.get() for _ in threads))
    assert "state" in [code for _, code in replies]
    assert sorted((r.request, r.status) for r in logged(path)["@rpc/step/reply"]) == replies


def test_the_last_point_is_published_however_fast_steps_come(tmp_path):
    """Steps of a sleeping scene are faster than their publication; who watches has the last one when they pause."""
    with served() as (server, session, silo):
        classes = silo.message_classes()
        last = {}

        def keep(sample):
            message = classes["sandgate.StepStats"].FromString(sample.payload.to_bytes())
            last["step"] = message.step

        subscriber = session.declare_subscriber(f"{BASE}/out/stats", keep)
        silo.ask("run")
        time.sleep(3)
        silo.ask("pause")
        step = silo.ask("status")["step"]
        until(lambda: last.get("step") == step)
        subscriber.undeclare()


def test_the_example_runs():
    with served() as (server, _, _):
        command = [sys.executable, str(ROOT / "examples/bus_client.py"), server.endpoint, "small_silo"]
        example = subprocess.run(command, capture_output=True, text=True, timeout=60)
        assert example.returncode == 0, example.stderr
        assert example.stdout.startswith("step 10: gate at 0.")
        assert "gauge.outlet.discharge" in example.stdout and "account off by 0.0 kg" in example.stdout


@pytest.fixture
def small_disk():
    """A folder with room for 200 kB: a file system of its own where one may be mounted, else a limit on files."""
    folder = tempfile.mkdtemp()
    mount = ["mount", "-t", "tmpfs", "-o", "size=200k", "tmpfs", folder]
    mounted = subprocess.run(mount, capture_output=True).returncode == 0

    def limit():
        if not mounted:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))

    yield pathlib.Path(folder), limit
    if mounted:
        subprocess.run(["umount", folder], check=True)


@pytest.mark.parametrize("required", [False, True])
def test_a_full_disk_ends_the_log_and_the_component_only_if_it_must(tmp_path, small_disk, required):
    folder, limit = small_disk
    scene, log = tmp_path / "silo.toml", folder / "served.mcap"
    usual = 'particles_every = "50 ms"'
    scene.write_text(SCENE.read_text().replace(usual, f"{usual}\nrequired = {str(required).lower()}"))
    command = [os.environ["SANDGATE"], "serve", str(scene), "--threads", "1", "--log", str(log)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=limit
    ) as process:
        try:
            endpoint = next(line for line in process.stdout if line.startswith("listening on ")).split()[-1]
            with open_session(endpoint) as session:
                silo = Component(session, "small_silo", client="pytest")
                lines = []
                reader = threading.Thread(target=lambda: lines.extend(process.stderr), daemon=True)
                reader.start()
                steps = 0
                end = time.monotonic() + 60
                while not lines and process.poll() is None and time.monotonic() < end:
                    try:
                        steps = silo.ask("step", dt_ns=200_000, timeout=10.0)["step"]
                    except Refused as refused:
                        assert required and refused.reply["code"] == "state"
                        assert "log stopped at simulated time" in refused.reply["message"]
                        break
                    except TimeoutError:
                        pass
                if required:
                    # It can be asked why, and what it computed can be rescued.
                    assert "log stopped at simulated time" in silo.ask("status")["log_failure"]
                    assert silo.ask("save")["step"] == steps
                    silo.ask("terminate")
                    process.wait(timeout=60)
                else:
                    until(lambda: "log stopped at simulated time" in (silo.ask("status")["log_failure"] or ""))
                    # It goes on without its log.
                    for more in range(1, 50):
                        assert silo.ask("step", dt_ns=200_000)["step"] == steps + more
            if not required:
                process.send_signal(signal.SIGINT)
            process.wait(timeout=60)
            reader.join(timeout=20)
        finally:
            process.kill()
    told = [line for line in lines if "log stopped at simulated time" in line]
    assert process.returncode == (5 if required else 0), lines
    assert len(told) == 1, lines
    assert any(word in told[0] for word in ("No space left on device", "File too large"))
    assert required == ("the scene requires its log" in told[-1])
    whole = tmp_path / "whole.mcap"
    command = [os.environ["SANDGATE"], "log", "recover", str(log) + ".part", str(whole)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    count = int(re.search(r"whole.mcap: (\d+) messages", done.stdout)[1])
    # Ninety in a hundred bytes of the disk hold whole messages (of a hundred bytes each, with MCAP's own).
    assert count > 1000 and steps > 30
