"""The operator that presses the hand against the product."""

import bpy

from .. import workflow
from . import computing, display, polling, running


class THENAR_OT_solve(computing.Computing, bpy.types.Operator):
    """Press the hand against the product: shape, pressure and forces of the skin"""

    bl_idname = "thenar.solve"
    bl_label = "Solve Contact"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Solve"

    @classmethod
    def poll(cls, context):
        return polling.can_compute(cls, context)

    def steps(self, context):
        return workflow.steps(context)

    def _report(self, context, result):
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
