"""Whether a fan of chains is a hand, which chain is its thumb, and in which order the fingers stand.

All by hierarchy and geometry: no names, no axes, no unit of length. Knows nothing of Blender.
"""

from dataclasses import dataclass

import numpy as np

LEAST_THUMB = 0.6
"""Score of a digit that stands apart: its angle to the others over 45 degrees plus what it starts nearer to the wrist.
Thumbs of MPFB's and Rigify's rigs score 1.19 to 1.71, toes at most 0.44."""
LEAST_REACH = 0.45
"""Length of a finger over the distance from the wrist to its knuckle: MPFB's and Rigify's hands 0.75
and 0.92, feet from the ankle 0.30."""
MOST_TURN_DEG = 60.0
"""Fingers at rest differ less from their mean direction; strands of hair and a skirt's chains go all around."""
LEAST_MARGIN = 0.15
"""By which the thumb's score must lead; below that the names decide."""


@dataclass(frozen=True)
class Digits:
    """A fan that is a hand: phalanges of each digit in chain order, and what was measured.

    `chains`: bones per digit, leaf bones taken off. `thumb`: its number, or None. `row`: numbers of the other digits
    from the thumb's side on. `bend`: above 0 on a right hand, below 0 on a left one, near 0 if the rest pose is flat.
    `is_unclear`: no digit is set apart like a thumb, so that only a name can say which it is. `trouble`: why it is no
    hand, or empty.
    """

    chains: tuple
    thumb: int | None
    row: tuple
    bend: float
    is_unclear: bool
    trouble: str


def measure(skeleton, root, chains, thumb=None):
    """`Digits` of the fan `chains` on `root`; `thumb` says which digit is the thumb, else the geometry does."""
    bones = without_leaves(skeleton, root, chains)
    bases = np.array([skeleton.heads[chain[-3:][0]] for chain in bones])
    tips = np.array([_tip(skeleton, chain) for chain in bones])
    lengths = np.linalg.norm(tips - bases, axis=1)
    if min(lengths) <= 0.0:
        return Digits(bones, None, (), 0.0, True, "bones lie at one point")
    along = (tips - bases) / lengths[:, None]
    wrist = skeleton.heads[root]
    reach = np.linalg.norm(bases - wrist, axis=1)
    scores = _thumb_scores(along, reach)
    order = np.argsort(scores)
    lead = float(scores[order[-1]] - scores[order[-2]])
    found = int(order[-1]) if thumb is None else thumb
    others = [digit for digit in range(len(bones)) if digit != found]
    trouble = _trouble(along[others], lengths, others, reach[others])
    is_unclear = lead < LEAST_MARGIN or scores[found] < LEAST_THUMB
    if not trouble and thumb is None and is_unclear:
        trouble = "no digit is set apart like a thumb"
    row = _row(bases, others, 0.5 * (bases[found] + tips[found]))
    mean = along[others].mean(axis=0)
    bend = _bend(skeleton, bones, (found, row), mean)
    return Digits(bones, found, tuple(row), bend, is_unclear, trouble)


def without_leaves(skeleton, root, chains):
    """Bones per digit without the leaf bone that some exporters add behind the fingertip.

    Of four bones the first is a metacarpal if it is longer than its way from the wrist; else the last is a leaf.
    """
    most = max(len(chain.bones) for chain in chains)
    has_leaves = most >= 5
    if most == 4:
        ratios = []
        for chain in (chain.bones for chain in chains if len(chain.bones) == 4):
            step = np.linalg.norm(skeleton.heads[chain[1]] - skeleton.heads[chain[0]])
            ratios.append(np.linalg.norm(skeleton.heads[chain[0]] - skeleton.heads[root]) / max(step, 1e-12))
        has_leaves = np.median(ratios) > 1.0
    if not has_leaves:
        return tuple(chain.bones for chain in chains)
    return tuple(chain.bones[:4][:-1] if len(chain.bones) == 4 else chain.bones[:4] for chain in chains)


def _tip(skeleton, chain):
    """End of the last bone, 0.8 times the length of the bone before it behind its head."""
    last, before = skeleton.heads[chain[-1]], skeleton.heads[chain[-2]]
    return last + 0.8 * (last - before)


def _thumb_scores(along, reach):
    """Per digit: its angle to the mean of the others over 45 degrees, plus how much nearer to the wrist it starts."""
    out = np.empty(len(along))
    for digit in range(len(along)):
        others = np.delete(np.arange(len(along)), digit)
        mean = along[others].mean(axis=0)
        cosine = along[digit] @ mean / max(np.linalg.norm(mean), 1e-12)
        nearer = 1.0 - reach[digit] / max(np.median(reach[others]), 1e-12)
        out[digit] = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))) / 45.0 + 1.2 * nearer
    return out


def _trouble(along, lengths, others, reach):
    mean = along.mean(axis=0)
    mean = mean / max(np.linalg.norm(mean), 1e-12)
    turn = np.degrees(np.arccos(np.clip(along @ mean, -1.0, 1.0))).max()
    if lengths.max() > 3.5 * lengths.min():
        return f"its longest chain is {lengths.max() / lengths.min():.1f} times its shortest"
    if np.median(lengths[others] / np.maximum(reach, 1e-12)) < LEAST_REACH:
        return "its digits are short against the palm, as toes are"
    if turn > MOST_TURN_DEG:
        return "its chains go in different directions, as hair or cloth does"
    if np.median(reach) > 4.0 * np.median(lengths[others]):
        return "its chains start far from the bone that carries them"
    return ""


def _row(bases, others, thumb):
    """The digits `others` in the order of their knuckles, from the one at the thumb's side on."""
    centered = bases[others] - bases[others].mean(axis=0)
    line = np.linalg.svd(centered)[2][0]
    places = centered @ line
    if (thumb - bases[others].mean(axis=0)) @ line < 0.0:
        places = -places
    return [others[k] for k in np.argsort(-places)]


def _bend(skeleton, chains, digits, along):
    """How far fingers and thumb lean to the palm of a right hand, radians; below 0 for a left hand."""
    thumb, row = digits
    knuckles = np.array([skeleton.heads[chains[digit][-3:][0]] for digit in row])
    across = knuckles[0] - knuckles[-1]
    normal = np.cross(across, along)
    size = np.linalg.norm(normal)
    if size <= 0.0:
        return 0.0
    normal /= size
    bends = []
    for digit in row:
        steps = np.diff(skeleton.heads[list(chains[digit][-3:])], axis=0)
        if len(steps) == 2:
            first, last = (step / max(np.linalg.norm(step), 1e-12) for step in steps)
            bends.append((last - first) @ normal)
    start, end = skeleton.heads[chains[thumb][0]], _tip(skeleton, chains[thumb])
    lean = (end - start) @ normal / max(np.linalg.norm(end - start), 1e-12)
    return float(np.mean(bends or [0.0]) + 0.5 * lean)
