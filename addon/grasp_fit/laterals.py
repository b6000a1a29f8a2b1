"""Grips between the thumb's pad and the side of the index finger, as a key is held: pads, and room for the hand.

Knows nothing of Blender. World mm, radians.
"""

from dataclasses import replace

import numpy as np

from ..hand import pads as pads_of_hand
from ..hand.poses import LATERAL, LATERAL_SPREAD
from ..hand.skinning import pose_matrices, skin
from ..hand_bones.roles import along
from . import closing, pinches, pinching

MOST_MM = 35.0
"""Thicker than this nothing is held so: a median hand's thumb opens to 30 mm from the index finger's side."""

SIDEWAYS = 0.5
"""Skin of the index finger's middle phalanx whose normal has this cosine, or more, to the thumb's side is its side."""

DIGITS = ("thumb", "index")
JAWS = pinching.Jaws(LATERAL, LATERAL_SPREAD, pinching.SIDE)

STEP_MM = 3.0
"""The hand's opening is taken in steps of so much, mm, where room for it is looked for."""

POINTS = 80
NEAR_MM = 14.0
"""So many points of the skin stand for the hand; those so near to the middle of the grip touch the product anyway."""

ROOM_MM = 1.0
BLOCKED = 24.0
"""What counts for all of the hand in the product, or nearer than `ROOM_MM`."""


def hand_of(hand):
    """The hand with the side of the index finger as a pad; None for a hand that has not both of what a grip takes.

    The index finger's last pad is none here, but skin that shall stay off the product: else cards and pencils are held
    by it.
    """
    side = _side_of(hand)
    if side is None or not any(pad.role == "thumb_distal" and pad.kind == pinching.DISTAL for pad in hand.pads):
        return None
    out = []
    for pad in hand.pads:
        if pad.role == "index_distal" and pad.kind == pinching.DISTAL:
            continue
        if pad.name == side[0].name:
            out.append(replace(pad, name="index_side", kind=pinching.SIDE, rows=side[1]))
            pad = replace(pad, rows=np.setdiff1d(pad.rows, side[1]))
        if len(pad.rows) >= pads_of_hand.DEEPEST:
            out.append(pad)
    return replace(hand, pads=out)


def _side_of(hand):
    """The pad of the index finger's middle phalanx and its vertices that face the thumb's side; None without."""
    rig, joints = hand.rig, hand.joints
    pad = next((pad for pad in hand.pads if pad.role == "index_middle" and pad.kind == "middle"), None)
    if pad is None or rig.normals is None:
        return None
    _, radial, _, _ = closing.hand_frame(rig, joints)
    radial = np.linalg.solve(rig.world_from_rig[:3, :3], radial)
    bone = along(rig, joints.bones["index_middle"])
    radial = radial - bone * (radial @ bone)
    rows = pad.rows[rig.normals[pad.rows] @ (radial / np.linalg.norm(radial)) > SIDEWAYS]
    return (pad, rows) if len(rows) >= 2 * pads_of_hand.DEEPEST else None


class Side:
    """The thumb against the side of the index finger of a `hand_of`: how thick a product may be, mm, and how the hand
    comes to it."""

    most_mm, jaws = MOST_MM, JAWS

    def __init__(self, hand):
        self.hand, self.known = hand, {}

    def approaches(self, gauge, pinched, axes):
        """Directions (3) for the thumb to point in, each with the cost of what is in the way, and the digits."""
        center, across, width = pinched
        skin_there = self._skin(round(width / STEP_MM))
        for reach in pinches.around(across, axes):
            gaps = gauge.gaps(center + skin_there @ np.stack([across, np.cross(reach, across), reach]))
            yield reach, BLOCKED * float((gaps < ROOM_MM).mean()), DIGITS

    def _skin(self, step):
        """Points (n, 3) of the hand opened to that step, in the frame of its grip: across, aside, reach."""
        if step not in self.known:
            rig = self.hand.rig
            angles = pinching.opened(self.hand, step * STEP_MM, JAWS)
            middle, across, reach = pinching.grip_of(self.hand, angles, JAWS)
            rows = np.arange(len(rig.vertices))[:: max(len(rig.vertices) // POINTS, 1)]
            local = skin(rig.subset(rows), pose_matrices(rig, angles)) - middle
            local = local @ np.stack([across, np.cross(reach, across), reach], axis=1)
            self.known[step] = local[np.linalg.norm(local, axis=1) > NEAR_MM]
        return self.known[step]
