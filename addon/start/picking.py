"""The operator that takes a hand which is in the scene already."""

import bpy

from ..hand_shape import framing
from ..operators import polling, running


class THENAR_OT_pick_hand(bpy.types.Operator):
    """Use the active mesh as the hand, or the mesh that the active armature bends, and frame it"""

    bl_idname = "thenar.pick_hand"
    bl_label = "Use Active Object as Hand"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        found = hand_of(context, context.object)
        problem = "" if found is not None else "click the hand's mesh or its armature in the 3D view first"
        return polling.allows(cls, problem, polling.busy())

    def execute(self, context):
        settings, hand = context.scene.thenar, hand_of(context, context.object)
        settings.hand = hand
        if settings.product == hand:
            settings.product = None
        framing.frame(context, hand)
        running.redraw(context)
        self.report({"INFO"}, f"'{hand.name}' is the hand, {len(hand.data.vertices):,} vertices")
        return {"FINISHED"}


def hand_of(context, obj):
    """The mesh that `obj` is or, as an armature, bends (the one with most vertices); None if there is none."""
    if obj is None or obj.thenar.copy_of:
        return None
    if obj.type == "MESH":
        return obj
    bent = [mesh for mesh in context.scene.objects if mesh.type == "MESH" and _is_bent_by(mesh, obj)]
    return max(bent, key=lambda mesh: len(mesh.data.vertices), default=None)


def _is_bent_by(mesh, armature):
    return any(modifier.type == "ARMATURE" and modifier.object == armature for modifier in mesh.modifiers)


CLASSES = (THENAR_OT_pick_hand,)
"""Classes to register."""
