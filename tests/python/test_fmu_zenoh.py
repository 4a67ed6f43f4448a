"""FMUs that publish on Zenoh and take set-points while FMPy steps them; the client is Python's own Zenoh.

Run by tests/it/fmu.rs, which packs the FMUs with the library that has Zenoh.

SANDGATE_PROGRAM  the program
SANDGATE_PLAIN    the FMU without Zenoh
SANDGATE_PLAIN_LIBRARY  the library without Zenoh
"""

import ctypes
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import threading
import time

import pytest

sys.path.insert(0, os.path.dirname(__file__))
sys.path.insert(0, str(pathlib.Path(os.environ["SANDGATE_ROOT"]) / "examples"))

import zenoh
from bus_client import Component, Refused, open_session
from fmpy.fmi1 import FMICallException

from importer import Fmu, Library
from scheduled import FMUS, H, LIBRARY, PATH, run, through_the_c_interface

PROGRAM = os.environ["SANDGATE_PROGRAM"]
GATE, RATE = "gate.sluice.opening", "inflow.feed.rate"
BASE = "sandgate/v1/instance"
both = pytest.mark.parametrize("version", [2, 3])


def until(condition, seconds=20.0):
    """Waits for what must become true; polls, so that a slow machine only takes longer."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)


class Published:
    """An initialised FMU on Zenoh, and a client."""

    def __init__(self, version, config="{}", **start_values):
        self.fmu = Fmu(FMUS[version]).initialize(zenoh__config=config, **start_values)
        told = [m for _, category, m in self.fmu.messages if category == "logEvents" and "listening on" in m]
        name, self.endpoint = re.fullmatch(r"publishing sandgate/v1/(\S+), listening on (\S+)", told[-1]).groups()
        self.session = open_session(self.endpoint)
        self.client = Component(self.session, name, client="pytest")

    def point(self, name, value):
        """A set-point that has arrived when this returns: nothing tells so but the reply to a later request."""
        self.session.put(f"{self.client.base}/in/{name}", json.dumps({"value": value, "client": "plc"}))
        self.client.ask("status")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.session.close()
        self.fmu.free()


@both
def test_a_client_watches_an_fmu_that_fmpy_steps(version):
    with Published(version) as p:
        assert p.endpoint.startswith("tcp/127.0.0.1:")
        classes = p.client.message_classes()
        arrived, lock = [], threading.Lock()

        def keep(sample):
            with lock:
                arrived.append((str(sample.key_expr).removeprefix(p.client.base + "/"), sample.payload.to_bytes()))

        subscriber = p.session.declare_subscriber(f"{p.client.base}/out/**", keep)
        tokens = list(p.session.liveliness().get(f"{p.client.base}/@alive"))
        assert len(tokens) == 1
        p.client.ask("status")
        steps = 4
        run(p.fmu, last=steps)
        last = {"gauge.past_gate.discharge", "gate.sluice.actual_opening", "mass.present"}
        expected = dict(zip(sorted(last), p.fmu.get(sorted(last))))

        def seen(name):
            kind, rest = name.split(".", 1)
            with lock:
                gauges = [classes["sandgate.Gauge"].FromString(data) for key, data in arrived if key == f"out/{kind}/{rest}"]
            # What holds before the first step goes out by itself, maybe after the subscriber came.
            return [gauge for gauge in gauges if gauge.step > 0]

        until(lambda: all(len(seen(name)) == steps for name in last))
        for name in last:
            assert [g.step for g in seen(name)] == [1, 2, 3, 4] and seen(name)[-1].values[0] == expected[name]
            assert seen(name)[-1].time == steps * H
        status = p.client.ask("status")
        assert (status["step"], status["t_ns"], status["mode"]) == (steps, round(steps * H * 1e9), "stepping")
        assert p.client.ask("get", outputs=sorted(last))["outputs"] == expected
        names = {v["name"] for v in p.client.ask("describe")["variables"]}
        assert GATE in names and "log.path" not in names
        # Time has an owner already.
        for verb, fields in (("step", {}), ("reset", {}), ("restore", {"state": "AAAA"}), ("set", {"inputs": {GATE: 1.0}}),
                             ("run", {}), ("save", {}), ("terminate", {})):
            with pytest.raises(Refused) as refused:
                p.client.ask(verb, **fields)
            assert refused.value.reply["code"] == "not_owner"
        with pytest.raises(Refused) as refused:
            p.client.ask("get", outputs=["nothing"])
        assert refused.value.reply["code"] == "unknown_variable"

        # Somebody subscribes to particles, too: they are built from when Zenoh has told so, and come behind gauges.
        def applied_and_particles():
            nonlocal steps
            run(p.fmu, first=steps, last=steps + 1)
            steps += 1
            with lock:
                return {"out/applied", "out/particles"} <= {key for key, _ in arrived}

        until(applied_and_particles)
        subscriber.undeclare()


@both
def test_publishing_changes_no_bit(version):
    with Published(version) as p:
        assert run(p.fmu, last=8) == through_the_c_interface()[:8]


@both
def test_set_points_hold_from_the_next_step_but_the_importer_wins(version, tmp_path):
    path = tmp_path / "run.mcap"
    with Published(version, log__path=str(path)) as p:
        fmu = p.fmu
        p.point(GATE, 0.5)
        assert fmu.get([GATE]) == [0.0]
        fmu.step(0.0, H)
        assert fmu.get([GATE]) == [0.5]
        # Back and forth again: it still holds.
        state = fmu.get_state()
        p.point(RATE, 0.25)
        for _ in range(2):
            fmu.step(H, H)
            assert fmu.get([GATE, RATE]) == [0.5, 0.25]
            fmu.set_state(state)
            assert fmu.get([RATE]) != [0.25]
        fmu.free_state(state)
        # The importer sets it: one that came in the same time is refused, the earlier one holds no longer.
        p.point(GATE, 0.75)
        fmu.set(GATE, 0.125)
        before = p.client.ask("status")["refused_set_points"]
        fmu.step(H, H)
        assert fmu.get([GATE, RATE]) == [0.125, 0.25]
        assert p.client.ask("status")["refused_set_points"] == before + 1
        fmu.step(2 * H, H)
        assert fmu.get([GATE]) == [0.125]
        # A later one counts again; what is out of range does not.
        p.point(GATE, 1.0)
        p.point(GATE, 7.0)
        p.point("solver.resolution_scale", 2.0)
        fmu.step(3 * H, H)
        assert fmu.get([GATE]) == [1.0]
        assert p.client.ask("status")["refused_set_points"] == before + 3
    done = subprocess.run([PROGRAM, "log", "redrive", path, "--check"], capture_output=True, text=True)
    assert done.returncode == 0 and "same bits: 6 steps" in done.stdout, done.stdout + done.stderr
    said = subprocess.run([PROGRAM, "log", "cat", path, "--topic", "out/*", "--json"], capture_output=True, text=True).stdout
    assert '"plc"' in said and "its owner sets it" in said


@both
def test_the_newest_set_point_counts_however_many_came(version, tmp_path):
    path = tmp_path / "run.mcap"
    with Published(version, log__path=str(path)) as p:
        block = {"congestion_control": zenoh.CongestionControl.BLOCK}
        p.session.put(f"{p.client.base}/in/{RATE}", '{"value": 0.25, "client": "quiet"}', **block)
        for n in range(500):
            p.session.put(f"{p.client.base}/in/{GATE}", json.dumps({"value": n / 500, "client": "chatty"}), **block)
        p.client.ask("status")
        p.fmu.step(0.0, H)
        assert p.fmu.get([GATE, RATE]) == [499 / 500, 0.25]
        assert p.client.ask("status")["refused_set_points"] == 0
    said = subprocess.run([PROGRAM, "log", "cat", "--json", path], capture_output=True, text=True, check=True).stdout
    lines = [line for line in map(json.loads, said.splitlines()) if "/@in/" in line["topic"]]
    became = [line["value"]["status"] for line in lines if line["value"]["client"] == "chatty"]
    assert became == ["superseded"] * 499 + ["ok"]
    done = subprocess.run([PROGRAM, "log", "redrive", path, "--check"], capture_output=True, text=True)
    assert done.returncode == 0 and "same bits: 1 steps" in done.stdout, done.stdout + done.stderr


@both
def test_what_clients_ask_is_answered_as_by_a_server(version):
    with Published(version) as p:
        p.fmu.step(0.0, H)
        whole = p.client.ask("get", outputs=["gauge.surface.depth"])["outputs"]["gauge.surface.depth"]
        name = "gauge.surface.depth[2]"
        assert p.client.ask("get", outputs=[name])["outputs"] == {name: whole[1]}
        assert name not in p.client.ask("get")["outputs"]
        with pytest.raises(Refused) as refused:
            p.client.ask("step", expect_step=7)
        assert refused.value.reply["code"] == "not_owner"


@both
def test_status_tells_the_step_of_the_importer(version):
    with Published(version) as p:
        assert p.client.ask("status")["busy"] is None
        step = threading.Thread(target=lambda: p.fmu.step(0.0, 200 * H))
        step.start()
        seen = []
        while step.is_alive():
            seen.append(p.client.ask("status"))
        step.join()
        busy = [s["busy"] for s in seen if s["step"] == 0 and s["busy"]]
        assert busy and busy[0] == {"verb": "step", "client": f"fmi{version}", "req": ""}
        assert p.client.ask("status")["busy"] is None
        with pytest.raises(FMICallException):
            p.fmu.step(0.0, H)
        assert p.client.ask("status")["busy"] is None


def test_a_state_of_other_parameters_publishes_its_scene():
    first = Fmu(FMUS[3]).initialize()
    saved = first.save()
    first.free()
    with Published(3, solver__resolution_scale=1.25) as p:
        def drawn():
            [reply] = p.session.get(f"{p.client.base}/out/scene")
            return reply.ok.payload.to_bytes()

        before = drawn()
        p.fmu.restore(saved)
        p.client.ask("status")
        assert drawn() != before


@both
def test_a_blank_configuration_is_none(version):
    fmu = Fmu(FMUS[version]).initialize(zenoh__config=" \n")
    assert not any("publishing" in text for _, _, text in fmu.messages)
    fmu.free()


@both
def test_clamped_set_points_are_told(version):
    with Published(version, saturate_inputs=True) as p:
        heard = []
        subscriber = p.session.declare_subscriber(f"{p.client.base}/out/log", lambda s: heard.append(s.payload.to_bytes()))
        p.client.ask("status")
        p.point(GATE, 1.5)
        p.fmu.step(0.0, H)
        assert p.fmu.get([GATE]) == [1.0]
        until(lambda: any(b"clamped to 1" in data for data in heard))
        # What was taken holds: it is told once and not at each step.
        for step in (1, 2):
            p.fmu.step(step * H, H)
        p.point(RATE, 1e9)
        p.fmu.step(3 * H, H)
        until(lambda: any(RATE.encode() in data for data in heard))
        assert sum(GATE.encode() in data for data in heard) == 1
        subscriber.undeclare()


@both
def test_bad_configurations_are_refused_and_can_be_corrected(version, tmp_path):
    taken = Published(version)
    fmu = Fmu(FMUS[version])
    unreachable = tmp_path / "none.json5"
    open_one = "listen: {endpoints: ['tcp/0.0.0.0:0']}"
    cases = {
        "{listen: 7}": "Zenoh configuration",
        str(unreachable): "none.json5",
        "/dev/zero": "found a folder, device or pipe",
        "{%s}" % open_one: "add metadata: {sandgate: {allow_open_listener: true}}",
        "{metadata: {sandgate: 7}}": "found 7, allowed an object",
        "{metadata: {sandgate: {instance: 'A b'}}}": "a-z 0-9",
        "{metadata: {sandgate: {open: true}}}": "allow_open_listener",
        "{listen: {endpoints: ['%s']}}" % taken.endpoint: "port in use? choose another by listen:",
    }
    fmu.fmu.enterInitializationMode()
    for config, why in cases.items():
        fmu.messages.clear()
        fmu.set("zenoh.config", config)
        with pytest.raises(FMICallException):
            fmu.fmu.exitInitializationMode()
        assert why in fmu.messages[-1][2] and "ExitInitializationMode: zenoh.config" in fmu.messages[-1][2], config
    file = tmp_path / "zenoh.json5"
    file.write_text("{%s, metadata: {sandgate: {instance: 'silo-7', allow_open_listener: true}}}" % open_one)
    fmu.set("zenoh.config", str(file))
    fmu.fmu.exitInitializationMode()
    assert any(re.search("sandgate/v1/silo-7, listening on tcp/0.0.0.0:[1-9]", m) for _, _, m in fmu.messages)
    fmu.free()
    taken.__exit__()


@both
def test_its_log_has_what_was_asked_to_the_last(version, tmp_path):
    path = tmp_path / "run.mcap"
    with Published(version, log__path=str(path)) as it:
        it.fmu.step(0.0, H)
        it.client.ask("get", outputs=[GATE])
        it.point(GATE, 0.25)
        for n in range(3):
            [reply] = it.session.get(f"{it.client.base}/@rpc/verb{n}", payload="{}")
            assert json.loads(reply.ok.payload.to_string())["code"] == "bad_request"
    said = subprocess.run([PROGRAM, "log", "cat", "--json", path], capture_output=True, text=True, check=True).stdout
    asked = {}
    for line in map(json.loads, said.splitlines()):
        if line["topic"].startswith(f"{BASE}/@rpc/") or "/@in/" in line["topic"]:
            asked.setdefault(line["topic"].removeprefix(f"{BASE}/"), []).append(line["value"])
    assert [a["verb"] for a in asked["@rpc/unknown/request"]] == ["verb0", "verb1", "verb2"]
    assert len(asked["@rpc/get/request"]) == len(asked["@rpc/get/reply"]) == 1
    # No step followed that could have used it.
    [point] = asked["@in/set-point/request"]
    assert (point["verb"], point["client"], point["status"]) == (GATE, "plc", "state")


def open_things():
    return len(os.listdir("/proc/self/task")), len(os.listdir("/proc/self/fd"))


def sockets():
    """Sockets and listeners of this process."""
    links = (f"/proc/self/fd/{fd}" for fd in os.listdir("/proc/self/fd"))
    return sum(os.path.exists(link) is False and "socket:" in os.readlink(link) for link in links if os.path.islink(link))


@both
def test_a_thousand_instances_with_log_and_zenoh_leave_what_is_documented(version, tmp_path):
    """Zenoh's own threads stay with the process, as many as after the first session, and no socket and no file."""
    fmu = Fmu(FMUS[version], logging=False)
    reference = {name: fmu.variables[name].valueReference for name in ("log.path", "zenoh.config")}
    first = None
    for k in range(1000):
        fmu.fmu.setString(list(reference.values()), [str(tmp_path / f"{k}.mcap"), "{}"])
        fmu.initialize()
        getattr(fmu.fmu, f"fmi{version}FreeInstance")(fmu.fmu.component)
        if version == 2:
            fmu.fmu.instantiate(callbacks=fmu.callbacks)
        else:
            fmu.fmu.instantiate()
        if k == 4:
            first = *open_things(), sockets()
    until(lambda: all(now <= then for now, then in zip((*open_things(), sockets()), first)))
    assert len(os.listdir(tmp_path)) == 1000 and not any(file.name.endswith(".part") for file in tmp_path.iterdir())
    fmu.free()


