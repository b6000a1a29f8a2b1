"""The operator that takes a hand which is in the scene already, and what every way to a hand ends with."""

import bpy

from .. import languages, tabs
from ..hand_bones import bonemap, reading
from ..hand_bones.rig_axes import RigError
from ..hand_shape import framing
from ..operators import polling, running


class THENAR_OT_pick_hand(bpy.types.Operator):
    """Use the active mesh as the hand, or the mesh that the active armature bends; find its bones, and frame it"""

    bl_idname = "thenar.pick_hand"
    bl_label = "Use Active Object as Hand"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        found = hand_of(context, context.object)
        problem = "" if found is not None else "click the hand's mesh or its armature in the 3D view first"
        return polling.allows(cls, problem, polling.busy())

    def execute(self, context):
        active = context.object
        hand = active if active.type == "MESH" else best_of(context, bent_by(context.scene.objects, active))
        take(self, context, hand)
        return {"FINISHED"}


def take(operator, context, hand):
    """Make `hand` the scene's hand, find its bones and regions where it has none yet, frame it, and report."""
    settings = context.scene.thenar
    settings.hand = hand
    if settings.product == hand:
        settings.product = None
    level, found = _detect(hand)
    framing.frame(context, hand)
    tabs.open_after_hand(context)
    running.redraw(context)
    words = "'{name}' is the hand, {vertices:,} vertices"
    operator.report({level}, languages.report(words, name=hand.name, vertices=len(hand.data.vertices)) + found)


def hand_of(context, obj):
    """The mesh that `obj` is or, as an armature, bends (the one with most vertices); None if there is none."""
    if obj is None or obj.thenar.copy_of:
        return None
    if obj.type == "MESH":
        return obj
    return max(bent_by(context.scene.objects, obj), key=_size, default=None)


def bent_by(objects, armature):
    """The meshes among `objects` that the armature bends."""
    return [mesh for mesh in objects if mesh.type == "MESH" and _is_bent_by(mesh, armature)]


def best_of(context, meshes):
    """Of `meshes` the largest whose bones are a hand's, else the largest: hair has more vertices than a body."""
    in_order = sorted(meshes, key=_size, reverse=True)
    return next((mesh for mesh in in_order if _is_hand(context, mesh)), in_order[0])


def _detect(hand):
    """Find bones and regions of a rigged hand without any. Returns the report's level, and what it says of them."""
    armature = next((m.object for m in hand.modifiers if m.type == "ARMATURE" and m.object is not None), None)
    if armature is None or bonemap.get_map(armature) or not bpy.ops.thenar.guess_bones.poll():
        return "INFO", ""
    try:
        bpy.ops.thenar.guess_bones()
    except RuntimeError as error:
        return "WARNING", f"; {languages.reported(error)}"
    bones, regions = len(bonemap.get_map(armature)), len(hand.thenar.materials)
    return "INFO", languages.report(", with {bones} bones and {regions} regions", bones=bones, regions=regions)


def _is_hand(context, mesh):
    try:
        return reading.find_bones(context, mesh).chosen is not None
    except RigError:
        return False


def _is_bent_by(mesh, armature):
    return any(modifier.type == "ARMATURE" and modifier.object == armature for modifier in mesh.modifiers)


def _size(mesh):
    return len(mesh.data.vertices)


CLASSES = (THENAR_OT_pick_hand,)
"""Classes to register."""
