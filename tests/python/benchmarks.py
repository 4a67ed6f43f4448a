"""What the interfaces cost: every figure that docs/cost.md gives, by one command, which writes that page.

    cargo build --release -p sandgate -p sandgate-fmu -p sandgate-fmu-zenoh
    python tests/python/benchmarks.py --write           # in an environment with tests/python/requirements.txt; about 20 min

Without `--write` the page is printed; names of parts (`getters`, `calls`, `messages`, `stopped`, `cost`, `replay`) do only
these; `--quick` tries each of them for a moment and judges nothing, which the tests do. The solver runs on one thread.
Each figure stands beside what is asked of it; one that misses is marked, and the program then ends with 1.
"""

import argparse
import contextlib
import datetime
import os
import pathlib
import platform
import queue
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "examples"), str(ROOT / "tests/python")]
SILO = ROOT / "tests/scenes/small_silo.toml"
CASE = ROOT / "cases/silo_gate.toml"

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

import paired
from bus_client import Component, open_session
from paired import GATE, watcher


class Bench:
    """Where things are, how thorough to be, and the rows of the page."""

    def __init__(self, target, quick):
        self.target, self.quick, self.rows, self.missed = pathlib.Path(target), quick, [], []

    def row(self, what, found, asked, holds):
        self.rows.append((what, found, asked, holds))
        if not holds:
            self.missed.append(what)
        judged = "" if holds or self.quick else "; MISSED"
        print(f"{what}: {found} (asked: {asked}{judged})", flush=True)

    @property
    def program(self):
        return str(self.target / "sandgate")


def silo(folder, step, spacing=None, log=""):
    """The small silo with another communication step, without schedules: its gate stays shut unless somebody moves it."""
    text = SILO.read_text()
    before, rest = text.split("[[schedule]]")
    text = before + rest.split("\n\n", 1)[1]
    text = re.sub(r'(?m)^step = .*$', f'step = "{step}"', text)
    if spacing:
        text = re.sub(r'(?m)^spacing = .*$', f'spacing = "{spacing}"', text)
    text = re.sub(r'(?m)^particles_every = .*$', log or 'particles_every = "1000 s"', text)
    path = pathlib.Path(folder) / f"silo_{step.replace(' ', '')}.toml"
    path.write_text(text)
    return path