def test_a_subscriber_that_takes_nothing_keeps_no_fmu_from_ending(tmp_path):
    """It ends with its log whole, and the next one of the process is heard."""
    log = tmp_path / "run.mcap"
    text = f"""
import sys, time
sys.path.insert(0, {os.environ["SANDGATE_ROOT"] + "/examples"!r})
from bus_client import open_session
with open_session(sys.argv[1]) as session:
    kept = session.declare_subscriber("{BASE}/out/**", lambda sample: None)
    print("subscribed", flush=True)
    time.sleep(600)
"""
    with Published(3, log__path=str(log)) as p:
        child = subprocess.Popen([sys.executable, "-c", text, p.endpoint], stdout=subprocess.PIPE, text=True)
        try:
            assert child.stdout.readline() == "subscribed\n"
            child.send_signal(signal.SIGSTOP)
            for k in range(1500):
                p.fmu.step(k * H / 100, H / 100)
            began = time.monotonic()
            p.fmu.fmu.terminate()
            # It gives up closing after 3 s; the rest is for a slow machine.
            assert time.monotonic() - began < 15
            assert log.exists() and not os.path.exists(f"{log}.part")
        finally:
            child.kill()
            child.wait()
    with Published(3) as p:
        heard = []
        watch = p.session.declare_subscriber(f"{p.client.base}/out/**", heard.append)
        p.client.ask("status")
        p.fmu.step(0.0, H)
        until(lambda: heard)
        watch.undeclare()


