"""The operator that bakes a range of frames."""

import bpy

from .. import baking
from . import computing, display, polling


class THENAR_OT_bake(computing.Computing, bpy.types.Operator):
    """Press every frame of a range and keep shape and pressure beside the file, to be played and rendered"""

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
        peak = max(frame["peak_kpa"] for frame in bake.done)
        count = len(bake.done)
        self.report({"INFO"}, f"Baked {count} frame{'s' if count > 1 else ''}; highest peak {peak:.0f} kPa")
        return {"FINISHED"}


CLASSES = (THENAR_OT_bake,)
