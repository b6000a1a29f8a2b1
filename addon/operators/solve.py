"""The operator that presses the hand against the product."""

import bpy

from .. import status, workflow
from . import display, running


def poll(cls, context):
    """Whether a solve can start; the reason is the disabled button's tooltip."""
    problem = status.native_problem
    settings = getattr(context.scene, "thenar", None)
    if problem:
        cls.poll_message_set(running.sentence(problem))
    elif settings is None or settings.hand is None:
        cls.poll_message_set("Choose the hand's mesh under Hand first")
    elif settings.product is None and settings.product_collection is None:
        cls.poll_message_set("Choose the product, or a collection of its parts, first")
    elif status.run.stage:
        cls.poll_message_set("A solve is under way; press Esc to cancel it")
    else:
        return True
    return False


class THENAR_OT_solve(bpy.types.Operator):
    """Press the hand against the product: shape, pressure and forces of the skin"""

    bl_idname = "thenar.solve"
    bl_label = "Solve Contact"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return poll(cls, context)

    def execute(self, context):
        result = running.attempt(self, workflow.solve, context)
        return self._report(context, result)

    def invoke(self, context, event):
        if bpy.app.background or context.window is None:
            return self.execute(context)
        self._job = running.attempt(self, workflow.prepare, context)
        if self._job is None:
            return {"CANCELLED"}
        self._worker = running.Worker(self._job)
        self._timer = running.begin(context, self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            self.cancel(context)
            self.report({"WARNING"}, "Solve cancelled; the scene is as before")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"} if running.is_navigation(event) else {"RUNNING_MODAL"}
        if not self._worker.is_done():
            running.show(context)
            return {"RUNNING_MODAL"}
        running.end(context, self._timer)
        return self._report(context, running.attempt(self, self._outcome, context))

    def cancel(self, context):
        self._worker.stop()
        running.end(context, self._timer)

    def _outcome(self, context):
        if self._worker.error is not None:
            raise self._worker.error
        return workflow.finish(context, self._job, self._worker.contact)

    def _report(self, context, result):
        if result is None:
            return {"CANCELLED"}
        display.refresh(context)
        for text in result.warnings:
            self.report({"WARNING"}, running.sentence(text.name))
        if result.area_mm2 == 0.0:
            self.report({"WARNING"}, f"'{result.hand_name}' does not touch '{result.product_name}'; nothing is pressed")
        self.report(
            {"INFO"},
            f"{result.force_n:.1f} N on {result.area_mm2 / 100:.1f} cm², peak {result.peak_kpa:.0f} kPa, "
            f"mean {result.mean_kpa:.0f} kPa",
        )
        return {"FINISHED"}


CLASSES = (THENAR_OT_solve,)
