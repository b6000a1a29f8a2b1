"""The 19 palmar regions of a hand from its bones, cut along the creases as the made hand's are.

Knows nothing of Blender. Creases of the fingers and the palm: Bugbee & Botte 1993, at a hand of 189 mm by 84 mm;
the thumb's creases, the thenar crease and the border of the hypothenar as the made hand has them.
"""

from dataclasses import dataclass

import numpy as np

from ..hand import pads
from ..hand_bones import roles
from ..hand_bones.rig_axes import RigError

NAMES = (
    *(f"thumb_{segment}_pad" for segment in ("distal", "proximal")),
    *(f"{finger}_{segment}_pad" for finger in roles.FINGERS for segment in ("distal", "middle", "proximal")),
    "distal_palm_radial",
    "distal_palm_ulnar",
    "palm_hollow",
    "thenar",
    "hypothenar",
)
NO_REGION = -1
REFERENCE_MM = (84.3, 54.9)
"""Wrist to the middle knuckle, and index to little knuckle across, of the hand that the creases are given for."""
_BASE_MM = {"index": 19.5, "middle": 19.5, "ring": 19.5, "little": 16.0}
_PIP_MM, _DIP_MM, _THUMB_IP_MM, _THUMB_MP_MM = 2.5, 7.5, 2.5, 9.5
_DISTAL_MM = {"index": 9.1, "middle": 6.9, "ring": 10.3, "little": 7.9}
"""Distal palm crease before each knuckle; the proximal crease before the index finger's."""
_THENAR = np.array([[0.0, 8.0], [22.0, 5.0], [42.0, 7.0], [60.0, 14.0], [75.0, 27.0], [79.0, 60.0]])
_FACING, _BEHIND_MM = 0.12, 1.7
"""Least share of the normal towards the palm's side; how far behind a finger's axis its pad begins."""
_LEAST_BEND = 0.2
"""Sine of a finger's bend at rest from which the bend shows the finger's own plane."""


@dataclass(frozen=True)
class _Frame:
    """The palm's own measures: origin at the wrist, rows radial, distal, palmar; mm of the reference hand per unit."""

    origin: np.ndarray
    axes: np.ndarray
    per_unit: np.ndarray

    def places(self, points):
        """Radial, distal, palmar of points (n, 3), mm of the reference hand; radial 0 at the middle knuckle."""
        return (points - self.origin) @ self.axes.T * self.per_unit


def from_bones(rig, joints, normals, edges):
    """Region per vertex (n,), a number in `NAMES` or -1, of a `Rig` whose bones are known.

    `normals` (n, 3): outward at rest, in rig space. `edges` (e, 2): vertex pairs; a region is one piece.
    Raises `RigError` if fewer than two fingers have their three phalanges.
    """
    whole = [f for f in roles.FINGERS if all(f"{f}_{s}" in joints.bones for s in roles.SEGMENTS[1:])]
    if len(whole) < 2:
        raise RigError("regions need two fingers with all three bones; assign them under Bones")
    frame = _frame(rig, joints, whole)
    out = _palm(rig, joints, (frame, whole), normals)
    for digit in ("thumb", *whole):
        if digit == "thumb" and not {"thumb_proximal", "thumb_distal"} <= set(joints.bones):
            continue
        _put_digit(out, rig, joints, (digit, frame))
    for region in range(len(NAMES)):
        _keep_largest_piece(out, region, edges)
    return out


