"""Runs a computation beside Blender's window: worker thread, progress, Esc. The scene is touched by the caller only."""

import threading

from .. import native, status, workflow
from ..scene.checks import Refusal

TICK_S = 0.05
_NAVIGATION = {
    "MIDDLEMOUSE",
    "WHEELUPMOUSE",
    "WHEELDOWNMOUSE",
    "MOUSEMOVE",
    "TRACKPADPAN",
    "TRACKPADZOOM",
    "NDOF_MOTION",
}


class Worker:
    """One job in a daemon thread; `contact` or `error` is set once `is_done()`."""

    def __init__(self, job):
        self.cancel = threading.Event()
        self.contact = None
        self.error = None
        self._job = job
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def is_done(self):
        """Whether the job has ended, well or not."""
        return not self._thread.is_alive()

    def stop(self):
        """Ask the job to end; it does within 0.2 s, and if not, its outcome is dropped."""
        self.cancel.set()
        self._thread.join(0.2)

    def _work(self):
        try:
            self.contact = workflow.compute(self._job, self.cancel, _progress)
        except BaseException as error:  # handed to the window's thread, which reports it
            self.error = error


def _progress(stage, fraction):
    status.run.stage, status.run.fraction = stage, fraction


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
    """Progress to status bar and panels."""
    run = status.run
    context.workspace.status_text_set(f"Thenar: {run.stage} {run.fraction:.0%}   Esc: cancel")
    redraw(context)


def end(context, timer):
    """Leave no trace of the run in the window."""
    status.run.stage, status.run.fraction = "", 0.0
    context.window_manager.event_timer_remove(timer)
    context.workspace.status_text_set(None)
    redraw(context)


def redraw(context):
    """Redraw every 3D view and properties editor."""
    manager = context.window_manager
    for window in manager.windows if manager is not None else ():
        for area in window.screen.areas:
            if area.type in {"VIEW_3D", "PROPERTIES"}:
                area.tag_redraw()


def attempt(operator, action, *arguments):
    """Run `action`; what the user can mend is reported as one sentence. Returns its value, or None after a report."""
    try:
        return action(*arguments)
    except (Refusal, *native.error_types()) as error:
        operator.report({"ERROR"}, sentence(error))
        return None


def sentence(error):
    """The error's text as a sentence with a capital."""
    text = " ".join(str(error).split())
    return text[:1].upper() + text[1:]
