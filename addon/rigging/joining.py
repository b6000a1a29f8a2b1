"""Loose bones of the assigned digits parented to each other, as a pose needs them."""

import bpy

from .. import languages
from ..hand.operators import can_pose
from ..hand_bones import bonemap, constrained, reading, roles
from ..operators import running
from ..rigs.digits import segments_of
from ..scene.checks import Refusal
from .assigning import DIGITS


def join(context, hand):
    """Parent the next bone of every assigned digit to the one before it, where it hangs on nothing of the hand's.

    Bones stay where they are. Returns how many were joined. Raises `Refusal` if the armature is linked from another
    file, or no digit is assigned.
    """
    armature = reading.armature_of(hand)
    known = bonemap.get_map(armature)
    if armature.library is not None or armature.data.library is not None:
        raise Refusal(f"the armature '{armature.name}' is linked from another file; make it local first")
    if constrained.is_constrained(armature, known):
        raise Refusal(
            f"constraints of a control rig hold the fingers of '{armature.name}', which need no joining; grasp or pose "
            "the hand as it is"
        )
    links = _links(known)
    if not links:
        raise Refusal("no digit is assigned, so there is nothing to join; press Detect Bones or Pick Digits first")
    active, selected = context.view_layer.objects.active, list(context.selected_objects)
    joined = 0
    with context.temp_override(active_object=armature, object=armature, selected_objects=[armature]):
        context.view_layer.objects.active = armature
        bpy.ops.object.mode_set(mode="EDIT")
        bones = armature.data.edit_bones
        for name, before in links:
            if name in bones and before in bones and not _hangs(bones[name], bones[before]):
                bones[name].use_connect = False
                bones[name].parent = bones[before]
                joined += 1
        bpy.ops.object.mode_set(mode="OBJECT")
    context.view_layer.objects.active = active
    for obj in selected:
        obj.select_set(True)
    context.view_layer.update()
    return joined


def loose(armature, known):
    """Which bones (names) of the assigned digits hang on nothing of their digit's; none where constraints hold them."""
    if constrained.is_constrained(armature, known):
        return []
    bones = armature.data.bones
    links = [(bones.get(name), bones.get(before)) for name, before in _links(known)]
    return [bone.name for bone, before in links if bone is not None and before is not None and not _hangs(bone, before)]


def _links(known):
    """`(bone, bone before)` names of every assigned digit; the first hangs on the wrist."""
    out = []
    for digit in DIGITS:
        chain = [known[role] for role in (f"{digit}_{name}" for name in segments_of(digit)) if role in known]
        before = known.get(roles.WRIST)
        for name in chain:
            if before is not None:
                out.append((name, before))
            before = name
    return out


def _hangs(bone, above):
    """Whether `bone` is below `above`, or `above` below it, which joining would close to a ring."""
    return above in bone.parent_recursive or bone in above.parent_recursive


class THENAR_OT_join_bones(bpy.types.Operator):
    """Parent loose bones of the assigned digits to each other, so that they can be posed; they stay where they are"""

    bl_idname = "thenar.join_bones"
    bl_label = "Join Loose Bones"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return can_pose(cls, context)

    def execute(self, context):
        joined = running.attempt(self, join, context, context.scene.thenar.hand)
        if joined is None:
            return {"CANCELLED"}
        self.report({"INFO"}, languages.report("{count} bones joined", count=joined))
        return {"FINISHED"}


CLASSES = (THENAR_OT_join_bones,)
