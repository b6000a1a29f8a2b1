"""What is kept of a grasp that was found: what counts against it, by cause, and its picture. Knows no Blender objects.

The weights are those of `grasp/search.py`; a test holds the causes of a grasp against its score.
"""

import json

import numpy as np

from ..grasp_fit import closing, places, thumb
from ..hand.skinning import pose_matrices, skin, skin_normals
from . import picture

HARD_MPA, SLIPS, OPPOSED, UNSETTLED = 0.4, 2.0, 1.5, 2.0
_EYE = (0.72, 0.18, 0.67)
"""From where a grasp is seen, in the palm's frame: the thumb's side, along the fingers, out of the palm."""
_SPREAD = 6000
"""Points of the product's surface that are drawn."""


def row_of(found, friction):
    """Values of a row of the scene for a `search.Found`: `facts` and `picture` as text.

    `friction`: the coefficient that is there.
    """
    return {"facts": json.dumps(causes(found, friction)), "picture": picture.packed(drawn(found))}


def causes(found, friction):
    """What counts against a grasp by cause, and the numbers that are said of it."""
    state, grasp, way = found.state, found.grasp, found.way
    depths = [grasp.depths_mm[name] for name in grasp.targets_mm]
    misses = [max(want - depth, 0.0) for want, depth in zip(grasp.targets_mm.values(), depths, strict=True)]
    clear = sum(depth <= 0.0 for depth in depths)
    peak = float(state.peaks_mpa.max())
    short = 0.0 if found.asked_n is None else min(abs(state.total_n / found.asked_n - 1.0), 1.0)
    counted = {
        "touch": float(np.mean(np.minimum(misses, 5.0))) + 3.0 * clear / max(len(depths), 1),
        "balance": 8.0 * min(state.imbalance, 1.0) + 3.0 * min(state.lever, 1.0),
        "sum": 3.0 * short,
        "peak": 2.0 * max(peak / HARD_MPA - 1.0, 0.0),
        "deep": 5.0 * state.sunk_mm + 0.3 * max(grasp.deepest_body_mm - 1.0, 0.0),
        "slips": SLIPS if found.friction > friction else 0.0,
        "thumb": OPPOSED * _averted(found),
        "place": float(way.spot.cost),
    }
    said = {
        "asked_n": found.asked_n,
        "net_share": state.imbalance,
        "peak_kpa": 1e3 * peak,
        "clear": int(clear),
        "pads": len(depths),
        "end": int(way.end),
    }
    return {"counted": {name: round(float(value), 4) for name, value in counted.items()}, **said}


def _averted(found):
    """What the cosine between the thumb pad's facing and the way to the index finger's pad lacks; 0 in a pinch."""
    hand = found.way.stage.hand
    if found.way.bar is None or hand.rig.normals is None:
        return 0.0
    angles, place = found.pose
    rig = hand.rig.moved(place)
    posed = pose_matrices(rig, angles)
    return max(thumb.FACING - thumb.cosine_of(hand, skin(rig, posed), skin_normals(rig, posed)), 0.0)


def drawn(found):
    """The picture of a grasp: shades of hand and product, see `picture`."""
    stage, (angles, place) = found.way.stage, found.pose
    rig = stage.hand.rig.moved(place)
    _, radial, distal, palmar = closing.hand_frame(rig, stage.hand.joints)
    hand = picture.faces(skin(rig, pose_matrices(rig, angles)), stage.fit.press.reading.hand.triangles)
    product = places.sampled(stage.vertices, stage.triangles, _SPREAD)
    away = _EYE[0] * radial + _EYE[1] * distal + _EYE[2] * palmar
    return picture.shaded(hand, product, (away, distal))
