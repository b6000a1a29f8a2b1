"""Hooks: a bar hangs in four bent fingers, as a bucket's or a bag's handle, without thumb and palm. No Blender.

What hangs turns until its middle is below the bar: its weight acts along the fingers of the hanging hand. Along the
bar it stays where it is: fingers off its middle have a moment to bear.
"""

from dataclasses import replace

import numpy as np

from ..grasp_fit import closing, places

FINGERS = ("index", "middle", "ring", "little")

DEPTHS = ("distal", "middle")
"""Kinds of pads that bear: the bar lies in the bend of the fingers."""

ALONG = 0.45
"""The bar begins so far from the knuckles along the fingers, in parts of the hand's breadth: before the bend."""

STOPS_DEG = {f"{finger}_proximal": 25.0 for finger in FINGERS}
"""The knuckles bend no further before a fit, or the fingers press the bar into the palm."""

OFF_MM = 20.0
"""A bar that lies so far from the product's middle hangs above it; nearer, the product may hang either way."""

BELOW = 0.7
"""Cosine, at least, between the way down and the way from such a bar to the middle."""


def stage_for(stage):
    """A `Stage` whose hand has the pads of the fingers alone: all other skin shall stay off the product."""
    wish = stage.fit.wish
    digits = [digit for digit in FINGERS if wish.digits is None or digit in wish.digits]
    depths = {kind: depth for kind, depth in wish.targets_mm.items() if kind in DEPTHS}
    pads = [pad for pad in stage.hand.pads if pad.kind != "palm" and pad.role.partition("_")[0] in digits]
    own = replace(wish, targets_mm=depths, digits=tuple(digits))
    return replace(stage, hand=replace(stage.hand, pads=pads), fit=replace(stage.fit, wish=own))


def bars(stage):
    """The bars of a product, each with the side from which it hangs where that is known."""
    found = places.spots(stage.gauge.product, stage.vertices, stage.triangles, stage.mark)
    return [_hung(spot) for spot in found]


def _hung(spot):
    """The spot with its `side` away from the product's middle, which is the origin of the own frame."""
    off = loaded_at(spot)
    far = float(np.linalg.norm(off))
    return replace(spot, side=off / far) if far > OFF_MM else spot


def loaded_at(spot):
    """The point (3) of a bar's axis at which the weight acts, above the product's middle, the own frame's origin."""
    return spot.center - spot.axis * (spot.center @ spot.axis)


def down(hand, toward, axis):
    """The way (3) in which the fingers of the hand point, and the weight acts, where it is laid around a bar: the palm
    `toward` (3), the thumb's end of the bar's `axis` (3)."""
    _, radial, distal, facing = closing.hand_frame(hand.rig, hand.joints)
    sign = np.sign(np.cross(facing, radial) @ distal) or 1.0
    return sign * np.cross(toward, axis)


def hangs(spot, way_down):
    """Whether a product hangs from the spot in that direction (3)."""
    off = loaded_at(spot)
    far = float(np.linalg.norm(off))
    return far <= OFF_MM or float(-off @ way_down) > BELOW * far