def test_the_c_library_publishes_alike():
    library = Library(LIBRARY, PATH)
    assert library.lib.sandgate_capabilities() & 64
    told = []
    kind = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_char_p)
    logger = kind(lambda _, category, message: told.append(message.decode()))
    library.check(library.lib.sandgate_set_logger(library.handle, logger, None))
    reference = ctypes.c_uint32(library.references["zenoh.config"])
    library.check(library.lib.sandgate_set_text(library.handle, reference, b"{}"))
    library.initialize()
    endpoint = next(text.split()[-1] for text in told if "listening on" in text)
    with open_session(endpoint) as session:
        client = Component(session, "devices", client="pytest")
        run(library, last=2)
        assert client.ask("status")["step"] == 2
    library.free()


def test_a_refused_step_takes_no_set_point_and_leaves_the_importer_what_it_owns():
    with Published(3) as p:
        p.point(GATE, 0.75)
        before = p.fmu.save()
        with pytest.raises(FMICallException):
            p.fmu.step(9.0, H)
        assert p.fmu.save() == before
        p.fmu.step(0.0, H)
        assert p.fmu.get([GATE]) == [0.75]
        p.fmu.set(GATE, 0.25)
        with pytest.raises(FMICallException):
            p.fmu.step(9.0, H)
        p.point(GATE, 0.5)
        p.fmu.step(H, H)
        assert p.fmu.get([GATE]) == [0.25]


