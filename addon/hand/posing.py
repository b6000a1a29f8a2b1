"""Library poses and bone names put onto the armature of a hand in a scene."""

from ..scene import checks
from . import bonemap, reading, roles
from .poses import POSES


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
    """Fill the bone map of `hand`'s armature from names and order; returns how many parts were found.

    Raises `Refusal` if no finger was found.
    """
    armature = reading.armature_of(hand)
    bonemap.set_map(armature, {}, armature.thenar_bones.axis)
    rig, found = reading.read_rig(context, hand)
    roles.resolve(rig, found)
    bonemap.set_map(armature, found, armature.thenar_bones.axis)
    return len(found)
