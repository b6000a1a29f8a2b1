"""Ways to begin a grasp: power grips and hooks around a bar, pinches and lateral grips. Knows nothing of Blender."""

from dataclasses import dataclass, replace

import numpy as np

from ..grasp_fit import closing, fitter, laterals, pinches, pinching, places
from ..hand.poses import OPEN
from ..hand.skinning import TWIST
from ..hand_bones.roles import angle_bounds, pose_angles
from . import hooks

ROLLS = 4
"""Directions around a bar from which the palm is tried."""

STOPS_DEG = {"thumb_proximal": 30.0, "thumb_distal": 25.0}
"""The thumb closes this far before a fit: further, its tip hooks into the palm and stays there."""

OPPOSED_DEG = -25.0
"""Twist of the thumb's first joint from which a power grip begins: pronated, its pad toward the fingers."""

OBLIQUE_DEG, STEEP_DEG = 12.0, 22.0
ALONG = -0.25
"""The bar's axis against the line of the knuckles, first and where no grip settles so, and its place along the fingers
in parts of the hand's breadth."""

THIN = 0.35
"""A pad begins no deeper in a pinch than this share of what is pinched is thick: around a rod of 8 mm two pads that
begin 4 mm deep would pass each other, and each would press its side. At 0.2 trays and a toothbrush were held worse."""

POWER, PINCH, LATERAL, HOOK = "POWER", "PINCH", "LATERAL", "HOOK"
AROUND = (POWER, HOOK)
"""Kinds that close around a bar: with the whole hand, or with the four fingers alone, in which it hangs."""


@dataclass(frozen=True)
class Way:
    """One way to begin: its `kind`; the `stage.Stage` with the wish of that kind; where: a `places.Spot` or a
    `pinches.Pinch`. Around a bar, which `end` of the bar's axis is at the thumb (1 or -1), and the palm's side,
    `roll` of `ROLLS`; `oblique_deg` as `OBLIQUE_DEG`."""

    kind: str
    stage: object
    spot: object
    end: int = 1
    roll: int = 0
    oblique_deg: float = OBLIQUE_DEG

    @property
    def bar(self):
        """What the thumb closes around: center (3) and axis (3) of the bar, toward the thumb's side; or None."""
        return (self.spot.center, self.end * self.spot.axis) if self.kind == POWER else None

    @property
    def toward(self):
        """The way (3) in which the palm faces around a bar."""
        turn = 2.0 * np.pi * self.roll / ROLLS
        return np.cos(turn) * self.spot.side + np.sin(turn) * np.cross(self.spot.axis, self.spot.side)

    @property
    def down(self):
        """The way (3) in which a product hangs in a hook."""
        return hooks.down(self.stage.hand, self.toward, self.end * self.spot.axis)

    def aim(self, aim):
        """An `Aim` of the search as this way has it: with the bar, or with the weight that hangs in a hook."""
        if self.kind != HOOK:
            return replace(aim, bar=self.bar)
        return replace(aim, weight_n=aim.total_n * self.down, about_mm=hooks.loaded_at(self.spot), total_n=None)

    def start(self, hand, wanted):
        """Place (4, 4) and angles (b, 3) of the hand from which a fit begins; `wanted` (p,) depths of its pads."""
        if self.kind not in AROUND:
            return pinching.start_of(hand, self.stage.gauge, self.spot)
        center, axis, breadth = self.spot.center, self.end * self.spot.axis, fitter.breadth_of(hand)
        if self.kind == HOOK:
            placing = closing.Placing(center, axis, 0.0, hooks.ALONG * breadth, self.toward)
            opened = pose_angles(hand.rig, hand.joints, OPEN)
            return fitter.start_of(hand, self.stage.gauge, wanted, (placing, opened, hooks.STOPS_DEG))
        placing = closing.Placing(center, axis, np.radians(self.oblique_deg), ALONG * breadth, self.toward)
        return fitter.start_of(hand, self.stage.gauge, wanted, (placing, _opposed(hand), STOPS_DEG))


def steep(way):
    """The way with the bar more obliquely across the hand, as people hold a tool that points forward."""
    return replace(way, oblique_deg=STEEP_DEG)


def slid(way):
    """The way with a hand that may slide along the bar as far as it likes."""
    fit = way.stage.fit
    return replace(way, stage=replace(way.stage, fit=replace(fit, wish=replace(fit.wish, along_mm=np.inf))))


def _opposed(hand):
    """Angles (b, 3) of the open hand with its thumb pronated."""
    angles = pose_angles(hand.rig, hand.joints, OPEN)
    bone = hand.joints.bone("thumb_metacarpal")
    if bone is not None:
        low, high = angle_bounds(hand.joints, "thumb_metacarpal", "twist")
        angles[bone, TWIST] = np.clip(hand.joints.side * np.radians(OPPOSED_DEG), low, high)
    return angles


def of_kind(kind, stage, end):
    """The ways of a kind on a `Stage`; `end` as in `powers`."""
    if kind in AROUND:
        return powers(stage, end) if kind == POWER else hooked(stage, end)
    return pinched(stage) if kind == PINCH else lateral(stage)


def powers(stage, end):
    """Power grips of a product on a `Stage`; `end` 1 or -1 keeps the thumb there, 0 tries both."""
    bars = places.spots(stage.gauge.product, stage.vertices, stage.triangles, stage.mark)
    return _around(POWER, stage, bars, end)


def _around(kind, stage, bars, end):
    return [
        Way(kind, stage, bar, side, roll)
        for bar in bars
        for side in (1, -1)
        if end in (0, side)
        for roll in range(ROLLS)
    ]


def hooked(stage, end):
    """Hooks in which a product hangs; none for a hand, or a wish, without fingers. `end` as in `powers`."""
    own = hooks.stage_for(stage)
    if not np.isfinite(fitter.wanted_depths(own.hand.pads, own.fit.wish)).any():
        return []
    return [way for way in _around(HOOK, own, hooks.bars(own), end) if hooks.hangs(way.spot, way.down)]


def pinched(stage):
    """Pinches of a product on a `Stage`; none for a hand, or a wish, without thumb and fingertips."""
    wish = stage.fit.wish
    if not pinching.can_pinch(stage.hand) or "distal" not in wish.targets_mm:
        return []
    found, out = pinches.spots(stage.gauge, stage.vertices, stage.triangles, stage.mark), []
    for spot in found:
        digits = [digit for digit in spot.digits if wish.digits is None or digit in wish.digits]
        if "thumb" not in digits or len(digits) < 2:
            continue
        depth = min(wish.targets_mm["distal"], THIN * spot.width_mm)
        own = replace(wish, targets_mm={"distal": depth}, digits=tuple(digits))
        out.append(Way(PINCH, replace(stage, fit=replace(stage.fit, wish=own)), spot))
    return out


def lateral(stage):
    """Grips between thumb and the side of the index finger; none for a hand, or a wish, without the two."""
    wish, hand = stage.fit.wish, laterals.hand_of(stage.hand)
    is_wanted = "distal" in wish.targets_mm and (wish.digits is None or set(laterals.DIGITS) <= set(wish.digits))
    if hand is None or not is_wanted:
        return []
    found = pinches.spots(stage.gauge, stage.vertices, stage.triangles, stage.mark, laterals.Side(hand))
    out = []
    for spot in found:
        depth = min(wish.targets_mm["distal"], THIN * spot.width_mm)
        own = replace(wish, targets_mm={"distal": depth, pinching.SIDE: depth}, digits=spot.digits)
        out.append(Way(LATERAL, replace(stage, hand=hand, fit=replace(stage.fit, wish=own)), spot))
    return out
