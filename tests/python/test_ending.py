"""A process that ends while other threads are inside the library ends as requested: no crash, no waiting."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

HERE = Path(__file__).parent
BEGIN = """
import sys, threading, time
sys.path.insert(0, sys.argv[1])
import numpy as np
import pressing_shapes as shapes
inside = threading.Event()
def tell(*_):
    inside.set()
def daemon(work):
    threading.Thread(target=work, daemon=True).start()
"""
# One piece of work of seconds, in a daemon thread.
LONG = """
import thenar
BALL = shapes.ball(25.0, (0, 0, 22.0), 64)
daemon(lambda: thenar.Skin(*shapes.sheet(240, 0.25, 0.2), progress=tell).press(*BALL, progress=tell))
inside.wait()
"""
# Presses without end, so that the end finds the threads anywhere: in conversions of arrays, in hooks, in results.
MANY = """
import thenar
BALL = shapes.ball(25.0, (0, 0, 22.0), 64)
vertices, triangles = shapes.sheet(15)
vertices = np.asfortranarray(vertices, np.float32)
def press():
    skin = thenar.Skin(vertices, triangles)
    while True:
        try:
            contact = skin.press(*BALL, cancel=lambda: False, progress=tell)
            contact.regions, contact.warnings, contact.pressure_mpa
            thenar.solve_complementarity(np.eye(300), -np.ones(300))
        except SystemExit:
            pass  # and on: one that does not listen
for _ in range(3):
    daemon(press)
inside.wait()
time.sleep({delay})
"""
SOONEST, LATEST, ENDINGS = 0.0, 0.06, 6


def run(script):
    started = time.monotonic()
    done = subprocess.run([sys.executable, "-c", BEGIN + script, str(HERE)], capture_output=True, text=True, timeout=60)
    return done, time.monotonic() - started


@pytest.mark.parametrize(
    ("ending", "code", "said"),
    [("", 0, ""), ("sys.exit(3)", 3, ""), ("raise RuntimeError('on purpose')", 1, "on purpose")],
)
def test_a_process_ends_while_a_thread_presses(ending, code, said):
    for _ in range(10 if not ending else 4):
        done, seconds = run(LONG + ending)
        assert (done.returncode, done.stdout) == (code, ""), done.stderr
        assert said in done.stderr and "Cancelled" not in done.stderr and (said or not done.stderr)
        assert seconds < 5.0


def test_a_process_ends_wherever_its_threads_are():
    for number in range(ENDINGS):
        done, _ = run(MANY.format(delay=SOONEST + (LATEST - SOONEST) * number / (ENDINGS - 1)))
        assert done.returncode == 0, done.stderr


def test_work_that_cannot_be_cancelled_is_waited_for():
    script = """
import thenar
sites = np.random.default_rng(0).random((3000, 3))
apart = np.linalg.norm(sites[:, None] - sites[None], axis=2)
compliance = np.exp(-((apart / 10.0) ** 2)) + 1e-9 * np.eye(3000)
def solve():
    inside.set()
    thenar.solve_complementarity(compliance, 0.2 - sites[:, 0])
daemon(solve)
inside.wait()
time.sleep(0.2)
"""
    done, _ = run(script)
    assert done.returncode == 0 and not done.stderr, done.stderr


def test_a_hook_that_blocks_holds_the_end_up_for_some_seconds_only():
    script = """
import thenar
def sleep():
    inside.set()
    time.sleep(20)
daemon(lambda: thenar.Skin(*shapes.sheet(240, 0.25, 0.2), cancel=sleep))
inside.wait()
"""
    _, seconds = run(script)
    assert seconds < 15.0


def test_the_thread_that_ends_python_may_still_press():
    script = """
import atexit
def last():
    contact = thenar.Skin(*shapes.sheet(15)).press(*shapes.ball(25.0, (0, 0, 22.0), 64))
    print("pressed" if contact.in_contact.any() else "missed")
atexit.register(last)  # before the library's own, so it runs after it
import thenar
"""
    done, _ = run(script)
    assert (done.returncode, done.stdout) == (0, "pressed\n"), done.stderr


def test_a_forked_child_does_not_wait_for_threads_that_it_does_not_have():
    script = (
        LONG
        + """
import os
child = os.fork()
if child == 0:
    started = time.monotonic()
    import atexit
    sys.exit(0)
began = time.monotonic()
_, status = os.waitpid(child, 0)
print(os.waitstatus_to_exitcode(status), time.monotonic() - began < 3.0)
"""
    )
    done, _ = run(script)
    assert (done.returncode, done.stdout) == (0, "0 True\n"), done.stderr


def test_cycles_of_solve_cancel_and_quit_end_well():
    """The bench, cut short."""
    bench = HERE.parent / "bench" / "window" / "quit_cycles.py"
    done = subprocess.run([sys.executable, bench, "24"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
