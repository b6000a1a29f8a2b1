"""A digit that the user points at: the chain through a bone, and the parts its bones play. Knows nothing of Blender."""

import numpy as np

from . import fan
from .chains import LEAST_CHAIN, Chain

SEGMENTS = ("metacarpal", "proximal", "middle", "distal")
THUMB_SEGMENTS = ("metacarpal", "proximal", "distal")
MOST_BONES = 5
"""Bones of a chain at most: metacarpal, three phalanges and a leaf."""


def segments_of(digit):
    """Names of the segments of `digit`, from the palm on."""
    return THUMB_SEGMENTS if digit == "thumb" else SEGMENTS


def chain_through(skeleton, bone):
    """Skin-carrying bones, from the palm on, of the unbranched chain that `bone` lies on; () if it lies on none."""
    depth = _depths(skeleton)
    first = bone
    while skeleton.parents[first] >= 0:
        above = skeleton.parents[first]
        others = [depth[child] for child in skeleton.children[above] if child != first]
        if max(others, default=0) >= LEAST_CHAIN:
            break
        first = int(above)
    out = []
    while first is not None:
        if skeleton.skin[first] > 0.0:
            out.append(int(first))
        below = [child for child in skeleton.children[first] if depth[child] > 0]
        first = max(below, key=lambda child: (depth[child], -child)) if below else None
    return tuple(out[-MOST_BONES:]) if len(out) >= LEAST_CHAIN else ()


def in_order(skeleton, bones):
    """Bones of one digit from the palm on: by hierarchy, or loose ones along their line, longest segment first."""
    above = {bone: sum(_hangs(skeleton, bone, other) for other in bones) for bone in bones}
    if sorted(above.values()) == list(range(1, len(bones) + 1)) or len(bones) < 3:
        return tuple(sorted(bones, key=above.get))
    heads = skeleton.heads[list(bones)]
    line = np.linalg.svd(heads - heads.mean(axis=0))[2][0]
    order = np.argsort(heads @ line)
    steps = np.linalg.norm(np.diff(heads[order], axis=0), axis=1)
    order = order if steps[0] >= steps[-1] else order[::-1]
    return tuple(bones[k] for k in order)


def roles_of(skeleton, digit, bones):
    """Role -> bone name of `digit` whose `bones` are given from the palm on; a leaf bone at the tip is left out."""
    if len(bones) > 3:
        root = max(int(skeleton.parents[bones[0]]), -1)
        start = bones[0] if root < 0 else root
        bones = fan.without_leaves(skeleton, start, [Chain(tuple(bones))])[0]
    names = segments_of(digit)
    pairs = zip(reversed(names), reversed(bones[-len(names) :]), strict=False)
    return {f"{digit}_{segment}": skeleton.names[bone] for segment, bone in pairs}


def wrist_of(skeleton, bones):
    """Name of the bone that carries the digit `bones`, or None."""
    above = int(skeleton.parents[bones[0]])
    while above >= 0 and skeleton.skin[above] <= 0.0:
        above = int(skeleton.parents[above])
    return skeleton.names[above] if above >= 0 else None


def _depths(skeleton):
    """Per bone the most skin-carrying bones on a way down from it, itself included."""
    out = {}
    for bone in reversed(skeleton.order):
        below = max((out[child] for child in skeleton.children[bone]), default=0)
        out[bone] = below + int(skeleton.skin[bone] > 0.0)
    return out


def _hangs(skeleton, bone, above):
    while bone >= 0:
        if bone == above:
            return True
        bone = skeleton.parents[bone]
    return False
