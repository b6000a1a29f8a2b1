"""The base of operators that compute beside the window: one modal loop, with progress and Esc, for all of them."""

import time

import bpy

from .. import steps
from . import running

TURN_S = 0.1
"""How long steps that only pause go on before the window has its turn."""


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
        self._worker = running.attempt(self, self._begin)
        if self._worker is None:
            return {"CANCELLED"}
        self._timer = running.begin(context, self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """A turn of the window: Esc, progress, or the next step."""
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            self.cancel(context)
            self.report({"WARNING"}, f"{self.noun} cancelled; the scene is as before")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"} if running.is_navigation(event) else {"RUNNING_MODAL"}
        if not self._worker.is_done():
            running.show(context)
            return {"RUNNING_MODAL"}
        try:
            outcome = running.attempt(self, self._advance)
        except BaseException:  # a bug: the window must stay usable while Blender shows the traceback
            self.cancel(context)
            raise
        if outcome is self._worker:
            return {"RUNNING_MODAL"}
        running.end(context, self._timer)
        return self._end(context, outcome)

    def cancel(self, context):
        """Stop the computation; also called by Blender when the window goes."""
        self._worker.stop()
        self._steps.close()
        running.end(context, self._timer)

    def _begin(self):
        return running.start(next(self._steps))

    def _advance(self):
        """Go on, and over pauses while the turn lasts. Returns the next worker, or the outcome."""
        ends = time.perf_counter() + TURN_S
        try:
            while True:
                self._worker = running.start(self._worker.hand_back(self._steps))
                if not self._worker.is_pause or time.perf_counter() > ends:
                    return self._worker
        except StopIteration as end:
            return end.value

    def _end(self, context, outcome):
        return {"CANCELLED"} if outcome is None else self._report(context, outcome)