def _frame(rig, joints, whole):
    heads = {finger: rig.rest[joints.bones[f"{finger}_proximal"], :3, 3] for finger in whole}
    middle = heads.get("middle", heads[whole[len(whole) // 2]])
    palmar = np.mean([_palmar(rig, joints, f"{finger}_proximal") for finger in whole], axis=0)
    across = heads[whole[0]] - heads[whole[-1]]
    wrist = joints.bone(roles.WRIST)
    along = sum(roles.along(rig, joints.bones[f"{finger}_proximal"]) for finger in whole)
    reach = np.linalg.norm(across) * REFERENCE_MM[0] / REFERENCE_MM[1]
    origin = rig.rest[wrist, :3, 3] if wrist is not None else middle - along / np.linalg.norm(along) * reach
    distal = middle - origin
    length = np.linalg.norm(distal)
    if not 0.5 < length / reach < 2.0:  # a wrist bone drawn elsewhere
        origin = middle - along / np.linalg.norm(along) * reach
        distal, length = middle - origin, reach
    distal /= length
    palmar -= distal * (distal @ palmar)
    palmar /= np.linalg.norm(palmar)
    radial = np.cross(distal, palmar)
    radial *= np.sign(radial @ across) or 1.0
    share = {"index": 0.251, "middle": 0.0, "ring": -0.206, "little": -0.402}
    breadth = (across @ radial) / max(share[whole[0]] - share[whole[-1]], 1e-9)
    scale = np.array([84.0 / breadth, REFERENCE_MM[0] / length, REFERENCE_MM[0] / length])
    return _Frame(origin, np.stack([radial, distal, palmar]), scale)


def _palm(rig, joints, hand, normals):
    frame, whole = hand
    places = frame.places(rig.vertices)
    x, y = places[:, 0], places[:, 1]
    knuckles = {finger: frame.places(rig.rest[[joints.bones[f"{finger}_proximal"]], :3, 3])[0] for finger in whole}
    line = np.array(sorted((place[0], place[1] - _DISTAL_MM[finger]) for finger, place in knuckles.items()))
    ends = [[line[0, 0] - 40.0, line[0, 1]], *line, [line[-1, 0] + 40.0, line[-1, 1]]]
    crease = np.interp(x, *np.array(ends).T)
    between = knuckles["middle"][0] if "middle" in knuckles else 0.0
    between = 0.5 * (between + knuckles["ring"][0]) if "ring" in knuckles else between - 8.75
    out = np.full(len(x), NAMES.index("palm_hollow"))
    out[x < -3.0 - 0.35 * y] = NAMES.index("hypothenar")
    out[x > np.interp(y, *_THENAR.T)] = NAMES.index("thenar")
    is_far = (y > crease) & (x < 40.0)
    out[is_far] = np.where(x > between, NAMES.index("distal_palm_radial"), NAMES.index("distal_palm_ulnar"))[is_far]
    own = _carried_by_hand(rig, joints)
    out[(normals @ frame.axes[2] < _FACING) | (y < 0.0) | ~own] = NO_REGION
    return out


def _carried_by_hand(rig, joints):
    """Whether most of a vertex's weight is that of bones at or below the wrist, or that play a part."""
    mask = np.zeros(len(rig.names), bool)
    mask[list(joints.bones.values())] = True
    wrist = joints.bone(roles.WRIST)
    for bone in range(len(rig.names)):
        above = bone
        while above >= 0 and above != wrist:
            above = rig.parents[above]
        mask[bone] |= wrist is not None and above == wrist
    return rig.weights[:, mask].sum(axis=1) > 0.5


def _put_digit(out, rig, joints, which):
    digit, frame = which
    segments = ("metacarpal", "proximal", "distal") if digit == "thumb" else roles.SEGMENTS[1:]
    bones = [joints.bones[f"{digit}_{segment}"] for segment in segments if f"{digit}_{segment}" in joints.bones]
    phalanges = bones[-2:] if digit == "thumb" else bones
    own = np.flatnonzero(rig.weights[:, phalanges].sum(axis=1) > 0.5)
    if not len(own):
        return
    sides = {joints.bones[role]: _palmar(rig, joints, role) for role in joints.bones if role.startswith(digit)}
    points, per_unit = rig.vertices[own], frame.per_unit[1]
    bone = np.array(phalanges)[rig.weights[own][:, phalanges].argmax(axis=1)]
    palmar = np.array([sides[k] for k in bone])
    axes = np.array([roles.along(rig, k) for k in bone])
    arms = points - rig.rest[bone, :3, 3]
    side = np.einsum("nk,nk->n", arms, palmar) * per_unit
    starts = {k: s for k, s in zip(bones, _starts(rig, bones), strict=True)}
    along = (np.einsum("nk,nk->n", arms, axes) + np.array([starts[k] for k in bone])) * per_unit
    joint = [starts[k] * per_unit for k in bones]
    if digit == "thumb":
        mp = joint[-2] + _THUMB_MP_MM
        borders, names = [joint[-1] - _THUMB_IP_MM], ["thumb_proximal_pad", "thumb_distal_pad"]
    else:
        mp = _BASE_MM[digit]
        borders = [joint[1] - _PIP_MM, joint[2] - _DIP_MM]
        names = [f"{digit}_{segment}_pad" for segment in ("proximal", "middle", "distal")]
    numbers = np.array([NAMES.index(name) for name in names])[np.searchsorted(borders, along)]
    is_digit = along >= mp
    numbers[side <= -_BEHIND_MM] = NO_REGION
    out[own[is_digit]] = numbers[is_digit]


def _palmar(rig, joints, role):
    """Palm side of a bone: across the plane in which its digit is bent at rest, else by its flexion axis."""
    digit = role.partition("_")[0]
    ends = [joints.bone(f"{digit}_{segment}") for segment in ("proximal", "distal")]
    if digit == "thumb" or None in ends:
        return pads.palmar(rig, joints, role)
    axis = np.cross(roles.along(rig, ends[0]), roles.along(rig, ends[1]))
    known = roles.flexion_axis(rig, joints.bones[role])
    if np.linalg.norm(axis) < _LEAST_BEND or axis @ known < 0.8 * np.linalg.norm(axis):
        return pads.palmar(rig, joints, role)
    facing = np.cross(axis, roles.along(rig, joints.bones[role]))
    return facing / np.linalg.norm(facing)


def _starts(rig, bones):
    """Way along the digit to the head of each bone, from the first one's."""
    steps = np.linalg.norm(np.diff(rig.rest[bones, :3, 3], axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _keep_largest_piece(regions, region, edges):
    """Give every smaller piece of a region to the region that it has most edges to."""
    inside = regions == region
    if not inside.any():
        return
    label = np.where(inside, np.arange(len(regions)), -1)
    pairs = edges[inside[edges[:, 0]] & inside[edges[:, 1]]]
    while True:
        least = np.minimum(label[pairs[:, 0]], label[pairs[:, 1]])
        new = label.copy()
        np.minimum.at(new, pairs[:, 0], least)
        np.minimum.at(new, pairs[:, 1], least)
        new[inside] = new[new[inside]]
        if np.array_equal(new, label):
            break
        label = new
    pieces, sizes = np.unique(label[inside], return_counts=True)
    both = np.concatenate([edges, edges[:, ::-1]])
    for piece in pieces[pieces != pieces[sizes.argmax()]]:
        rows = label == piece
        around = regions[both[rows[both[:, 0]] & ~rows[both[:, 1]], 1]]
        regions[rows] = np.bincount(around + 1).argmax() - 1 if len(around) else NO_REGION
