"""The operator that gives grasped fingers back to the controls of their rig."""

import bpy

from .. import languages
from ..hand.panel import armature_of
from ..hand_bones import constrained
from ..operators import polling


class THENAR_OT_back_to_controls(bpy.types.Operator):
    """Let the rig's controls hold the fingers again, as before the grasp: the constraints that were muted for it act, \
and the fingers follow them"""

    bl_idname = "thenar.back_to_controls"
    bl_label = "Back to the Controls"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        armature = armature_of(context)
        is_muted = armature is not None and constrained.is_muted(armature)
        problem = "" if is_muted else "no constraint of the hand's bones was muted for a grasp"
        return polling.allows(cls, problem, polling.wrong_mode(context), polling.busy())

    def execute(self, context):
        count = constrained.back(armature_of(context))
        context.view_layer.update()
        self.report({"INFO"}, languages.report("{count} constraints hold the fingers again", count=count))
        return {"FINISHED"}


CLASSES = (THENAR_OT_back_to_controls,)
