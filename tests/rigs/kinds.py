"""Rigs of many makers: their bones' names, hierarchy, twist, leaf and face bones, as their public files state them.

Names and hierarchy are facts read from the sources named at each kind; places are `bodies`'.
"""

from dataclasses import dataclass, field

import bodies
import numpy as np
from bodies import DIGITS, Builder

SEGMENTS = ("metacarpal", "proximal", "middle", "distal")


@dataclass
class Made:
    """A made rig: the builder's rows, and for each side role -> bone name as the maker means it."""

    builder: Builder = field(default_factory=Builder)
    truth: dict = field(default_factory=lambda: {"right": {}, "left": {}})

    def arrays(self):
        """Names, parents (b), heads (b, 3) and skin (b)."""
        names = tuple(row[0] for row in self.builder.rows)
        parents = np.array([-1 if row[1] is None else names.index(row[1]) for row in self.builder.rows])
        heads = np.array([row[2] for row in self.builder.rows])
        skin = np.array([100.0 * row[3] for row in self.builder.rows])
        return names, parents, heads, skin


def fingers(made, side, hand, name, **options):
    """Add the digits of one hand below bone `hand`; `name(digit, k)` gives a bone's name or None.

    Options: `metacarpals` (bones 0), `tips` (leaf bones without skin), `tip_skin`, `digits`, `on` (digit -> parent),
    `points`, `helper(digit, k)` (name of a bone without skin between bone k and the one before it, or None).
    """
    sign = dict(bodies.sides())[side]
    points = options.get("points") or bodies.hand_points()
    for digit in options.get("digits", DIGITS):
        parent = options.get("on", {}).get(digit, hand)
        first = 0 if options.get("metacarpals") and digit != "thumb" else 1
        for k in range(first, 4):
            bone, place = name(digit, k), bodies.place_hand(sign, points[digit, k])
            between = options["helper"](digit, k) if options.get("helper") else None
            if between is not None:
                parent = made.builder.add(between, parent, place, False)
            made.builder.add(bone, parent, place)
            segment = SEGMENTS[k] if digit != "thumb" else ("metacarpal", "proximal", "distal")[k - 1]
            made.truth[side][f"{digit}_{segment}"] = parent = bone
        if options.get("tips"):
            has_skin = options.get("tip_skin", False)
            made.builder.add(name(digit, 4), parent, bodies.place_hand(sign, points[digit, 4]), has_skin)
    made.truth[side]["wrist"] = hand


def trunk(made, names, arms, legs):
    """Spine `names` from hips to head; per side `arms(side)` (4 or 5 names) and `legs(side)` (3 or 4 names).

    Returns side -> name of the last arm bone (the hand) and side -> name of the last leg bone.
    """
    add = made.builder.add
    heights = np.linspace(980.0, 1560.0, len(names))
    last = None
    for name, height in zip(names, heights, strict=True):
        last = add(name, last, (0.0, 0.0, height))
    chest = names[-3]
    hands, feet = {}, {}
    for side, sign in bodies.sides():
        places = bodies.arm(sign)
        bones = arms(side)
        places = places if len(bones) == 5 else [*places[:3], places[4]]
        hands[side] = made.builder.chain(chest, *zip(bones, places, strict=True))
        bones = legs(side)
        feet[side] = made.builder.chain(names[0], *zip(bones, bodies.leg(sign)[: len(bones)], strict=True))
    return hands, feet


def toes(made, feet, name, counts=(2, 3, 3, 3, 3)):
    """Five toes on each foot; `name(side, number, k)`."""
    for side, sign in bodies.sides():
        for number, count in enumerate(counts):
            bones = [(name(side, number, k), bodies.toe(sign, number, k)) for k in range(1, count + 1)]
            made.builder.chain(feet[side], *bones)


def face(made, head, name, chains):
    """Chains of face bones below `head`: brows, lips, tongue; `name(chain, k)`."""
    for number in range(chains):
        angle = 2.0 * np.pi * number / chains
        place = np.array([60.0 * np.cos(angle), -90.0, 1600.0 + 50.0 * np.sin(angle)])
        bones = [(name(number, k), place + k * np.array([12.0 * np.sin(angle), 2.0, 5.0])) for k in range(3)]
        made.builder.chain(head, *bones)


def s(side, right, left):
    """The side's own letter or word."""
    return right if side == "right" else left
