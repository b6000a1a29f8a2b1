"""Operators of the pose library: enter it in the preferences, and blend the hand toward a pose."""

import bpy
from bpy.props import EnumProperty, FloatProperty

from .. import languages, status
from ..hand.operators import can_pose
from ..hand.poses import LABELS
from ..operators import polling, running
from . import blending, library


class THENAR_OT_add_pose_library(bpy.types.Operator):
    """Add the poses of Thenar's hand to the Asset Browser and the asset shelf of Pose Mode, with pictures"""

    bl_idname = "thenar.add_pose_library"
    bl_label = "Add Pose Library"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, status.native_problem, polling.busy())

    def execute(self, context):
        done = running.attempt(self, library.add, context)
        if done is None:
            return {"CANCELLED"}
        count, bare = done
        if bpy.ops.asset.library_refresh.poll():
            bpy.ops.asset.library_refresh()
        text = languages.report("{count} poses are in the asset library '{name}'", count=count, name=library.NAME)
        self.report(
            {"WARNING" if bare else "INFO"},
            text + (languages.report("; without a picture: {poses}", poses=", ".join(bare)) if bare else ""),
        )
        return {"FINISHED"}


class THENAR_OT_blend_pose(bpy.types.Operator):
    """Blend the hand from its current pose toward a pose of the library, by a slider"""

    bl_idname = "thenar.blend_pose"
    bl_label = "Blend Pose"
    bl_options = {"REGISTER", "UNDO"}

    name: EnumProperty(
        name="Pose",
        description="Pose to blend toward",
        items=[(name, label, "") for name, label in LABELS.items()],
        default="relaxed",
    )
    factor: FloatProperty(
        name="Blend",
        description="0: the current pose, 1: the chosen one; joint angles in between",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=0.5,
    )

    @classmethod
    def poll(cls, context):
        return can_pose(cls, context)

    def invoke(self, context, event):
        self.factor = 0.0  # the popup computes nothing before the slider moves
        return context.window_manager.invoke_props_popup(self, event)

    def execute(self, context):
        done = running.attempt(self, blending.blend, context, context.scene.thenar.hand, (self.name, self.factor))
        return {"FINISHED"} if done else {"CANCELLED"}


CLASSES = (THENAR_OT_add_pose_library, THENAR_OT_blend_pose)
