"""Rigs without hierarchy, as exports of tracked hands are: chains put together by name and distance from the wrist.

Knows nothing of Blender.
"""

from dataclasses import replace

import numpy as np

from . import words

_WRIST = {"wrist", "hand", "carpus"}


def linked(skeleton):
    """The skeleton with a hierarchy where its skin bones have none and their names speak of digits; else itself.

    Each side's bones of a digit follow each other by distance from that side's wrist bone.
    """
    skin = np.flatnonzero(skeleton.skin > 0.0)
    if len(skin) < 7 or not _is_flat(skeleton, skin):
        return skeleton
    parents = np.array(skeleton.parents)
    sides = {bone: words.side_of([skeleton.names[bone]]) for bone in skin}
    for side in set(sides.values()):
        own = [int(bone) for bone in skin if sides[bone] == side]
        spoken = {bone: words.digits_of([[skeleton.names[bone]]])[0] for bone in own}
        wrists = [bone for bone in own if spoken[bone] is None and set(words.tokens(skeleton.names[bone])) & _WRIST]
        if len(wrists) != 1:
            continue
        for digit in words.DIGITS:
            last = wrists[0]
            chain = [bone for bone in own if spoken[bone] == digit]
            away = np.linalg.norm(skeleton.heads - skeleton.heads[wrists[0]], axis=1)
            for bone in sorted(chain, key=lambda bone, away=away: (away[bone], bone)):
                parents[bone], last = last, bone
    return replace(skeleton, parents=parents)


def _is_flat(skeleton, skin):
    """Whether no skin bone hangs on another."""
    carries = set(skin.tolist())
    return not any(int(skeleton.parents[bone]) in carries for bone in skin)
