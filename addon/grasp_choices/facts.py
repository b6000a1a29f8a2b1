"""What is kept of a grasp that was found: what counts against it, by cause, and its picture. Knows no scene."""

import json

from ..grasp_fit import closing, places
from ..hand.skinning import pose_matrices, skin
from . import picture

_EYE = (0.72, 0.18, 0.67)
"""From where a grasp is seen, in the palm's frame: the thumb's side, along the fingers, out of the palm."""
_SPREAD = 6000
"""Points of the product's surface that are drawn."""


def row_of(found):
    """Values of a row of the scene for a `search.Found`: `facts` and `picture` as text."""
    return {"facts": json.dumps(facts_of(found)), "picture": picture.packed(drawn(found))}


def facts_of(found):
    """What counts against a grasp by cause (`counted`), and the numbers that are said of it."""
    state, grasp = found.state, found.grasp
    return {
        "counted": {name: round(float(value), 4) for name, value in found.causes.items()},
        "asked_n": found.asked_n,
        "net_share": state.imbalance,
        "peak_kpa": 1e3 * float(state.peaks_mpa.max()),
        "clear": sum(grasp.depths_mm[name] <= 0.0 for name in grasp.targets_mm),
        "pads": len(grasp.targets_mm),
        "end": int(found.way.end),
    }


def drawn(found):
    """The picture of a grasp: shades of hand and product, see `picture`."""
    stage, (angles, place) = found.way.stage, found.pose
    rig = stage.hand.rig.moved(place)
    _, radial, distal, palmar = closing.hand_frame(rig, stage.hand.joints)
    hand = picture.faces(skin(rig, pose_matrices(rig, angles)), stage.fit.press.reading.hand.triangles)
    product = places.sampled(stage.vertices, stage.triangles, _SPREAD)
    away = _EYE[0] * radial + _EYE[1] * distal + _EYE[2] * palmar
    return picture.shaded(hand, product, (away, distal))
