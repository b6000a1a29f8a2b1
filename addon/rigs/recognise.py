"""Which bones are a hand's, whoever named them: role -> bone, and what to tell the user about it.

Knows nothing of Blender.
"""

from dataclasses import dataclass

import numpy as np

from . import fan, flat, words
from .chains import fans

SEGMENTS = ("metacarpal", "proximal", "middle", "distal")
THUMB_SEGMENTS = ("metacarpal", "proximal", "distal")
SIDES = ("left", "right")
WRIST_APART = 0.2
"""A skin bone this near to the fan's root, in parts of the palm's length, is the wrist if the root carries no skin."""

LEAST_BEND = 0.04
"""Bend of fingers and thumb, radians, from which the rest pose shows on which side the palm is."""


@dataclass(frozen=True)
class Hand:
    """A hand among the bones: role -> bone name, its side or None, the skin it carries, and remarks in words."""

    roles: dict
    side: str | None
    skin: float
    root: str
    remarks: tuple


@dataclass(frozen=True)
class Found:
    """Every hand of a skeleton, the one that was chosen or None, and a sentence about the rest.

    `refused`: root bone -> why the fan on it is no hand.
    """

    hands: tuple
    chosen: Hand | None
    refused: dict

    def sentence(self):
        """What was found, for the status line; empty if there is nothing to say."""
        if self.chosen is None:
            return self.missing()
        parts = list(self.chosen.remarks)
        other = [hand for hand in self.hands if hand is not self.chosen]
        if other:
            parts.insert(0, f"{len(self.hands)} hands found, the {self.chosen.side or 'larger'} one is used; see Side")
        return "; ".join(parts)

    def missing(self):
        """Why no hand was found, with what is there instead."""
        if self.refused:
            root, why = next(iter(self.refused.items()))
            more = f" and {len(self.refused) - 1} more" if len(self.refused) > 1 else ""
            return f"the bones below '{root}'{more} are not taken for a hand: {why}"
        return "no bone that carries this mesh has three or more chains of bones below it"


def recognise(skeleton, side=None):
    """`Found` hands of a `chains.Skeleton`, the one of `side` ('left', 'right') chosen, else the one with most skin.

    A fan of chains is a hand by its shape. Names only settle what the shape leaves open: which digit is the thumb if
    none leads clearly, which side a flat hand is, which finger a three-fingered hand lacks.
    """
    skeleton = flat.linked(skeleton)
    hands, refused = {}, {}
    for root, chains in fans(skeleton).items():
        hand, why = _hand(skeleton, root, chains)
        if hand is None:
            refused[root] = why
        else:
            hands[root] = hand
    kept = [hand for root, hand in hands.items() if not _is_part(root, hands, skeleton.parents)]
    refused = {root: why for root, why in refused.items() if not _carries(skeleton, root, hands)}
    refused = {skeleton.names[root]: why for root, why in refused.items()}
    kept = tuple(sorted(_with_sides(kept), key=lambda hand: (-hand.skin, hand.side != "right", hand.root)))
    kept = _ties_right(kept)
    fitting = [hand for hand in kept if side is None or hand.side == side]
    return Found(kept, fitting[0] if fitting else None, refused)


def _hand(skeleton, root, chains):
    """`(Hand, "")`, or `(None, why)`."""
    if len(chains) > 5:
        return None, f"{len(chains)} chains, and a hand has at most five"
    names = [[skeleton.names[bone] for bone in chain.bones] for chain in chains]
    part = words.other_part([name for chain in names for name in chain])
    if part is not None:
        return None, f"their names say {part}"
    spoken = words.digits_of(names)
    digits = fan.measure(skeleton, root, chains)
    by_name = spoken.index("thumb") if spoken.count("thumb") == 1 else None
    if by_name is not None and digits.is_unclear:
        digits = fan.measure(skeleton, root, chains, by_name)
    if digits.trouble:
        return None, digits.trouble
    fingers = _fingers(digits, spoken)
    remarks = []
    labels = {digits.thumb: "thumb", **fingers}
    for number, label in sorted(labels.items()):
        if spoken[number] not in (None, label):
            bone = skeleton.names[digits.chains[number][0]]
            remarks.append(f"'{bone}' is named {spoken[number]}, but lies where the {label} is")
    if len(labels) < 5:
        remarks.append(f"{len(labels)} digits: {', '.join(labels.values())}")
    roles = _roles(skeleton, root, digits, labels, chains)
    members = {bone for chain in digits.chains for bone in chain}
    side = words.side_of([skeleton.names[bone] for bone in sorted(members)])
    by_shape = None if abs(digits.bend) < LEAST_BEND else ("right" if digits.bend > 0.0 else "left")
    if side and by_shape and side != by_shape:
        remarks.append(f"the names say {side} hand, the shape says {by_shape} hand")
    skin = float(skeleton.skin[sorted(members)].sum())
    return Hand(roles, side or by_shape, skin, skeleton.names[root], tuple(remarks)), ""


