"""What the product feels of the pads, as a fit reads it: forces by depth, their sum and their moment. No Blender.

The contact model is too slow for each step of a fit. In between, the force of a vertex is its stiffness times its
depth to the power of `POWER`; the stiffness of a pad comes from the last press, so that both agree where they meet.
"""

from dataclasses import dataclass

import numpy as np

from ..hand.skinning import cross
from . import sharing

POWER = sharing.POWER

ARM_MM = 40.0
"""A moment counts as a force at this arm, half a hand's breadth."""

FIRST_STIFFNESS = 0.006
"""N / mm^1.6 for each mm2 of skin, before anything was pressed: 55 kPa at 4 mm."""

RANGE = 4.0
"""The stiffness of a pad is at most so many times the mean of all, and at least its inverse."""


@dataclass(frozen=True)
class Touched:
    """Skin at a product: its vertices (k,), their places (k, 3), mm, their gaps (k,), mm, and the gap's `slope` (k, 3):
    the product's outward direction, shorter where the depth counts in part."""

    rows: np.ndarray
    points: np.ndarray
    gap: np.ndarray
    slope: np.ndarray

    @property
    def outward(self):
        """The product's outward direction at each vertex (k, 3); zero where there is no slope."""
        return unit(self.slope)


def unit(vectors):
    """The directions (k, 3) of vectors (k, 3); zero where a vector is."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-9)


@dataclass(frozen=True)
class Load:
    """`stiffness` (n,) of every vertex of the hand, N / mm^1.6, zero where no pad is.

    `outer_n` (3), `outer_moment_nmm` (3): what else acts on the product, about `about_mm` (3). `wanted_n`: what the
    pads shall carry in sum, or None; `sharing`: a `sharing.Sharing` of it by fingers, or None. `reference_n` makes
    residuals relative; `weight_mm` is what all but the sharing counts, mm.
    """

    stiffness: np.ndarray
    about_mm: np.ndarray
    reference_n: float
    weight_mm: float
    outer_n: np.ndarray
    outer_moment_nmm: np.ndarray
    wanted_n: float | None = None
    sharing: object = None

    def residuals(self, skin):
        """Residuals, mm, of `Touched` skin: net force, net moment over `ARM_MM`, sum, and what each finger bears beyond
        its share."""
        force = self.stiffness[skin.rows] * np.maximum(-skin.gap, 0.0) ** POWER
        push = -skin.outward * force[:, None]
        net = push.sum(axis=0) + self.outer_n
        moment = cross(skin.points - self.about_mm, push).sum(axis=0) + self.outer_moment_nmm
        excess = 0.0 if self.wanted_n is None else force.sum() - self.wanted_n
        balance = self.weight_mm / self.reference_n * np.concatenate([net, moment / ARM_MM, [excess]])
        if self.sharing is None:
            return balance
        return np.append(balance, sharing.WEIGHT_MM / self.reference_n * self.sharing.excess(skin.rows, force))

    def slopes(self, skin, moves, turning):
        """Derivative (7 or more, d) of the residuals. `moves` (k, d, 3): how points move with each unknown; `turning`
        (k, 3, 3): how the outward direction changes with the point, 1 / mm."""
        depth = np.maximum(-skin.gap, 0.0)
        force = (self.stiffness[skin.rows] * depth**POWER)[:, None, None]
        rise = (self.stiffness[skin.rows] * POWER * depth ** (POWER - 1.0))[:, None, None]
        slope, outward = skin.slope[:, None, :], skin.outward[:, :, None]
        push = rise * outward * slope - force * turning
        moment = _crosses(force[:, :, 0] * skin.outward) + _crosses(skin.points - self.about_mm) @ push
        total = np.zeros_like(slope) if self.wanted_n is None else -rise * slope
        parts = np.concatenate([push, moment / ARM_MM, total], axis=1)
        balance = self.weight_mm / self.reference_n * np.einsum("kij,kdj->id", parts, moves, optimize=True)
        if self.sharing is None:
            return balance
        growth = np.einsum("kj,kdj->kd", (-rise * slope)[:, 0], moves)
        return np.vstack([balance, sharing.WEIGHT_MM / self.reference_n * self.sharing.slopes(skin.rows, growth)])


def _crosses(vectors):
    """Matrices (k, 3, 3) that take the cross product of vectors (k, 3) with what they are applied to."""
    out = np.zeros((len(vectors), 3, 3))
    x, y, z = vectors.T
    out[:, 0, 1], out[:, 0, 2], out[:, 1, 2] = -z, y, -x
    out[:, 1, 0], out[:, 2, 0], out[:, 2, 1] = z, -y, x
    return out


def stiffness_of(pads, areas_mm2, gap, force_n=None):
    """Stiffness (n,) of all vertices from a press: `force_n` (n,) in it, `gap` (n,) before it, mm; or the first guess.

    `areas_mm2` (n,) of the vertices.
    """
    out = np.zeros(len(areas_mm2))
    if force_n is None:
        for pad in pads:
            out[pad.rows] = FIRST_STIFFNESS * areas_mm2[pad.rows]
        return out
    sunk = areas_mm2 * np.maximum(-gap, 0.0) ** POWER
    rows = np.concatenate([pad.rows for pad in pads])
    mean = force_n[rows].sum() / max(sunk[rows].sum(), 1e-9)
    mean = mean if mean > 0.0 else FIRST_STIFFNESS
    for pad in pads:
        own = sunk[pad.rows].sum()
        ratio = force_n[pad.rows].sum() / own if own > 0.0 else mean
        out[pad.rows] = np.clip(ratio, mean / RANGE, mean * RANGE) * areas_mm2[pad.rows]
    return out


def vertex_areas(vertices, triangles):
    """A third of the area of the triangles around each vertex (n,), mm2."""
    corners = vertices[triangles]
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return np.bincount(triangles.ravel(), np.repeat(areas / 3.0, 3), len(vertices))
