"""The base of operators that compute beside the window: one modal loop, with progress and Esc, for all of them."""

import atexit
import time
from contextlib import ExitStack
from dataclasses import dataclass

import bpy
from bpy.app.handlers import persistent
from bpy_extras.io_utils import ImportHelper

from .. import languages, steps
from . import running

TURN_S = 0.1
"""How long steps that only pause go on before the window has its turn."""
_under_way = {}
"""Steps -> `_Run` of every computation that a button started."""
_GOES_ON = object()


@dataclass
class _Run:
    """A computation that a button started."""

    timer: object
    worker: running.Worker | running.Turn


class OpensFiles(ImportHelper):
    """A file operator that reads next to the window where a user chose the file; a script goes on when all is read."""

    def invoke(self, context, event):
        """Open the file browser, which keeps this operator until the user has chosen."""
        self._is_asked = True
        return ImportHelper.invoke(self, context, event)

    def reads_beside(self, context):
        """Whether `hand_over` is to read: a user waits in a window."""
        return getattr(self, "_is_asked", False) and context.window is not None and not bpy.app.background

    def hand_over(self, begin, **asked):
        """Begin an operator that reads next to the window; what it refuses is reported here."""
        try:
            begin("INVOKE_DEFAULT", **asked)
        except RuntimeError as error:
            self.report({"ERROR"}, languages.reported(error))
        return {"CANCELLED"}  # what reads leaves the undo step


class Computing:
    """An operator whose `steps(context)` are a computation as in `addon/steps.py`; `noun` names it to the user.

    `_report(context, outcome)` tells how it ended. In scripts and in background the steps run at once; from a button
    they run in turns with the window, and Esc ends them, so that their `finally` puts the scene back.
    """

    noun = ""

    def execute(self, context):
        """The whole computation in this thread."""
        return self._end(context, running.attempt(self, steps.at_once, self.steps(context)))

    def invoke(self, context, event):
        """Start the computation beside the window."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        self._steps = self.steps(context)
        begun = running.attempt(self, self._begin)
        if begun is None:
            return {"CANCELLED"}
        self._start(context, *begun)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """A turn of the window: Esc, progress, or the next step."""
        if self._steps not in _under_way:
            return {"CANCELLED"}
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            self.cancel(context)
            noun = languages.report(self.noun)
            self.report({"WARNING"}, languages.report("{noun} cancelled; the scene is as before", noun=noun))
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"} if running.is_navigation(event) else {"RUNNING_MODAL"}
        if not _under_way[self._steps].worker.is_done():
            running.show(context)
            return {"RUNNING_MODAL"}
        try:
            outcome = running.attempt(self, self._advance)
        except BaseException:  # a bug: the window must stay usable while Blender shows the traceback
            self.cancel(context)
            raise
        if outcome is _GOES_ON:
            return {"RUNNING_MODAL"}
        running.end(context, _under_way.pop(self._steps).timer)
        return self._end(context, outcome)

    def cancel(self, context):
        """Stop the computation; also called by Blender when the window goes."""
        _stop(context, self._steps)

    def _start(self, context, work):
        """Hand the first work to a thread, and tick."""
        _under_way[self._steps] = _Run(running.begin(context, self), running.start(work))

    def _begin(self):
        """The first work, which may be `PAUSE`, in a tuple."""
        return (next(self._steps),)

    def _advance(self):
        """Go on with the worker's value, and over pauses while the turn lasts. Returns `_GOES_ON`, or the outcome."""
        run, ends = _under_way[self._steps], time.perf_counter() + TURN_S
        try:
            while True:
                run.worker = running.start(run.worker.hand_back(self._steps))
                if not run.worker.is_pause or time.perf_counter() > ends:
                    return _GOES_ON
        except StopIteration as end:
            return end.value

    def _end(self, context, outcome):
        return {"CANCELLED"} if outcome is None else self._report(context, outcome)


def stop_all(context):
    """End every computation and put the scene back: before a file is loaded, and before the operators go."""
    with ExitStack() as stops:
        for under_way in _under_way:
            stops.callback(_stop, context, under_way)


def register():
    """See that no computation outlives its file, its operators or the process."""
    atexit.register(running.stop_workers)
    bpy.app.handlers.load_pre.append(_before_load)


def unregister():
    """End what is under way, and stop watching."""
    stop_all(bpy.context)
    running.stop_workers()
    bpy.app.handlers.load_pre.remove(_before_load)
    atexit.unregister(running.stop_workers)


@persistent
def _before_load(*_):
    stop_all(bpy.context)


def _stop(context, under_way):
    run = _under_way.pop(under_way, None)
    if run is None:
        return
    try:
        run.worker.stop()
        under_way.close()
    finally:  # else the window would say for good that a computation is under way
        running.end(context, run.timer)
