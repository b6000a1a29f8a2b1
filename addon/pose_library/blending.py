"""A hand's pose between the current one and one of the library, joint angle by joint angle."""

from ..hand.poses import POSES
from ..hand_bones import reading, roles
from ..scene import checks


def blend(context, hand, goal):
    """Turn the bones of `hand`'s armature toward a pose; `goal`: its name, and the share from 0 to 1. Returns True.

    Each angle goes in proportion, so that joints stay within their limits all the way. Raises `Refusal` if the hand
    has no readable rig.
    """
    name, share = goal
    checks.check_hand(context, hand)
    rig, role_names = reading.read_free_rig(context, hand)
    armature = reading.armature_of(hand)
    joints = roles.resolve(rig, role_names, reading.own_limits(armature, rig))
    start = reading.read_angles(armature, rig, joints)
    end = roles.pose_angles(rig, joints, POSES[name])
    if share > 0.0:
        reading.write_angles(armature, rig, joints, (1.0 - share) * start + share * end)
        context.view_layer.update()
    return True
