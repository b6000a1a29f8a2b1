"""Keeps fingers apart: every phalanx as a capsule, and how far two of them overlap. Knows nothing of Blender."""

from dataclasses import dataclass

import numpy as np

from ..hand_bones.roles import FINGERS

ALLOWED_MM = 0.3
"""Two fingers may press this far into each other: neighbours in a fist do touch."""

RADIUS_QUANTILE = 0.85
"""A phalanx is wider than deep and meets its neighbour with its sides: this quantile of the skin's distance to its
center line is about half the breadth. At 0.4 fingers cut into each other on thick products, at 0.7 in a fist on a
thin one."""

STEPS = 24
"""Points on the center line of a phalanx: about 2 mm apart on the longest one."""


@dataclass(frozen=True)
class Capsules:
    """`bones` (c,), end points (c, 2, 3) in rig space carried by their bone, `radius` (c,) mm, `pairs` (p, 2), allowed
    overlap of each pair (p,) mm."""

    bones: np.ndarray
    ends: np.ndarray
    radius: np.ndarray
    pairs: np.ndarray
    allowed: np.ndarray


def build(rig, joints, tails):
    """Capsules of the phalanges of `rig`; `tails` (b, 3): rest ends of the bones in rig space."""
    scale = abs(np.linalg.det(rig.world_from_rig[:3, :3])) ** (1.0 / 3.0)
    owner = rig.weights.argmax(axis=1)
    roles, bones, ends, radius = [], [], [], []
    for role, bone in joints.bones.items():
        rows = np.flatnonzero((owner == bone) & (rig.weights[:, bone] > 0.6))
        if role.endswith("metacarpal") or "_" not in role or len(rows) < 6:
            continue
        head, along = rig.rest[bone, :3, 3], tails[bone] - rig.rest[bone, :3, 3]
        part = np.clip((rig.vertices[rows] - head) @ along / (along @ along), 0.0, 1.0)
        off = rig.vertices[rows] - head - part[:, None] * along
        middle = (part > 0.15) & (part < 0.85)
        center = off[middle].mean(axis=0) if middle.any() else np.zeros(3)
        size = np.quantile(np.linalg.norm((off - center)[middle], axis=1), RADIUS_QUANTILE) if middle.any() else 0.0
        end = head + along
        if role.endswith("distal"):
            end = head + along * max(0.3, 1.0 - size / np.linalg.norm(along))
        roles.append(role)
        bones.append(bone)
        ends.append([head + center, end + center])
        radius.append(size * scale)
    meeting = [(i, j) for i in range(len(roles)) for j in range(i) if _may_meet(roles[i], roles[j])]
    pairs = np.array(meeting, int).reshape(-1, 2)
    out = Capsules(np.array(bones), np.array(ends), np.array(radius), pairs, np.zeros(len(pairs)))
    rest = overlaps(out, rig, rig.rest)[0]
    return Capsules(out.bones, out.ends, out.radius, pairs, np.maximum(rest, 0.0) + ALLOWED_MM)


def _may_meet(role, other):
    digit, other_digit = role.partition("_")[0], other.partition("_")[0]
    if "thumb" in (digit, other_digit):
        return digit != other_digit
    return abs(FINGERS.index(digit) - FINGERS.index(other_digit)) == 1


def overlaps(capsules, rig, posed):
    """Overlap of every pair beyond the allowed (p,), mm, positive inside, and what its gradient needs.

    Returns `(overlap, points, direction)`: `points` (p, 2, 3) nearest points on the two center lines, world mm,
    `direction` (p, 3) unit from the second to the first.
    """
    ends = world_ends(capsules, rig, posed)
    first, second = ends[capsules.pairs[:, 0]], ends[capsules.pairs[:, 1]]
    points = nearest_on_segments(first, second)
    apart = points[:, 0] - points[:, 1]
    length = np.maximum(np.linalg.norm(apart, axis=1), 1e-9)
    reach = capsules.radius[capsules.pairs].sum(axis=1)
    return reach - length - capsules.allowed, points, apart / length[:, None]


def world_ends(capsules, rig, posed):
    """End points (c, 2, 3) of the center lines, world mm."""
    carried = posed[capsules.bones] @ rig.bone_from_rig[capsules.bones]
    ends = np.einsum("cij,ckj->cki", carried[:, :3, :3], capsules.ends) + carried[:, None, :3, 3]
    return ends @ rig.world_from_rig[:3, :3].T + rig.world_from_rig[:3, 3]


def center_points(capsules, rig, posed):
    """Points (k, 3) on the center lines, world mm, `STEPS` to a phalanx."""
    ends = world_ends(capsules, rig, posed)
    along = np.linspace(0.0, 1.0, STEPS)[None, :, None]
    return (ends[:, :1] * (1.0 - along) + ends[:, 1:] * along).reshape(-1, 3)


def nearest_on_segments(first, second):
    """Nearest points (p, 2, 3) of segment pairs (p, 2, 3); Ericson 2005, section 5.1.9."""
    along, other = first[:, 1] - first[:, 0], second[:, 1] - second[:, 0]
    between = first[:, 0] - second[:, 0]
    a, e = (along**2).sum(axis=1), (other**2).sum(axis=1)
    b, c, f = (along * other).sum(axis=1), (along * between).sum(axis=1), (other * between).sum(axis=1)
    denominator = a * e - b * b
    s = np.where(denominator > 1e-9 * a * e, (b * f - c * e) / np.where(denominator == 0.0, 1.0, denominator), 0.0)
    t = np.clip((b * np.clip(s, 0.0, 1.0) + f) / np.maximum(e, 1e-12), 0.0, 1.0)
    s = np.clip((t * b - c) / np.maximum(a, 1e-12), 0.0, 1.0)
    return np.stack([first[:, 0] + s[:, None] * along, second[:, 0] + t[:, None] * other], axis=1)
