"""Where a product can be pinched between thumb and fingertips: two sides that face away, with room for the hand.

Knows nothing of Blender. Everything is found from the product's own shape, as the spots of `places`.
"""

from dataclasses import dataclass

import numpy as np

from .pinching import TIPS, Pinching
from .places import own_frame, sampled

SAMPLES = 400
"""Points on the surface that are looked at."""

MOST_MM = 75.0
"""Thicker than this nothing is pinched: a median hand's thumb and fingertips span it with ease."""

STEP_MM = 1.5
"""A way through the product is followed in steps of this size."""

OPPOSITE = 0.7
"""Cosine between the two sides from which they face away from each other."""

WAYS = 8
"""Directions that the fingers may point in, around the line from thumb to fingers."""

FINGER_MM = np.arange(-8.0, 66.0, 12.0)
WEB_MM = np.arange(60.0, 90.0, 10.0)
PALM_MM = np.arange(90.0, 170.0, 20.0)
"""Behind the fingertips stand the fingers so far, then the web of the thumb, then the palm."""

BESIDE_MM = np.array([-14.0, 0.0, 14.0])
HALF_FINGER_MM = 9.0
ROOM_MM = 2.0
"""Half a finger's thickness; where a finger stands the product is at least `ROOM_MM` away."""

BROAD_MM = 24.0
"""If the product is there this far to both sides, ring and little finger help as well."""

AWAY_MM = 80.0
MARKED_MM = 40.0
EASY_MM = 35.0
"""A pinch costs one more for each of these: from the product's middle, or from its origin if that lies at its surface;
and for each doubling of a thickness above `EASY_MM`."""

BLOCKED = 6.0
WORSE = 1.5
SPOTS = 4
APART_MM = 25.0

JAW = ("thumb", "index", "middle")
ALL = ("thumb", "index", "middle", "ring", "little")


@dataclass(frozen=True)
class Pinch(Pinching):
    """A place to pinch, and the `digits` that do; `cost` says how far it is from a pinch that a hand likes."""

    digits: tuple = JAW
    cost: float = 0.0


class Tips:
    """The thumb against fingertips: how thick a product may be, mm, and how the hand comes to it."""

    most_mm, jaws = MOST_MM, TIPS

    def approaches(self, gauge, pinched, axes):
        """Directions (3) for the fingers to point in, each with the cost of what is in the way, and the digits."""
        center, across, width = pinched
        for reach in around(across, axes):
            aside = np.cross(across, reach)
            high = 0.5 * width + HALF_FINGER_MM
            blocks = [
                _grid(-FINGER_MM, BESIDE_MM, np.array([-high, high])),
                _grid(-WEB_MM, BESIDE_MM, np.linspace(-high, high, 5)),
                _grid(-PALM_MM, 2.5 * BESIDE_MM, np.linspace(-high - 15.0, high + 15.0, 5)),
            ]
            shares = []
            for block in blocks:
                gaps = gauge.gaps(center + block @ np.stack([reach, aside, across]))
                shares.append((gaps < ROOM_MM).mean())
            broad = gauge.gaps(center + np.outer([-BROAD_MM, BROAD_MM], aside))
            yield reach, BLOCKED * sum(shares), ALL if (broad < 0.5).all() else JAW


def spots(gauge, vertices, triangles, mark=None, hold=None):
    """Places to pinch a product (`walls.Gauge`), best first; perhaps none. The rest as of `places.spots`; `hold`: how,
    `Tips` (the default) or `laterals.Side`."""
    hold = hold or Tips()
    origin, axes = own_frame(vertices, triangles)
    points, normals = _samples(gauge, vertices, triangles)
    widths, is_opposite = _thickness(gauge, points, normals)
    kept = np.flatnonzero(is_opposite & (widths <= hold.most_mm))
    if not len(kept):
        return []
    points, normals, widths = points[kept], normals[kept], widths[kept]
    centers = points - 0.5 * widths[:, None] * normals
    home, scale = origin, AWAY_MM
    if mark is not None and abs(gauge.gaps(np.asarray(mark, float)[None])[0]) < MARKED_MM:
        home, scale = np.asarray(mark, float), MARKED_MM
    cost = np.linalg.norm(centers - home, axis=1) / scale + np.maximum(np.log2(widths / EASY_MM), 0.0)
    order = np.argsort(cost.round(2), kind="stable")[: SAMPLES // 4]
    found = []
    for k in order:
        if found and cost[k] > min(pinch.cost for pinch in found) + WORSE:
            break
        for reach, blocked, digits in hold.approaches(gauge, (centers[k], normals[k], widths[k]), axes):
            where = centers[k], normals[k], reach, float(widths[k])
            found.append(Pinch(*where, hold.jaws, digits, float(cost[k] + blocked)))
    found.sort(key=lambda pinch: round(pinch.cost, 2))
    kept = []
    for pinch in found:
        if len(kept) < SPOTS and pinch.cost <= found[0].cost + WORSE and all(_differ(pinch, one) for one in kept):
            kept.append(pinch)
    return kept


def _samples(gauge, vertices, triangles):
    """Points (n, 3) spread over the surface that is seen, and the outward direction at each (n, 3)."""
    points, normals = sampled(vertices, triangles, SAMPLES)
    out = [gauge.gaps(points + sign * 0.3 * normals) for sign in (1.0, -1.0)]
    turned = np.where(out[0] >= out[1], 1.0, -1.0)
    is_seen = np.maximum(*out) > 0.2
    return points[is_seen], (turned[:, None] * normals)[is_seen]


def _thickness(gauge, points, normals):
    """How far it is through the product from each point (n,), mm, and whether the other side faces away (n,)."""
    steps = np.arange(1, int(MOST_MM / STEP_MM) + 1) * STEP_MM
    along = points[:, None] - steps[None, :, None] * normals[:, None]
    is_out = gauge.gaps(along.reshape(-1, 3)).reshape(len(points), -1) > 0.0
    first = is_out.argmax(axis=1)
    gap, out = gauge.read(along[np.arange(len(points)), first])
    is_opposite = is_out.any(axis=1) & ((out * -normals).sum(axis=1) > OPPOSITE)
    return steps[first] - np.where(is_opposite, gap, 0.0), is_opposite


def around(across, axes):
    """`WAYS` unit directions (3) around `across`, the first one along the axis of the product that lies most across."""
    first = axes[:, np.abs(axes.T @ across).round(3).argmin()]
    first = first - across * (first @ across)
    first = first / np.linalg.norm(first)
    second = np.cross(across, first)
    for way in range(WAYS):
        turn = 2.0 * np.pi * way / WAYS
        yield np.cos(turn) * first + np.sin(turn) * second


def _grid(along, aside, across):
    """Points (n, 3) of a grid: how far along, aside and across."""
    return np.stack(np.meshgrid(along, aside, across, indexing="ij"), axis=-1).reshape(-1, 3)


def _differ(one, other):
    apart = np.linalg.norm(one.center - other.center) > APART_MM
    return apart or one.across @ other.across < 0.8 or one.reach @ other.reach < 0.8
