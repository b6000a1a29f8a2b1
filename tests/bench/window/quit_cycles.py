"""Solve, cancel and quit, over and over: counts processes that crash or hang, and memory that grows.

    python tests/bench/window/quit_cycles.py 10000

Every cycle is a process of its own, forked from one that has only imported the library: it presses to the end, cancels
a press, and ends in one of four ways while a third one runs in a daemon thread. Besides, one process presses and
cancels as often, and its memory is looked at.
"""

import argparse
import contextlib
import os
import random
import resource
import signal
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))
import pressing_shapes as shapes
import results
import thenar

SHEET, BALL = shapes.sheet(60), shapes.ball(25.0, (0, 0, 22.0), 32)
LONGEST_S = 60.0
"""A process that takes longer hangs."""
SETTLED = 0.3
"""Share of the presses after which memory must not grow any more."""
GROWTH_MB = 8.0
"""Noise of the allocator; 10,000 presses that each lost their pressure (3,600 doubles) would take 290 MB."""


def main(arguments=None):
    """Run the cycles, print what was found. Returns 0 if all ended well."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("cycles", type=int)
    cycles = parser.parse_args(arguments).cycles
    random.seed(1)
    began = time.monotonic()
    faults = {}
    for number in range(cycles):
        fault = _quit_once(number)
        if fault:
            faults[fault] = faults.get(fault, 0) + 1
    grown = _in_child(lambda: _grown_mb(cycles))
    print(f"{cycles} processes in {time.monotonic() - began:.0f} s; ended badly: {faults or 'none'}")
    print(f"{cycles} presses, of which every second was cancelled: memory grew by {grown:.1f} MB")
    is_met = not faults and grown < GROWTH_MB
    measured = f"{cycles - sum(faults.values())} of {cycles}, {grown:.1f} MB growth"
    figure = results.Figure("processes that end while a press runs", "no crash, no growth", measured, is_met)
    results.record("bench", f"target/venv/bin/python tests/bench/window/quit_cycles.py {cycles}", [figure])
    return int(not is_met)


def _quit_once(number):
    """How the process of a cycle ended, if not as it should."""
    child = os.fork()
    if child == 0:
        signal.alarm(int(LONGEST_S))
        os.close(2)
        _live_and_end(number)
    _, status = os.waitpid(child, 0)
    code = os.waitstatus_to_exitcode(status)
    return "" if code == (0, 3, 1, 0)[number % 4] else f"exit code {code}"


def _live_and_end(number):
    skin = thenar.Skin(*SHEET)
    if number % 2:
        skin.press(*BALL)
    _cancelled(skin)
    threading.Thread(target=lambda: [skin.press(*BALL) for _ in range(10_000)], daemon=True).start()
    time.sleep(random.random() * 0.05)
    if number % 4 == 1:
        sys.exit(3)
    if number % 4 == 2:
        raise RuntimeError("on purpose")
    sys.exit()


def _cancelled(skin):
    stop = threading.Event()
    threading.Timer(random.random() * 0.02, stop.set).start()
    with contextlib.suppress(thenar.Cancelled):
        skin.press(*BALL, cancel=stop)


def _grown_mb(presses):
    """Megabytes by which the peak of memory grew after the first presses."""
    skin, settled = thenar.Skin(*SHEET), 0.0
    for number in range(presses):
        if number == int(SETTLED * presses):
            settled = _peak_mb()
        if number % 2:
            skin.press(*BALL)
        else:
            _cancelled(skin)
    return _peak_mb() - settled


def _peak_mb():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def _in_child(measure):
    """The number that `measure` finds in a process of its own; not a number if that dies."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.write(writing, str(measure()).encode())
        os._exit(0)
    os.close(writing)
    os.waitpid(child, 0)
    return float(os.read(reading, 64) or "nan")


if __name__ == "__main__":
    sys.exit(main())
