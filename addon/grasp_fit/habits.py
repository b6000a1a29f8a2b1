"""Angles that go together in a hand: DIP follows PIP, neighbouring fingers bend alike, the thumb pronates as it flexes.

Knows nothing of Blender.
"""

from ..hand.skinning import FLEXION, TWIST
from ..hand_bones.roles import FINGERS

DIP_PER_PIP = 0.6
"""The DIP joint bends this much of the PIP joint, an anatomical rule of thumb."""

WEIGHT_DIP = 0.05
WEIGHT_BESIDE = 0.08
"""mm of residual per degree. With BESIDE at 0.03 the index finger straightens past the others on 60 mm."""

PRONATION = 17.0 / 53.0
WEIGHT_PRONATION = 0.02
"""The thumb's first joint pronates in proportion to its flexion (Li & Tang 2007), by the share of its two ranges
(Cooney et al. 1981); mm of residual per degree, less than DIP's: a pad that shall face another turns further."""

WEIGHT_IP = 0.04
"""The thumb's IP joint bends about as its MP joint does (assumed). Without it MP stays straight and IP hooks by 79
degrees around a bar of 34 mm."""


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


def of_thumb(joints, dofs):
    """Pairs of the thumb's angles as in `couples`: its twist with its flexion, and IP with MP, where it has them."""
    where = {(role, column): k for k, (_, column, role) in enumerate(dofs)}
    out = []
    one, two = (where.get(("thumb_metacarpal", column)) for column in (TWIST, FLEXION))
    if one is not None and two is not None:
        out.append((one, two, -joints.side * PRONATION, 0.0, WEIGHT_PRONATION))
    one, two = (where.get((role, FLEXION)) for role in ("thumb_distal", "thumb_proximal"))
    if one is not None and two is not None:
        rest = joints.rest_flexion[dofs[one][0]] - joints.rest_flexion[dofs[two][0]]
        out.append((one, two, 1.0, rest, WEIGHT_IP))
    return out
