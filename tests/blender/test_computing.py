"""Computations beside the window: Esc ends them and puts the scene back, and a late worker has no say."""

import threading
import time
from types import SimpleNamespace

import pytest
from thenar_blender import status, steps
from thenar_blender.operators import computing, running


class Operator(computing.Computing):
    """An operator without Blender: counts its work, and how often its scene was put back."""

    noun = "Count"

    def __init__(self, works):
        self.works, self.reports, self.undone = works, [], 0

    def steps(self, context):
        values = []
        try:
            for work in self.works:
                values.append((yield work))
        finally:
            self.undone += 1
        return values

    def report(self, kinds, text):
        self.reports.append((*kinds, text))

    def _report(self, context, outcome):
        self.outcome = outcome
        return {"FINISHED"}


@pytest.fixture
def context():
    """A window that is there and draws nothing."""
    manager = SimpleNamespace(
        windows=[],
        event_timer_add=lambda seconds, window: "timer",
        event_timer_remove=lambda timer: None,
        modal_handler_add=lambda operator: None,
    )
    return SimpleNamespace(
        window=None, window_manager=manager, workspace=SimpleNamespace(status_text_set=lambda text: None)
    )


def started(operator, context):
    """The operator as a button starts it; in background, `invoke` would run it at once."""
    operator._steps = operator.steps(context)
    work = next(operator._steps)
    operator._start(context, work)
    return operator


def turn(operator, context, kind="TIMER"):
    return operator.modal(context, SimpleNamespace(type=kind, value="PRESS"))


def finish(operator, context):
    for _ in range(500):
        answer = turn(operator, context)
        if answer != {"RUNNING_MODAL"}:
            return answer
        time.sleep(0.01)
    raise AssertionError("the operator does not end")


def test_steps_in_turns_with_the_window_are_those_at_once(context):
    works = [lambda cancel, progress, k=k: k * k for k in range(4)]
    operator = started(Operator(works), context)
    assert finish(operator, context) == {"FINISHED"}
    assert operator.outcome == steps.at_once(Operator(works).steps(context)) == [0, 1, 4, 9]
    assert operator.undone == 1 and not status.run.stage


def test_escape_ends_the_work_and_puts_the_scene_back(context):
    stopped = threading.Event()

    def endless(cancel, progress):
        progress("counting", 0.5)
        while not cancel.is_set():
            time.sleep(0.005)
        stopped.set()

    operator = started(Operator([endless]), context)
    time.sleep(0.05)
    assert turn(operator, context, "MOUSEMOVE") == {"PASS_THROUGH"}
    assert turn(operator, context) == {"RUNNING_MODAL"} and status.run.stage == "counting"
    assert turn(operator, context, "ESC") == {"CANCELLED"}
    assert stopped.is_set() and operator.undone == 1 and not status.run.stage
    assert operator.reports == [("WARNING", "Count cancelled; the scene is as before")]


def test_work_that_does_not_listen_is_left_alone_and_says_no_more(context):
    late, ended = threading.Event(), threading.Event()

    def deaf(cancel, progress):
        late.wait(60.0)
        progress("still here", 0.9)
        ended.set()

    operator = started(Operator([deaf]), context)
    assert turn(operator, context, "ESC") == {"CANCELLED"}
    assert not ended.is_set(), "the window waited for work that does not listen"
    assert running.STOP_S <= 0.5, "as long as the window may stand still"
    late.set()
    assert ended.wait(60.0) and not status.run.stage, "a stage here would disable every button for good"


def test_a_bug_leaves_the_window_usable(context):
    def broken(cancel, progress):
        raise ZeroDivisionError("a bug")

    operator = started(Operator([broken]), context)
    with pytest.raises(ZeroDivisionError):
        finish(operator, context)
    assert operator.undone == 1 and not status.run.stage


def test_steps_that_fail_at_their_end_leave_the_window_usable(context):
    """Each on its own, too, where all are ended at once."""

    class Broken(Operator):
        def steps(self, context):
            try:
                yield lambda cancel, progress: None
            finally:
                self.undone += 1
                raise ZeroDivisionError("a bug")

    operator = started(Broken([]), context)
    status.run.stage = "counting"
    with pytest.raises(ZeroDivisionError):
        turn(operator, context, "ESC")
    assert operator.undone == 1 and not status.run.stage
    both = [started(Broken([]), context), started(Operator([lambda cancel, progress: None]), context)]
    with pytest.raises(ZeroDivisionError):
        computing.stop_all(context)
    assert [each.undone for each in both] == [1, 1]
