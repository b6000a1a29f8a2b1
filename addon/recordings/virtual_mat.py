"""A virtual pressure mat around a cylindrical product: what its sensels read of a contact. Knows nothing of Blender.

A mat counts every sensel that skin touches, so its area exceeds the skin's: a patch of area A and perimeter P reads
about A + 0.64 P a + a² at pitch a. Measured areas and mean pressures compare with these readings, not with the skin's.
"""

from dataclasses import dataclass

import numpy as np

from .. import native
from ..scene.checks import Refusal

PITCH_MM = 10.0 / 4.2**0.5
"""F-Scan, 4.2 sensels per cm² (Xie et al. 2013)."""
THRESHOLDS_KPA = (0.0, 2.0, 5.0)
"""A sensel counts as loaded above these; the threshold of the paper's mat is not known."""
PLACEMENTS = 34
_STEP_AROUND = 21
"""Placement k lies k/34 of a pitch along the axis and 21k/34 around it: neighbors of Fibonacci's series, whose lattice
fills the cell evenly (Sloan and Joe 1994, Lattice Methods for Multiple Integration, chapter 4)."""
ROUND = 0.02
"""Most that the product's distance from its axis may differ from the radius, relative: areas then err by less than
the range over the placements."""
_SIDE = 0.1
"""Cosine between a face's normal and the axis below which the face is the cylinder's side."""
_CAP = 1e-6
"""One minus that cosine below which the face is a flat end."""
_OPEN = 0.5 * np.pi
"""Largest gap around the axis, rad: faces on one side alone, as a plate's, lie near any large circle."""
_OFF_SIDE = 0.01
"""Share of the force that may act elsewhere than on the side."""
QUANTITIES = ("area_mm2", "mean_kpa", "peak_kpa", "force_n")


@dataclass(frozen=True)
class Cylinder:
    """Where a cylinder stands, mm: a `point` of its axis, the unit `axis`, its `radius_mm`."""

    point: np.ndarray
    axis: np.ndarray
    radius_mm: float

    def rolled(self, places_mm):
        """Angle, rad, height over `point`, mm, and distance from the axis, mm, of places (k, 3)."""
        across, up = _directions(self.axis)
        away = places_mm - self.point
        x, y = away @ across, away @ up
        return np.arctan2(y, x), away @ self.axis, np.hypot(x, y)


