"""The operators that bake a range of frames, and choose which of several bakes plays."""

import bpy

from .. import languages, workflow
from ..scene import baked
from ..timeline import baking
from . import computing, display, polling, running


class THENAR_OT_bake(computing.Computing, bpy.types.Operator):
    """Solve every frame of a range and save its shape and fields; friction and time-dependent effects carry over"""

    bl_idname = "thenar.bake"
    bl_label = "Bake Frames"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Bake"

    frame_start: bpy.props.IntProperty(name="Start", description="First frame of the bake", default=1)
    frame_end: bpy.props.IntProperty(name="End", description="Last frame of the bake", default=1)
    take: bpy.props.StringProperty(
        name="Take",
        description="Name of the bake; without one the next number. A take of the same name is replaced, others stay",
    )

    @classmethod
    def poll(cls, context):
        return polling.can_compute(cls, context)

    def steps(self, context):
        return baking.steps(context, self.frame_start, self.frame_end, self.take)

    def _report(self, context, bake):
        display.refresh(context)
        stored, count = context.scene.thenar.hand.thenar.bake, len(bake.done)
        words = "Baked {count} frames; max. pressure {kpa:.0f} kPa"
        if count == 1:
            words = "Baked 1 frame; max. pressure {kpa:.0f} kPa"
        text = languages.report(words, count=count, kpa=stored.peak_kpa)
        if bake.resumed:
            text += languages.report("; {count} were solved before a crash", count=bake.resumed)
        if stored.cycles:
            text += languages.report("; {loss_mj:.3g} mJ lost per cycle", loss_mj=stored.cycle_loss_mj)
        self.report({"INFO"}, text)
        return {"FINISHED"}


class THENAR_OT_play_take(bpy.types.Operator):
    """Play this bake of the hand: its shape, pressure and numbers; the other takes are kept"""

    bl_idname = "thenar.play_take"
    bl_label = "Play Take"
    bl_options = {"REGISTER", "UNDO"}

    take: bpy.props.StringProperty(name="Take", description="Name of the bake that is to play")

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_bake(context), polling.live(context))

    def execute(self, context):
        scene = context.scene
        if running.attempt(self, self._play, scene) is None:
            return {"CANCELLED"}
        display.refresh(context)
        running.redraw(context)
        return {"FINISHED"}

    def _play(self, scene):
        baked.choose(scene.thenar.hand, self.take)
        baked.play(scene, workflow.product_parts)
        return True


CLASSES = (THENAR_OT_bake, THENAR_OT_play_take)
