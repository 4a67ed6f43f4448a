"""CPU time of the same steps with and without what watches them: two instances side by side in one process.

The two make each step one after the other, so that whatever else the machine does falls on both. Which of them was made
first decides where its memory lies, and where memory lies is worth a per cent or two: a pair is therefore measured with
either of them first, and both halves count. The solver of each runs on the calling thread; all other threads are those of
log and network.
"""

import contextlib
import ctypes
import os
import subprocess
import sys
import time
from pathlib import Path

from importer import Library

GATE = "gate.main.opening"
LOGGER = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_char_p)


@contextlib.contextmanager
def watcher(endpoint, naps=0.0):
    """A subscriber to everything in a process of its own."""
    program = Path(__file__).parent / "watcher.py"
    command = [sys.executable, str(program), endpoint, "silo", "level.depth", str(naps)]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "subscribed\n"
        yield process
    finally:
        process.kill()
        process.wait()


class Side:
    """An instance with its gate open, its log and its session as asked for."""

    def __init__(self, library, scene, log=None, config=None):
        self.library, told = Library(library, str(scene)), []
        lib, handle = self.library.lib, self.library.handle
        self.logger = LOGGER(lambda _, category, message: told.append(message.decode()))
        self.library.check(lib.sandgate_set_logger(handle, self.logger, None))
        for name, text in (("log.path", log), ("zenoh.config", config)):
            if text:
                reference = ctypes.c_uint32(self.library.references[name])
                self.library.check(lib.sandgate_set_text(handle, reference, text.encode()))
        self.library.initialize()
        self.library.set(GATE, 1.0)
        self.endpoint = next((text.split()[-1] for text in told if "listening on" in text), None)
        self.spent = 0.0

    def step(self, k, h):
        """Adds the calling thread's time to `spent` [s]."""
        begin = time.thread_time()
        self.library.step(k * h, (k + 1) * h - k * h)
        self.spent += time.thread_time() - begin


def half(library, scene, steps, h, first, watched=False, **extra):
    """CPU time [s] without, with, and of all threads but the calling one; `first` says which of the two comes first."""
    sides = {on: Side(library, scene, **(extra if on else {})) for on in (first, not first)}
    with watcher(sides[True].endpoint) if watched else contextlib.nullcontext():
        if extra:
            time.sleep(0.3)
        process, thread = time.process_time(), time.thread_time()
        for k in range(steps):
            for on in (first, not first) if k % 2 == 0 else (not first, first):
                sides[on].step(k, h)
        if extra:
            time.sleep(0.2)  # What waits to be published or written belongs to the cost.
        others = (time.process_time() - process) - (time.thread_time() - thread)
    for side in sides.values():
        side.library.free()
    return sides[False].spent, sides[True].spent, others


def pair(library, scene, steps, h, folder, log=False, **extra):
    """By what share CPU time is more with than without, and the part of it that other threads have."""
    without, calling, others = 0.0, 0.0, 0.0
    for first in (False, True):
        path = {"log": os.path.join(folder, f"{first}.mcap")} if log else {}
        taken = half(library, scene, steps, h, first, **extra, **path)
        without, calling, others = (a + b for a, b in zip((without, calling, others), taken))
        for file in Path(folder).glob("*.mcap"):
            file.unlink()
    return (calling + others) / without - 1.0, others / without