def cylinder_of(name, vertices_mm, triangles, places_mm):
    """The `Cylinder` that the product `name` is at the height of `places_mm` (k, 3), where it is touched.

    `vertices_mm` (n, 3), `triangles` (t, 3), normals outward. Raises `Refusal` where its radius varies.
    """
    corners = np.asarray(vertices_mm, float)[triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(cross, axis=1)
    corners, normals = corners[size > 0.0], cross[size > 0.0] / size[size > 0.0, None]
    _, axes = np.linalg.eigh((cross.T / np.fmax(size, 1e-300)) @ cross)
    found = [_fitted(axis, corners, normals, places_mm) for axis in axes.T]
    cylinder, (nearest, farthest) = min(found, key=lambda each: np.ptp(each[1]) / each[0].radius_mm)
    if max(cylinder.radius_mm - nearest, farthest - cylinder.radius_mm) > ROUND * cylinder.radius_mm:
        raise Refusal(
            f"the product '{name}' is no cylinder where it is touched: its surface lies {nearest:.1f} to "
            f"{farthest:.1f} mm from the best axis; choose a cylinder as product, or read the skin's area under Result"
        )
    return cylinder


def reading(name, cylinder, loads):
    """What the mat reads of `loads` (k, 5), x, y, z (mm), N, mm², on the `cylinder` of the product `name`.

    The mat closes around the cylinder: the pitch there is the one nearest to `PITCH_MM` of which a whole number fits.
    Returns a dictionary for JSON: `rows` by threshold with (least, mean, greatest) over the placements of the loaded
    sensels' `area_mm2`, `mean_kpa`, largest `peak_kpa` and `force_n`; and `range`, (least, greatest) over all rows.
    Raises `Refusal` if forces act elsewhere than on the cylinder's side, `MeshError` for more sensels than a mat holds.
    """
    angle, height, distance = cylinder.rolled(loads[:, :3])
    is_off = np.abs(distance - cylinder.radius_mm) > 2.0 * ROUND * cylinder.radius_mm
    share = loads[is_off, 3].sum() / loads[:, 3].sum()
    if share > _OFF_SIDE:
        raise Refusal(
            f"{share:.0%} of the force acts outside the side of the cylinder '{name}', where no mat lies; "
            "grasp it between its ends, or read the skin's area under Result"
        )
    columns = max(3, round(2.0 * np.pi * cylinder.radius_mm / PITCH_MM))
    turn = 2.0 * np.pi / columns
    cell_mm2 = PITCH_MM * turn * cylinder.radius_mm
    mat = _wrapped(cylinder.radius_mm, columns, (height.min(), height.max()))
    frames = []
    for number in range(PLACEMENTS):
        along, around = number / PLACEMENTS, number * _STEP_AROUND / PLACEMENTS % 1.0
        at = angle + around * turn
        places = np.column_stack([distance * np.cos(at), distance * np.sin(at), height + along * PITCH_MM])
        frames.append(mat.read(np.column_stack([places, loads[:, 3:]])))
    rows = [_row(np.array(frames), threshold, cell_mm2) for threshold in THRESHOLDS_KPA]
    spread = {name: (min(row[name][0] for row in rows), max(row[name][2] for row in rows)) for name in QUANTITIES}
    return {
        "diameter_mm": 2.0 * cylinder.radius_mm,
        "pitch_mm": (PITCH_MM, turn * cylinder.radius_mm),
        "placements": PLACEMENTS,
        "rows": rows,
        "range": spread,
    }


def _row(frames_kpa, threshold_kpa, cell_mm2):
    """Least, mean and greatest over the frames (f, s) of what the sensels above a threshold read."""
    is_loaded = frames_kpa > threshold_kpa
    area = is_loaded.sum(axis=1) * cell_mm2
    force = (frames_kpa * is_loaded).sum(axis=1) * cell_mm2 / 1e3
    mean = np.divide(1e3 * force, area, out=np.zeros_like(force), where=area > 0.0)
    values = zip(QUANTITIES, (area, mean, frames_kpa.max(axis=1), force), strict=True)
    return {"threshold_kpa": threshold_kpa} | {
        name: (float(each.min()), float(each.mean()), float(each.max())) for name, each in values
    }


def _wrapped(radius_mm, columns, span_mm):
    """The library's mat around the z axis, `columns` around, over heights of `span_mm` and a pitch beyond."""
    rows = int(np.ceil((span_mm[1] - span_mm[0]) / PITCH_MM)) + 4
    height, angle = np.meshgrid(
        span_mm[0] + PITCH_MM * (np.arange(rows) - 1.0), 2.0 * np.pi / columns * np.arange(columns), indexing="ij"
    )
    normals = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1).reshape(-1, 3)
    centers = radius_mm * normals + height.reshape(-1, 1) * [0.0, 0.0, 1.0]
    areas = np.full(len(centers), PITCH_MM * 2.0 * np.pi * radius_mm / columns)
    return native.module.Mat(centers, areas, normals=normals, along=(0, 0, 1))


def _fitted(axis, corners, normals, places_mm):
    """The cylinder about `axis` through the outer side, and the least and greatest distance of the outward faces."""
    across, up = _directions(axis)
    height, touched = corners @ axis, places_mm @ axis
    is_seen = (height.max(axis=1) >= touched.min()) & (height.min(axis=1) <= touched.max())
    is_seen &= np.abs(normals @ axis) < 1.0 - _CAP
    flat, normals_flat = (np.stack([each @ across, each @ up], axis=-1) for each in (corners, normals))
    is_side = np.abs(normals @ axis) < _SIDE
    center, radius = _circle(flat[is_seen & is_side])
    is_seen &= np.einsum("ki,ki->k", flat.mean(axis=1) - center, normals_flat) > 0.0  # not the inner wall of a tube
    if not (is_seen & is_side).any():
        return Cylinder(np.zeros(3), axis, 1.0), (0.0, np.inf)
    center, radius = _circle(flat[is_seen & is_side])
    away = flat[is_seen] - center
    distance = np.linalg.norm(np.concatenate([away, 0.5 * (away + np.roll(away, 1, axis=1))]), axis=-1)
    angle = np.sort(np.arctan2(*away.mean(axis=1).T))
    is_closed = np.diff(angle, append=angle[0] + 2.0 * np.pi).max() < _OPEN
    nearest = distance.min() if is_closed else 0.0
    return Cylinder(center[0] * across + center[1] * up, axis, radius), (nearest, distance.max())


def _circle(points):
    """Center (2) and radius of the circle through `points` (..., 2) (Kåsa 1976: x² + y² = 2 x a + 2 y b + c)."""
    points = points.reshape(-1, 2)
    system = np.column_stack([2.0 * points, np.ones(len(points))])
    a, b, c = np.linalg.lstsq(system, (points**2).sum(axis=1), rcond=None)[0]
    return np.array([a, b]), float(np.sqrt(c + a * a + b * b))


def _directions(axis):
    """Two unit vectors that form a right-handed frame with `axis`."""
    across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    across /= np.linalg.norm(across)
    return across, np.cross(axis, across)