@contextlib.contextmanager
def served(bench, scene, *arguments):
    command = [bench.program, "serve", str(scene), "--instance", "silo", "--threads", "1", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        endpoint = next(line for line in process.stdout if line.startswith("listening on ")).split()[-1]
        with open_session(endpoint) as session:
            yield process, endpoint, session, Component(session, "silo", client="bench")
        process.send_signal(signal.SIGINT)
        process.wait(timeout=60)
    finally:
        process.kill()
        process.wait()


def share(values, part):
    """The value below which a part of them lies."""
    values = sorted(values)
    return values[min(len(values) - 1, int(part * len(values)))]


def getters(bench):
    """tests/c/cost.c, compiled here."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "cost")
        library = str(bench.target)
        subprocess.run(["cc", "-O2", "-std=c99", f"-I{ROOT / 'include'}", str(ROOT / "tests/c/cost.c"), f"-L{library}",
                        f"-Wl,-rpath,{library}", "-lsandgate_fmu", "-o", out], check=True)
        command = [out, str(SILO), str(CASE), "1" if bench.quick else "1.35"]
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    one, count, values = (float(re.search(p, said)[1]) for p in (
        r"values\): (\S+) us", r"by one call \((\d+) variables", r"variables, (\d+) values"))
    step = float(re.search(r"sleeping scene: (\S+) us", said)[1])
    particles, size, save, restore = map(float, re.search(
        r"a state of (\S+) particles, (\S+) bytes: save (\S+) ms, restore (\S+) ms", said).groups())
    bench.row(f"all {count:.0f} gauge variables ({values:.0f} values) by one call of the C interface", f"{one:.2f} us",
              "under 5 us", one < 5)
    bench.row("a step of a scene that sleeps: bounds what a step costs beyond the solver", f"{step:.1f} us",
              "under 20 us", step < 20)
    bench.row(f"saving a state of {particles:.0f} particles ({size / 1e6:.1f} MB)", f"{save:.2f} ms", "under 5 ms", save < 5)
    bench.row("going back to it (neighbour lists are built anew)", f"{restore:.1f} ms", "-", True)


def calls(bench):
    """Round trips of `status`: while steps follow one another, and during one long step."""
    count = 50 if bench.quick else 1000
    with tempfile.TemporaryDirectory() as folder:
        with served(bench, silo(folder, "5 ms"), "--realtime-factor", "1") as (_, _, session, component):
            component.ask("status")
            took, begin = [], component.ask("status")["step"]
            session.put(f"{component.base}/in/{GATE}", "0.1")
            for _ in range(count):
                began = time.perf_counter()
                status = component.ask("status")
                took.append(1e3 * (time.perf_counter() - began))
                time.sleep(0.002)
            steps = status["step"] - begin
        p50, p99 = share(took, 0.5), share(took, 0.99)
        bench.row(f"round trip of {count} calls of `status` while {steps} steps are made, median", f"{p50:.2f} ms",
                  "under 1 ms", p50 < 1 and steps > 0)
        bench.row("the same, 99 of 100", f"{p99:.2f} ms", "under 10 ms", p99 < 10)
        with served(bench, CASE) as (_, _, _, component):
            done = threading.Event()

            def long():
                component.ask("step", dt_ns=20_000_000 if bench.quick else 200_000_000, timeout=600)
                done.set()

            took, seen = [], 0
            thread = threading.Thread(target=long)
            thread.start()
            while not done.is_set():
                began = time.perf_counter()
                status = component.ask("status")
                if status["busy"]:
                    seen += 1
                    took.append(1e3 * (time.perf_counter() - began))
                time.sleep(0.002)
            thread.join()
        bench.row(f"slowest of {seen} calls of `status` during one long step of silo_gate", f"{max(took):.1f} ms", "under 100 ms",
                  max(took) < 100)


def messages(bench):
    """10,000 messages a second to a subscriber that takes them."""
    seconds = 2 if bench.quick else 20
    with tempfile.TemporaryDirectory() as folder:
        with served(bench, silo(folder, "1 ms", spacing="8 mm")) as (_, _, session, component):
            classes = component.message_classes()
            arrived = queue.SimpleQueue()
            keep = arrived.put
            subscriber = session.declare_subscriber(
                f"{component.base}/out/**", lambda s: keep((str(s.key_expr), str(s.encoding), s.payload.to_bytes())))
            component.ask("step")
            topics = len({key for key, _, _ in drained(arrived, 0.5)})
            # As many steps a second of wall time as make 10,500 messages of these topics.
            factor = 10_500 / topics * 1e-3
            component.ask("run", realtime_factor=factor)
            began = time.perf_counter()
            time.sleep(seconds)
            component.ask("pause")
            took = time.perf_counter() - began
            got = drained(arrived, 2.0)
            dropped = component.ask("status")["dropped_publications"]
            subscriber.undeclare()
    sequences = {}
    for key, encoding, data in got:
        if encoding.endswith("sandgate.Gauge"):
            sequences.setdefault(key, []).append(classes["sandgate.Gauge"].FromString(data).sequence)
    lost = sum(b - a - 1 for numbers in sequences.values() for a, b in zip(numbers, numbers[1:]))
    rate = len(got) / took
    bench.row(f"messages a second to a subscriber in Python, {took:.0f} s", f"{rate:.0f}", "10,000", rate >= 10_000)
    bench.row(f"gauges lost of {sum(map(len, sequences.values()))}", f"{lost}, publications dropped: {dropped}", "none",
              lost == 0 and dropped == 0)


def drained(arrived, patience):
    """What is in a queue until nothing comes any more."""
    found = []
    with contextlib.suppress(queue.Empty):
        while True:
            found.append(arrived.get(timeout=patience))
    return found


def stopped(bench):
    """Steps at a pace, logged with the wall clock: how late each was, and how late another subscriber got its messages, beside
    subscribers that do not take what they get; and what these missed, by the numbers of the messages."""
    seconds = 3 if bench.quick else 25
    for how in ("nobody", "sleeping in its callback", "stopped by SIGSTOP"):
        arrived = []
        with tempfile.TemporaryDirectory() as folder:
            log = os.path.join(folder, "silo.mcap")
            scene = silo(folder, "1 ms", spacing="8 mm")
            with served(bench, scene, "--log", log) as (_, endpoint, session, component):
                Gauge = component.message_classes()["sandgate.Gauge"]
                subscriber = session.declare_subscriber(
                    f"{component.base}/out/gauge/level.depth", lambda s: arrived.append((time.time(), s.payload.to_bytes())))
                with watcher(endpoint, 1.0 if "sleeping" in how else 0.0) if how != "nobody" else contextlib.nullcontext() as child:
                    component.ask("run", realtime_factor=0.5)
                    time.sleep(0.5)
                    if "STOP" in how:
                        child.send_signal(signal.SIGSTOP)
                    time.sleep(seconds)
                    pause = component.ask("status")["step"]
                    if child:
                        if "STOP" in how:
                            child.send_signal(signal.SIGCONT)
                        print(pause + 1, file=child.stdin, flush=True)
                        first, last, count, missed = map(int, child.stdout.readline().split())
                    dropped = component.ask("pause") and component.ask("status")["dropped_publications"]
                subscriber.undeclare()
            late = lateness(log)
        # Not what comes after, while the watcher catches up with what was kept for it.
        late = [lag for step, lag in enumerate(late) if step < pause]
        gauges = [(wall, Gauge.FromString(data)) for wall, data in arrived]
        numbers = [gauge.sequence for _, gauge in gauges]
        offsets = [wall - gauge.time / 0.5 for wall, gauge in gauges if gauge.step < pause]
        worst, other = max(late), 1e3 * (max(offsets) - min(offsets))
        bench.row(f"latest of {len(late)} steps at a pace of 500 a second, subscriber: {how}", f"{worst:.1f} ms",
                  "under 50 ms" if how != "nobody" else "-", worst < 50 or how == "nobody")
        lost = numbers[-1] - numbers[0] + 1 - len(numbers)
        bench.row("latest message at another subscriber", f"{other:.1f} ms, lost: {lost}, publications dropped: {dropped}",
                  "none lost", lost == 0 and dropped == 0)
        if how != "nobody":
            bench.row("messages of one gauge that it missed, by their numbers", f"{missed} of {last - first + 1}",
                      "counted", missed > 0 and count + missed == last - first + 1)


def lateness(log):
    """How much later than its pace each step ended [ms]."""
    walls, times = [], []
    with open(log, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for schema, _, message, value in reader.iter_decoded_messages(topics=["sandgate/v1/silo/out/applied"], log_time_order=False):
            if value.event == value.Event.Value("STEP"):
                walls.append(message.publish_time * 1e-9)
                times.append(value.t / 0.5)
    offsets = [wall - t for wall, t in zip(walls, times)]
    start = min(offsets)
    return [1e3 * (offset - start) for offset in offsets]


def cost(bench):
    """CPU time of silo_gate with and without what watches it, step by step side by side (paired.py)."""
    pairs, steps = (1, 1) if bench.quick else (15, 4)
    library = str(bench.target / "libsandgate_fmu_zenoh.so")
    with tempfile.TemporaryDirectory() as folder:
        text = CASE.read_text()
        quiet = re.sub(r'(?m)^particles_every = .*$', 'particles_every = "1000 s"', text)
        often = re.sub(r'(?m)^particles_every = .*$', 'particles_every = "40 ms"', text)
        assert quiet != often
        scenes = {}
        for name, text in (("quiet", quiet), ("often", often)):
            # The same file name for both: a component's name is its scene's.
            (pathlib.Path(folder) / name).mkdir()
            scenes[name] = pathlib.Path(folder) / name / CASE.name
            scenes[name].write_text(text)
        config = "{metadata: {sandgate: {instance: 'silo'}}}"
        # What is only compared with has half the steps.
        variants = [
            ("nothing at all, for comparison", "-", 1.0, "quiet", 2, dict()),
            ("no log, a Zenoh session and nobody watching", "nothing measurable", None, "quiet", 2, dict(config=config)),
            ("a log, and publishing to a subscriber, every 10 ms", "under 2 %", 0.02, "quiet", 1,
             dict(config=config, watched=True, log=True)),
            ("a log with particles at 25 Hz", "under 10 %", 0.10, "often", 1, dict(log=True)),
        ]
        noise = 0.0
        for what, asked, most, scene, part, extra in variants:
            n = max(1, steps // part)
            found = [paired.pair(library, scenes[scene], n, 0.01, folder, **extra) for _ in range(pairs)]
            shares, others = zip(*found)
            middle = statistics.median(shares)
            spread = (share(shares, 0.25), share(shares, 0.75))
            noise = noise or max(0.01, *map(abs, spread))
            threads = f"; its threads alone {100 * statistics.median(others):+.2f} %" if extra else ""
            bench.row(f"CPU time of silo_gate: {what}, over without; median of {pairs} pairs of {2 * n} steps each",
                      f"{100 * middle:+.2f} % (half of the pairs {100 * spread[0]:+.1f} to {100 * spread[1]:+.1f} %{threads})",
                      asked, abs(middle) < noise if most is None else middle < most)


def replay(bench):
    """A minute of log at its own speed: how late, and whether the bytes are the recorded ones."""
    seconds = 1 if bench.quick else 61
    with tempfile.TemporaryDirectory() as folder:
        scene = silo(folder, "5 ms")
        out = os.path.join(folder, "out")
        subprocess.run([bench.program, "run", scene, "--until", f"{seconds} s", "--threads", "1", "--out", out], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        log = os.path.join(out, "run.mcap")
        process = subprocess.Popen([bench.program, "log", "replay", log, "--wait"], stdout=subprocess.PIPE, text=True)
        endpoint = next(line for line in process.stdout if line.startswith("listening on ")).split()[-1]
        arrived = queue.SimpleQueue()
        with open_session(endpoint) as session:
            subscriber = session.declare_subscriber(
                "sandgate/v1/small_silo/out/**", lambda s: arrived.put((str(s.key_expr), s.payload.to_bytes())))
            said = process.communicate(timeout=seconds + 60)[0]
            got = drained(arrived, 1.0)
            subscriber.undeclare()
        recorded, replayed = {}, {}
        with open(log, "rb") as stream:
            for _, channel, message in make_reader(stream).iter_messages(log_time_order=False):
                if "/out/" in channel.topic:
                    recorded.setdefault(channel.topic, []).append(message.data)
        for key, data in got:
            replayed.setdefault(key, []).append(data)
    count, took, latest, last = map(float, re.search(
        r"published (\d+) messages in (\S+) s, at most (\S+) ms late, the last one (\S+) ms", said).groups())
    bench.row(f"drift of a replay at speed 1 after {took:.0f} s: how late its last message was", f"{last:.2f} ms", "under 5 ms", last < 5)
    bench.row("how late any was", f"{latest:.2f} ms", "-", True)
    bench.row(f"its {count:.0f} messages", "the recorded bytes" if replayed == recorded else "DIFFER", "the recorded bytes",
              replayed == recorded)


PARTS = {part.__name__: part for part in (getters, calls, messages, stopped, cost, replay)}
PAGE = """# What the interfaces cost

Written by `python tests/python/benchmarks.py --write` on {date} on {machine}, {beside} (load {load:.1f}, its own
among it).
The solver runs on one thread; clients are Python's eclipse-zenoh on loopback. What each part does stands in the script.

| what | found | asked for |
|---|---|---|
{rows}

An hour of clients that come and go: docs/zenoh.md, "Soak".
"""


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), platform.machine())
    return f"{os.cpu_count()} cores of an {model}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", choices=[[], *PARTS], help="which parts; all if none is named")
    parser.add_argument("--target", default=str(ROOT / "target/release"), help="folder of program and libraries")
    parser.add_argument("--quick", action="store_true", help="whether everything works, no figures")
    parser.add_argument("--write", action="store_true", help="write docs/cost.md")
    arguments = parser.parse_args()
    bench = Bench(arguments.target, arguments.quick)
    for name in arguments.parts or PARTS:
        PARTS[name](bench)
    rows = [f"| {what} | {found}{'' if holds else ' **missed**'} | {asked} |" for what, found, asked, holds in bench.rows]
    load = os.getloadavg()[2]
    beside = "nothing else running on it" if load < 1.5 else "other work running beside it"
    page = PAGE.format(date=datetime.date.today(), machine=machine(), load=load, beside=beside, rows="\n".join(rows))
    if arguments.write and not arguments.quick:
        (ROOT / "docs/cost.md").write_text(page)
    sys.exit(1 if bench.missed and not bench.quick else 0)


if __name__ == "__main__":
    main()
