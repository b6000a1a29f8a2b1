"""What a grasp does to the hand, from what Blender shows of it: joints bent back, the thumb's pad, skin in skin.

Uses bones and the evaluated mesh, not the fit. Lengths in mm, angles in degrees.
"""

import numpy as np
from handles import measuring

FINGERS = ("index", "middle", "ring", "little")
BENT_DEG = 10.0
"""A finger's middle joint must be bent this far to say which way its last joint bends."""

INWARD_MM = 1.0


def of(hand, points, triangles):
    """Numbers of a posed hand: `dip_back_deg`, the most that a last joint is bent back; `thumb_off_deg`, between the
    direction in which the thumb's pad faces and the way to the index finger's pad; `in_skin`, how many vertices lie
    more than 1 mm deep in other skin."""
    bones = {bone.name: bone for bone in hand.parent.pose.bones}
    return {
        "dip_back_deg": max((_back(bones, finger) for finger in FINGERS), default=0.0),
        "thumb_off_deg": _thumb_off(hand, points, triangles),
        "in_skin": _in_skin(points, triangles),
    }


def _back(bones, finger):
    """How far the last joint is bent back; 0 where it is bent as the middle joint is, or where that is straight."""
    ways = [np.array(bones[f"{finger}_{part}"].vector) for part in ("proximal", "middle", "distal")]
    first, middle, last = (way / np.linalg.norm(way) for way in ways)
    axis = np.cross(first, middle)
    if np.degrees(np.arcsin(min(np.linalg.norm(axis), 1.0))) < BENT_DEG:
        return 0.0
    axis = axis / np.linalg.norm(axis)
    angle = np.degrees(np.arctan2(np.cross(middle, last) @ axis, middle @ last))
    return max(-float(angle), 0.0)


def _thumb_off(hand, points, triangles):
    return facing(hand, (points, triangles), "thumb", ("index",))[0]


def facing(hand, surface, digit, others):
    """Angle between the direction in which a digit's last pad faces and the way to the middle of the last pads of
    `others`; and the distance from it to the nearest of those. `surface`: points (n, 3), triangles (m, 3)."""
    points, triangles = surface
    own, *against = (_rows(hand, f"{name}_distal_pad") for name in (digit, *others))
    corners = points[triangles]
    normals = np.zeros_like(points)
    np.add.at(normals, triangles, np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, None])
    direction = normals[own].sum(axis=0)
    way = np.mean([points[rows].mean(axis=0) for rows in against], axis=0) - points[own].mean(axis=0)
    angle = np.degrees(np.arccos(direction @ way / np.linalg.norm(direction) / np.linalg.norm(way)))
    apart = np.linalg.norm(points[own][:, None] - points[np.concatenate(against)][None], axis=2)
    return float(angle), float(apart.min())


def _rows(hand, name):
    """Vertices of a group."""
    index = hand.vertex_groups[name].index
    return np.array([v.index for v in hand.data.vertices if any(group.group == index for group in v.groups)])


def _in_skin(points, triangles):
    corners = points[triangles]
    normals = np.zeros_like(points)
    np.add.at(normals, triangles, np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, None])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return int((measuring.winding(points - INWARD_MM * normals, points, triangles) > 1).sum())
