"""The thumb's range in hands that an older version made: its first joint may turn inward as far as it does today."""

import numpy as np

from ..hand_bones import roles

BONE, LIMIT = "thumb_metacarpal", "Joint limits"
EARLIER_DEG = (-20.0, 30.0)
"""Twist of a right thumb's first joint that hands had before; a negative one is pronation."""
SAME_DEG = 0.01

_widened = set()
"""Names of the objects that were brought up to date since the file was opened."""


def bring_up_to_date(armature):
    """Give the thumb of `armature` today's twist where its limit is the earlier one; the pose stays as it is.

    Returns whether something changed. The end that is narrower today is kept where the thumb is animated or stands
    beyond it. Limits that the user set are left alone.
    """
    limit = _limit_of(armature)
    side = 0.0 if limit is None else _side_of(limit)
    if not side:
        return False
    low, high = np.radians(roles.LIMITS_DEG[BONE]["twist"])
    data = armature.animation_data
    is_animated = data is not None and (data.action is not None or len(data.nla_tracks) or len(data.drivers))
    twist = side * armature.pose.bones[BONE].matrix_basis.to_euler("ZYX").y
    if is_animated or twist > high:
        high = np.radians(EARLIER_DEG[1])
    ends = sorted((side * low, side * high))
    limit.min_y, limit.max_y = ends
    _widened.add(armature.name)
    return True


def is_widened(armature):
    """Whether the thumb of `armature` was given today's range since the file was opened."""
    return armature.name in _widened


def forget():
    """Another file is open."""
    _widened.clear()


def _limit_of(armature):
    """The limit that came with a made hand, or None; also where the file is linked and cannot be changed."""
    if armature.type != "ARMATURE" or armature.library is not None or armature.override_library is not None:
        return None
    bone = armature.pose.bones.get(BONE)
    limit = None if bone is None else bone.constraints.get(LIMIT)
    return limit if limit is not None and limit.type == "LIMIT_ROTATION" and limit.use_limit_y else None


def _side_of(limit):
    """1 or -1 where the limit is the earlier one of a right or of a left hand, else 0."""
    ends = np.degrees([limit.min_y, limit.max_y])
    for side in (1.0, -1.0):
        if np.abs(ends - sorted(side * np.array(EARLIER_DEG))).max() < SAME_DEG:
            return side
    return 0.0
