"""Runs a computation beside Blender's window: worker thread, progress, Esc. The scene is touched by the caller only."""

import threading
import time
import weakref

from .. import languages, native, status
from ..languages import sentences
from ..scene.checks import Refusal
from ..steps import PAUSE

TICK_S = 0.05
STOP_S = 0.2
"""Longest wait of the window for a cancelled computation."""
END_S = 2.0
"""Longest wait at the end of the process, when nobody waits for the window any more."""
_NAVIGATION = {
    "MIDDLEMOUSE",
    "WHEELUPMOUSE",
    "WHEELDOWNMOUSE",
    "MOUSEMOVE",
    "TRACKPADPAN",
    "TRACKPADZOOM",
    "NDOF_MOTION",
}


_workers = weakref.WeakSet()


class Turn:
    """Nothing to compute: the steps go on after the window had its turn."""

    is_pause = True

    def is_done(self):
        """Always."""
        return True

    def hand_back(self, steps):
        """Let `steps` go on. Returns their next work; raises what they raise."""
        return steps.send(None)

    def stop(self):
        """Nothing runs."""


def start(work):
    """What carries `work` out: a `Worker`, or a `Turn` for `PAUSE`."""
    return Turn() if work is PAUSE else Worker(work)


class Worker:
    """One piece of work in a daemon thread: `work(cancel, progress)`; `stop_workers` knows it."""

    is_pause = False

    def __init__(self, work):
        self._cancel = threading.Event()
        self._value, self._error = None, None
        self._work = work
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        _workers.add(self)

    def is_done(self):
        """Whether the work has ended, well or not."""
        return not self._thread.is_alive()

    def hand_back(self, steps):
        """Give the value, or the error, to `steps`. Returns their next work; raises what they raise."""
        return steps.send(self._value) if self._error is None else steps.throw(self._error)

    def stop(self):
        """Ask the work to end and wait for it, `STOP_S` at most; an outcome that comes later is dropped."""
        self.ask_to_end()
        self.join(STOP_S)

    def ask_to_end(self):
        """Ask the work to end and do not wait."""
        self._cancel.set()

    def join(self, seconds):
        """Wait for its end, at most `seconds`."""
        self._thread.join(max(seconds, 0.0))

    def _run(self):
        try:
            self._value = self._work(self._cancel, self._progress)
        except BaseException as error:  # handed to the window's thread, which reports it
            self._error = error

    def _progress(self, stage, fraction):
        if not self._cancel.is_set():  # a late word would show as a run that never ends
            status.run.stage, status.run.fraction = stage, fraction


def stop_workers():
    """End every thread, before Python ends: one that it loses on the way may crash the process."""
    living = list(_workers)
    for worker in living:
        worker.ask_to_end()
    until = time.monotonic() + END_S
    for worker in living:
        worker.join(until - time.monotonic())


def is_navigation(event):
    """Whether the event only moves the view, and may pass while a job runs."""
    return event.type in _NAVIGATION


def begin(context, operator):
    """Start ticking: timer, status bar, cursor. Returns the timer."""
    manager = context.window_manager
    status.run.stage, status.run.fraction = "read", 0.0
    timer = manager.event_timer_add(TICK_S, window=context.window)
    manager.modal_handler_add(operator)
    show(context)
    return timer


def show(context):
    """Progress to status bar and panels, where it changed; the views themselves stay, drawing them holds Esc up."""
    run = status.run
    stage = languages.stage(run.stage)
    text = languages.iface("Thenar: {stage} {fraction:.0%}   Esc: cancel", stage=stage, fraction=run.fraction)
    if text == run.shown:
        return
    run.shown = text
    context.workspace.status_text_set(text)
    for area in _areas(context):
        for region in area.regions:
            if region.type == "UI" or area.type == "PROPERTIES":
                region.tag_redraw()


def end(context, timer):
    """Leave no trace of the run in the window."""
    status.run.stage, status.run.fraction, status.run.shown = "", 0.0, ""
    context.window_manager.event_timer_remove(timer)
    context.workspace.status_text_set(None)
    redraw(context)


def redraw(context):
    """Redraw every 3D view and properties editor."""
    for area in _areas(context):
        area.tag_redraw()


def _areas(context):
    manager = context.window_manager
    windows = manager.windows if manager is not None else ()
    return [area for window in windows for area in window.screen.areas if area.type in {"VIEW_3D", "PROPERTIES"}]


def attempt(operator, action, *arguments):
    """Run `action`; what the user can mend is reported as one sentence. Returns its value, or None after a report.

    It is in the user's language; `status.last_error` keeps the English. The operator's `refused(error)`, if it has
    one, is called.
    """
    try:
        return action(*arguments)
    except (Refusal, *native.error_types()) as error:
        status.set_last_error(f"{operator.bl_idname}: {sentence(error)}")
        operator.report({"ERROR"}, in_words(error))
        refused = getattr(operator, "refused", None)
        if refused is not None:
            refused(error)
        return None


def in_words(error):
    """The error as a sentence in the user's language; *Copy Debug Info* has the English, which the manual lists."""
    return sentence(sentences.shown(sentence(error)))


def sentence(error):
    """The error's text as a sentence with a capital."""
    text = " ".join(str(error).split())
    return text[:1].upper() + text[1:]
