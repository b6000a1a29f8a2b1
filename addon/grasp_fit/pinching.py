"""Where a pinch begins: the hand opened as wide as the product is thick, thumb on one side, fingertips on the other.

Knows nothing of Blender. World mm, radians.
"""

from dataclasses import dataclass

import numpy as np

from ..hand.poses import PINCHED, SPREAD
from ..hand.skinning import TWIST, pose_matrices, skin
from ..hand_bones.roles import pose_angles
from . import closing

HALVINGS = 8
"""Of the interval in which the opening of the hand is sought: 0.4 mm for a hand that opens 100 mm."""


OPPOSED = ("index", "middle")
"""The thumb stands against these; the other fingers go along."""

DISTAL, SIDE = "distal", "side"
"""Kinds of pads: the thumb stands against the last pads of `OPPOSED`, or against the side of a finger."""


@dataclass(frozen=True)
class Jaws:
    """What pinches: the poses of the hand `closed` and `spread`, and the kind of pad that the thumb stands against."""

    closed: dict
    spread: dict
    kind: str = DISTAL


TIPS = Jaws(PINCHED, SPREAD)


@dataclass(frozen=True)
class Pinching:
    """How the hand shall pinch: the middle of what is pinched, `center` (3), mm; the unit direction `across` from the
    fingers to the thumb (3); the unit direction `reach` in which the fingers point, or the thumb where it stands
    against a side (3); the `width_mm` between; and the `jaws`."""

    center: np.ndarray
    across: np.ndarray
    reach: np.ndarray
    width_mm: float
    jaws: Jaws = TIPS


def start_of(hand, gauge, pinching):
    """Place (4, 4) and angles (b, 3) from which a pinch is fitted."""
    angles = opened(hand, pinching.width_mm, pinching.jaws)
    middle, across, reach = grip_of(hand, angles, pinching.jaws)
    own = np.stack([across, np.cross(reach, across), reach], axis=1)
    goal = np.stack([pinching.across, np.cross(pinching.reach, pinching.across), pinching.reach], axis=1)
    place = np.eye(4)
    place[:3, :3] = goal @ own.T
    place[:3, 3] = pinching.center - place[:3, :3] @ middle
    moved = hand.rig.moved(place)
    if gauge.is_thin:
        angles = closing.clear_fingers(moved, hand.joints, hand.capsules, gauge, angles)
    return place, angles


def can_pinch(hand):
    """Whether the hand has the pads that a pinch takes."""
    roles = {pad.role for pad in hand.pads if pad.kind == "distal"}
    return "thumb_distal" in roles and any(f"{finger}_distal" in roles for finger in OPPOSED)


def opened(hand, width_mm, jaws=TIPS):
    """Angles (b, 3) in which the thumb's pad and those it stands against are `width_mm` apart; or as near to it as the
    hand opens and closes."""
    ends = [pose_angles(hand.rig, hand.joints, pose) for pose in (jaws.closed, jaws.spread)]

    def angles_at(share):
        return (1.0 - share) * ends[0] + share * ends[1]

    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        share = 0.5 * (low + high)
        thumb, fingers = _pads(hand, angles_at(share), jaws)
        if np.linalg.norm(thumb - fingers) < width_mm:
            low = share
        else:
            high = share
    return angles_at(0.5 * (low + high))


def grip_of(hand, angles, jaws):
    """Middle (3) between thumb and fingers, the unit direction (3) from these to the thumb, and where they, or the
    thumb against a side, point (3)."""
    thumb, fingers = _pads(hand, angles, jaws)
    across = (thumb - fingers) / max(np.linalg.norm(thumb - fingers), 1e-9)
    if jaws.kind == SIDE:
        bone = hand.joints.bone("thumb_distal")
        turn = hand.rig.world_from_rig[:3, :3] @ pose_matrices(hand.rig, angles)[bone, :3, :3]
        reach = turn @ hand.rig.axes[bone, :, TWIST]
    else:
        reach = fingers - closing.hand_frame(hand.rig, hand.joints)[0]
    reach = reach - across * (reach @ across)
    return 0.5 * (thumb + fingers), across, reach / np.linalg.norm(reach)


def _pads(hand, angles, jaws):
    """Middles (3) of the thumb's last pad and of what it stands against."""
    posed = pose_matrices(hand.rig, angles)

    def middles(kind, digits):
        chosen = [pad for pad in hand.pads if pad.kind == kind and pad.role.partition("_")[0] in digits]
        return np.mean([skin(hand.rig.subset(pad.rows), posed).mean(axis=0) for pad in chosen], axis=0)

    return middles(DISTAL, ("thumb",)), middles(jaws.kind, OPPOSED)
