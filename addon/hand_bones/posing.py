"""Library poses and bone names put onto the armature of a hand in a scene."""

from ..hand.poses import POSES
from ..scene import checks
from ..scene.checks import Refusal
from . import bonemap, reading, roles


def apply_pose(context, hand, name):
    """Turn the bones of `hand`'s armature into the pose `name`; bones without a role keep theirs. Returns True.

    Raises `Refusal` if the hand has no readable rig.
    """
    checks.check_hand(context, hand)
    rig, role_names = reading.read_free_rig(context, hand)
    armature = reading.armature_of(hand)
    joints = roles.resolve(rig, role_names, reading.own_limits(armature, rig))
    reading.write_angles(armature, rig, joints, roles.pose_angles(rig, joints, POSES[name]))
    context.view_layer.update()
    return True


def guess_bones(context, hand):
    """Fill the bone map of `hand`'s armature; returns how many parts were found, and remarks in words or "".

    What was assigned before stays if nothing is found. Raises `Refusal` with what was found and what is missing.
    """
    armature = reading.armature_of(hand)
    axis, old = armature.thenar_bones.axis, bonemap.get_map(armature)
    bonemap.set_map(armature, {}, axis)
    try:
        rig, found = reading.read_rig(context, hand)
        roles.resolve(rig, found)
    except Refusal:
        bonemap.set_map(armature, old, axis)
        raise
    bonemap.set_map(armature, found, axis)
    return len(found), _remarks(context, hand)


def _remarks(context, hand):
    try:
        return reading.find_bones(context, hand).sentence()
    except Refusal:
        return "named by the words in their names only; check them"