def _fingers(digits, spoken):
    """Number of a digit -> finger, from the thumb's side on; names say which one a hand of fewer fingers lacks."""
    row = digits.row
    order = words.DIGITS[1:]
    named = [spoken[digit] for digit in row]
    if len(row) < 4 and None not in named and named == [finger for finger in order if finger in named]:
        return dict(zip(row, named, strict=True))
    return dict(zip(row, order, strict=False))


def _roles(skeleton, root, digits, labels, chains):
    out = {}
    for number, label in labels.items():
        bones = list(digits.chains[number])
        segments = THUMB_SEGMENTS if label == "thumb" else SEGMENTS
        stem = chains[number].stem
        sharing = [labels[other] for other, chain in enumerate(chains) if set(chain.stem) & set(stem)]
        if label != "thumb" and len(bones) == 3 and stem and set(sharing) <= {label, "thumb"}:
            bones = [stem[-1], *bones]
        bones = bones[-len(segments) :]
        for segment, bone in zip(reversed(segments), reversed(bones), strict=False):
            out[f"{label}_{segment}"] = skeleton.names[bone]
    wrist = _wrist(skeleton, root, out)
    return out if wrist is None else {"wrist": wrist, **out}


def _wrist(skeleton, root, roles):
    """The bone that carries the palm: the fan's root, or the skin bone at its place; None if there is none."""
    if skeleton.skin[root] > 0.0:
        return skeleton.names[root]
    used = {skeleton.names.index(name) for name in roles.values()}
    knuckles = [skeleton.names.index(name) for role, name in roles.items() if role.endswith("_proximal")]
    reach = np.linalg.norm(skeleton.heads[knuckles] - skeleton.heads[root], axis=1).max()
    near = np.linalg.norm(skeleton.heads - skeleton.heads[root], axis=1)
    able = [bone for bone in np.flatnonzero((skeleton.skin > 0.0) & (near < WRIST_APART * reach)) if bone not in used]
    if able:
        return skeleton.names[min(able, key=lambda bone: (near[bone], bone))]
    parent = skeleton.parents[root]
    return skeleton.names[parent] if parent >= 0 and skeleton.skin[parent] > 0.0 else skeleton.names[root]


def _is_part(root, hands, parents):
    """Whether the fan on `root` is part of a larger hand above it, or the same hand seen from a bone above."""
    mine = set(hands[root].roles.values())
    for other, hand in hands.items():
        theirs = set(hand.roles.values()) - {hand.roles.get("wrist")}
        own = mine - {hands[root].roles.get("wrist")}
        if other == root or not own & theirs:
            continue
        if len(theirs) > len(own) or (len(theirs) == len(own) and _hangs(other, root, parents)):
            return True
    return False


def _carries(skeleton, root, hands):
    """Whether a hand was found at or below `root`: then what was said of `root` itself does not matter."""
    return any(_hangs(hand, root, skeleton.parents) for hand in hands)


def _hangs(bone, above, parents):
    while bone >= 0:
        if bone == above:
            return True
        bone = parents[bone]
    return False


def _with_sides(hands):
    """Two hands of which one has no side: it is the other's opposite."""
    if len(hands) != 2 or sum(hand.side is None for hand in hands) != 1:
        return hands
    known = next(hand.side for hand in hands if hand.side)
    other = SIDES[1 - SIDES.index(known)]
    return [hand if hand.side else Hand(hand.roles, other, hand.skin, hand.root, hand.remarks) for hand in hands]


def _ties_right(hands):
    """Hands by skin; of two that carry about the same (a whole body) the right one first."""
    if len(hands) > 1 and hands[1].side == "right" and hands[1].skin > 0.8 * hands[0].skin:
        return (hands[1], hands[0], *hands[2:])
    return hands
