"""A served silo for minutes or hours, with clients that come and go every few seconds: memory, threads and open files stay.

Run by hand, not by the tests (docs/zenoh.md has what a run gave):

    cargo build --release
    python tests/python/soak.py --minutes 60            # in an environment with tests/python/requirements.txt

A client connects, watches everything, sends set-points and requests, and leaves: by closing its session, or (every third
one) killed. Every client has a process of its own, as clients have. One in ten resets the component, which begins a new log
file. Every ten seconds a line: time, resident memory and what of it was allocated (the rest are pages of the program's file),
threads, open files, communication steps, publications that were dropped.

Memory counts as flat if its median over the last twelfth of the run is at most 2 % above that of the twelfth that ends half a
run earlier (an hour: the last five minutes, and those half an hour before). Threads and open files may not be more at most in
the second half than in the first.
"""

import argparse
import json
import os
import pathlib
import random
import signal
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "examples"))
SCENE = ROOT / "tests/scenes/small_silo.toml"
GATE = "gate.main.opening"
# How much memory may grow over the second half of the run, as a share: 0.6 MB of 29 MB.
FLAT = 0.02


def client(endpoint, seed):
    """One client's life, until it ends or is killed."""
    from bus_client import Component, open_session

    lots = random.Random(seed)
    with open_session(endpoint) as session:
        # Each request is sent once: one that gets no answer is a failure.
        silo = Component(session, "small_silo", client=f"soak-{seed}", attempts=1)
        seen = []
        session.declare_subscriber(f"{silo.base}/out/**", lambda sample: seen.append(len(sample.payload.to_bytes())))
        if seed % 10 == 0:
            silo.ask("reset")
            silo.ask("run", realtime_factor=1.0)
        for _ in range(lots.randrange(5, 20)):
            session.put(f"{silo.base}/in/{GATE}", json.dumps(lots.random()))
            silo.ask(lots.choice(["status", "get", "describe"]))
            time.sleep(0.1 * lots.random())
        # Another client that does not take what it gets (killed, or starved by this machine) may hold it up for a second.
        end = time.monotonic() + 20.0
        while not seen and time.monotonic() < end:
            time.sleep(0.05)
        assert seen, "nothing was published"


def figures(process):
    """Resident memory [kB], what of it was allocated [kB], threads, open files."""
    status = pathlib.Path(f"/proc/{process.pid}/status").read_text()
    field = lambda name: int(next(line for line in status.splitlines() if line.startswith(name)).split()[1])
    return field("VmRSS"), field("RssAnon"), field("Threads"), len(os.listdir(f"/proc/{process.pid}/fd"))


def growth(rows, duration):
    """By what share memory grew over the second half of the run; printed, for all of it and for what was allocated."""
    shares = []
    for column, name in ((1, "resident"), (2, "allocated")):
        means = []
        for end in (0.5 * duration, duration):
            part = [row[column] for row in rows if end - duration / 12.0 <= row[0] <= end]
            means.append(statistics.median(part) if part else float("nan"))
        early, late = means
        shares.append(late / early - 1.0)
        print(f"{name} memory: {early:.0f} kB before half of the run, {late:.0f} kB before its end: {100 * shares[-1]:+.2f} %")
    # Not a number (no sample in one of the parts) is no proof of flatness.
    return shares[0] if shares[0] == shares[0] else float("inf")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--program", default=str(ROOT / "target/release/sandgate"))
    arguments = parser.parse_args()
    import zenoh
    from bus_client import Component, open_session

    with tempfile.TemporaryDirectory() as folder:
        command = [arguments.program, "serve", str(SCENE), "--threads", "1", "--realtime-factor", "1",
                   "--log", os.path.join(folder, "soak.mcap")]
        server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        endpoint = next(line for line in server.stdout if line.startswith("listening on ")).split()[-1]
        begin, told, seed, failed, killed, rows = time.monotonic(), 0.0, 0, 0, 0, []
        while time.monotonic() - begin < 60.0 * arguments.minutes and server.poll() is None:
            seed += 1
            child = subprocess.Popen([sys.executable, __file__, "client", endpoint, str(seed)])
            if seed % 3 == 0:
                time.sleep(1.0 + 0.1 * (seed % 7))
                child.send_signal(signal.SIGKILL)
                child.wait()
                killed += 1
            else:
                failed += child.wait() != 0
            now = time.monotonic() - begin
            if now - told >= 10.0:
                told = now
                try:
                    with open_session(endpoint) as session:
                        status = Component(session, "small_silo").ask("status")
                except zenoh.ZError as why:  # Zenoh's own patience with a machine that is busy elsewhere.
                    print(f"{now:8.0f} s  no session: {why}", flush=True)
                    continue
                # Sessions of clients that were killed end when their connection is found closed.
                time.sleep(0.5)
                rows.append((now, *figures(server), status["step"], status["dropped_publications"]))
                print("{:8.0f} s  {:8d} kB, allocated {:8d} kB  {:3d} threads  {:3d} files  step {:6d}  dropped {}".format(*rows[-1]), flush=True)
        server.send_signal(signal.SIGINT)
        server.communicate(timeout=60)
        logs = sorted(pathlib.Path(folder).iterdir())
        # The files that begin with a reset; those with particles of a minute each run again in seconds.
        checked = subprocess.run([arguments.program, "log", "redrive", "--check", *map(str, logs[:3])], capture_output=True, text=True)
    print(f"{len(rows)} samples, {seed} clients ({killed} killed, {failed} failed), {len(logs)} log files, exit code {server.returncode}")
    grown = growth(rows, 60.0 * arguments.minutes)
    settled = rows[len(rows) // 5:]
    half = len(settled) // 2
    before, after = ([max(row[k] for row in part) for k in (3, 4)] for part in (settled[:half], settled[half:]))
    print(f"at most in the first half and in the second: threads {before[0]}, {after[0]}; open files {before[1]}, {after[1]}")
    print(checked.stdout + checked.stderr, end="")
    left = any(b > a for a, b in zip(before, after))
    sys.exit(1 if failed or grown > FLAT or left or server.returncode != 0 or checked.returncode != 0 else 0)


if __name__ == "__main__":
    if sys.argv[1:2] == ["client"]:
        client(sys.argv[2], int(sys.argv[3]))
    else:
        main()
