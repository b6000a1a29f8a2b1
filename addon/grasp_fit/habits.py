"""Angles that go together in a hand: DIP follows PIP, and neighbouring fingers bend alike. Knows nothing of Blender."""

from ..hand.roles import FINGERS
from ..hand.skinning import FLEXION

DIP_PER_PIP = 0.6
"""The DIP joint bends this much of the PIP joint, an anatomical rule of thumb."""

WEIGHT_DIP = 0.05
WEIGHT_BESIDE = 0.08
"""mm of residual per degree. With BESIDE at 0.03 the index finger straightens past the others on 60 mm."""


def couples(joints, dofs):
    """Pairs of angles that go together, as (one, other, share, rest, weight): one + rest is about share times other.

    DIP follows PIP in every finger, and MCP and PIP of neighbouring fingers follow each other; anatomical angles.
    """
    where = {(role, column): k for k, (_, column, role) in enumerate(dofs)}

    def pair(role, other, share, weight):
        one, two = where.get((role, FLEXION)), where.get((other, FLEXION))
        if one is None or two is None:
            return []
        rest = joints.rest_flexion[joints.bones[role]] - share * joints.rest_flexion[joints.bones[other]]
        return [(one, two, share, rest, weight)]

    out = []
    for finger in FINGERS:
        out += pair(f"{finger}_distal", f"{finger}_middle", DIP_PER_PIP, WEIGHT_DIP)
    for finger, beside in zip(FINGERS[:-1], FINGERS[1:], strict=True):
        for segment in ("proximal", "middle"):
            out += pair(f"{finger}_{segment}", f"{beside}_{segment}", 1.0, WEIGHT_BESIDE)
    return out