def test_a_network_that_cannot_open_costs_no_log(tmp_path):
    with Published(3) as first:
        first.fmu.step(0.0, H)
        saved = first.fmu.save()
    fmu = Fmu(FMUS[3])
    path = tmp_path / "run.mcap"
    for name, value in [("log.required", False), ("log.path", str(path)), ("zenoh.config", str(tmp_path / "none.json5"))]:
        fmu.set(name, value)
    fmu.restore(saved)
    fmu.step(H, H)
    fmu.free()
    assert any("none.json5" in text for _, _, text in fmu.messages)
    done = subprocess.run([PROGRAM, "log", "redrive", path, "--check"], capture_output=True, text=True)
    assert done.returncode == 0 and "same bits: 1 steps" in done.stdout, done.stdout + done.stderr


@both
def test_a_session_stays_with_the_process_that_opened_it(version):
    with Published(version) as p:
        p.fmu.step(0.0, H)
        child = os.fork()
        if child == 0:
            # Who waits for threads that are not there is ended.
            signal.alarm(60)
            code = 1
            try:
                p.fmu.messages.clear()
                p.fmu.step(H, H)
                told = any("stays with the process" in text for _, _, text in p.fmu.messages)
                p.fmu.fmu.terminate()
                p.fmu.reset()
                try:
                    p.fmu.initialize(zenoh__config="{}")
                except FMICallException:
                    refused = "forked" in p.fmu.messages[-1][2]
                    p.fmu.fmu.freeInstance()
                    code = 0 if told and refused else 2
            finally:
                os._exit(code)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
        assert p.client.ask("status")["step"] == 1
        p.fmu.step(H, H)
        assert p.client.ask("status")["step"] == 2


def test_an_fmu_without_zenoh_says_how_to_get_it():
    fmu = Fmu(os.environ["SANDGATE_PLAIN"])
    with pytest.raises(FMICallException):
        fmu.set("zenoh.config", "{}")
    assert "sandgate fmu --zenoh" in fmu.messages[-1][2]
    library = Library(os.environ["SANDGATE_PLAIN_LIBRARY"], PATH)
    reference = ctypes.c_uint32(library.references["zenoh.config"])
    assert library.lib.sandgate_set_text(library.handle, reference, b"{}") == 3
    assert b"link -lsandgate_fmu_zenoh" in library.lib.sandgate_last_error(library.handle)
    library.free()
    fmu.set("zenoh.config", "")
    fmu.free()
