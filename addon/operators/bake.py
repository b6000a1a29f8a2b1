"""The operator that bakes a range of frames."""

import bpy

from .. import baking, languages
from . import computing, display, polling


class THENAR_OT_bake(computing.Computing, bpy.types.Operator):
    """Solve every frame of a range and save its shape and fields; friction and time-dependent effects carry over"""

    bl_idname = "thenar.bake"
    bl_label = "Bake Frames"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Bake"

    frame_start: bpy.props.IntProperty(name="Start", description="First frame of the bake", default=1)
    frame_end: bpy.props.IntProperty(name="End", description="Last frame of the bake", default=1)

    @classmethod
    def poll(cls, context):
        return polling.can_compute(cls, context)

    def steps(self, context):
        return baking.steps(context, self.frame_start, self.frame_end)

    def _report(self, context, bake):
        display.refresh(context)
        told, count = context.scene.thenar.hand.thenar.bake, len(bake.done)
        words = "Baked {count} frames; max. pressure {kpa:.0f} kPa"
        if count == 1:
            words = "Baked 1 frame; max. pressure {kpa:.0f} kPa"
        text = languages.report(words, count=count, kpa=told.peak_kpa)
        if told.cycles:
            text += languages.report("; {loss_mj:.3g} mJ lost per cycle", loss_mj=told.cycle_loss_mj)
        self.report({"INFO"}, text)
        return {"FINISHED"}


CLASSES = (THENAR_OT_bake,)
