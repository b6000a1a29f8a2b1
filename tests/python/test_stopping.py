"""Long calls: stopped by Ctrl-C, by `cancel` and by a faulty hook within 0.2 s, and telling how far they are."""

import os
import signal
import threading
import time

import numpy as np
import pressing_shapes as shapes
import pytest
import thenar

# Fine enough that preparing and pressing take many times the promise.
LONG = shapes.sheet(240, 0.25, 0.2)
SHORT = shapes.sheet(15)
BALL = shapes.ball(25.0, (0, 0, 22.0), 64)
PROMISE = 0.2
# A machine that is busy with other work schedules late; added to the promise, it is still far less than the work.
NOISE = 0.8


def work(**hooks):
    """Seconds of work: many presses would be stopped between each other, so it is one."""
    return thenar.Skin(*LONG, **hooks).press(*BALL, **hooks)


def later(action, delay=0.25):
    """Runs `action` after `delay`; the returned list then holds the time."""
    times = []

    def run():
        times.append(time.perf_counter())
        action()

    timer = threading.Timer(delay, run)
    timer.daemon = True
    timer.start()
    return times


def assert_stopped_soon(times):
    assert times, "the work ended before it was stopped; make it longer"
    assert time.perf_counter() - times[0] < PROMISE + NOISE


@pytest.fixture
def heeded():
    """Python's own answer to Ctrl-C: shells start what they run in the background with the signal ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("heeded")
def test_ctrl_c_stops():
    times = later(lambda: os.kill(os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        work()
    assert_stopped_soon(times)


def test_an_event_set_by_another_thread_stops():
    event = threading.Event()
    times = later(event.set)
    with pytest.raises(thenar.Cancelled, match="^cancelled before it was done"):
        work(cancel=event)
    assert_stopped_soon(times)


def test_a_callable_that_answers_stops():
    stop = []
    times = later(lambda: stop.append(1))
    with pytest.raises(thenar.Cancelled):
        work(cancel=lambda: bool(stop))
    assert_stopped_soon(times)


def test_a_request_made_before_the_call_stops_at_once():
    skin = thenar.Skin(*SHORT)
    with pytest.raises(thenar.Cancelled):
        skin.press(*BALL, cancel=lambda: True)


def test_a_stopped_skin_still_works():
    skin = thenar.Skin(*SHORT)
    expected = skin.press(*BALL).force_n
    answers = iter([False])
    with pytest.raises(thenar.Cancelled):
        thenar.Skin(*LONG, cancel=lambda: next(answers, True))
    with pytest.raises(thenar.Cancelled):
        skin.press(*BALL, cancel=lambda: True)
    assert np.allclose(skin.press(*BALL).force_n, expected, rtol=1e-6, atol=1e-12)


class Fault(Exception):
    """Raised by hooks of the tests."""


@pytest.mark.parametrize("hook", ["progress", "cancel"])
def test_an_exception_in_a_hook_is_raised_again(hook):
    calls = []

    def fault(*_):
        calls.append(1)
        raise Fault("from a hook")

    hooks = {hook: fault}
    with pytest.raises(Fault, match="from a hook"):
        work(**hooks)
    assert len(calls) == 1, "the work went on after its hook had failed"
    with pytest.raises(Fault, match="from a hook"):
        thenar.Skin(*SHORT).press(*BALL, **hooks)


def test_progress_never_falls_and_ends_at_one():
    for call in [lambda **hooks: thenar.Skin(*SHORT, **hooks), thenar.Skin(*SHORT).press]:
        told = []
        arguments = BALL if call.__name__ == "press" else ()
        call(*arguments, progress=lambda stage, fraction, told=told: told.append((stage, fraction)))
        fractions = [fraction for _, fraction in told]
        assert all(isinstance(stage, str) and stage for stage, _ in told)
        assert fractions == sorted(fractions) and fractions[0] >= 0 and fractions[-1] == 1


def test_python_runs_on_while_the_work_is_done():
    """With the lock held a counter in another thread would stand still."""
    count, stop = [0], threading.Event()

    def tick():
        while not stop.is_set():
            count[0] += 1
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    threading.Timer(0.5, stop.set).start()
    with pytest.raises(thenar.Cancelled):
        work(cancel=stop)
    thread.join()
    assert count[0] > 20


def test_an_error_inside_is_an_exception_and_not_a_traceback(capfd):
    for _ in range(2):
        with pytest.raises(
            thenar.SolveError, match=r"error inside thenar .*\(on purpose at .*running\.rs:\d+\); please report"
        ):
            thenar._panic()
    assert capfd.readouterr() == ("", "")
    assert thenar.Skin(*SHORT).press(*BALL).in_contact.any()
