"""What the product feels of the pads, as a fit reads it: forces by depth, their sum and their moment. No Blender.

The contact model is too slow for each step of a fit. In between, the force of a vertex is its stiffness times its
depth to the power of `POWER`; the stiffness of a pad comes from the last press, so that both agree where they meet.
"""

from dataclasses import dataclass

import numpy as np

POWER = 1.6
"""Force of a pad over its depth: between a half-space's 1.5 and a stiffening layer's 2."""

ARM_MM = 40.0
"""A moment counts as a force at this arm, half a hand's breadth."""

FIRST_STIFFNESS = 0.006
"""N / mm^1.6 for each mm2 of skin, before anything was pressed: 55 kPa at 4 mm."""

RANGE = 4.0
"""The stiffness of a pad is at most so many times the mean of all, and at least its inverse."""


@dataclass(frozen=True)
class Touched:
    """Skin at a product: its vertices (k,), where they are (k, 3), mm, their gaps (k,), mm, and the product's outward
    direction at each (k, 3)."""

    rows: np.ndarray
    points: np.ndarray
    gap: np.ndarray
    outward: np.ndarray


@dataclass(frozen=True)
class Load:
    """`stiffness` (n,) of every vertex of the hand, N / mm^1.6, zero where no pad is.

    `outer_n` (3), `outer_moment_nmm` (3): what else acts on the product, about `about_mm` (3). `wanted_n`: what the
    pads shall carry in sum, or None. `reference_n` makes residuals relative; `weight_mm` is what all of it counts, mm.
    """

    stiffness: np.ndarray
    about_mm: np.ndarray
    reference_n: float
    weight_mm: float
    outer_n: np.ndarray
    outer_moment_nmm: np.ndarray
    wanted_n: float | None = None

    def residuals(self, skin):
        """Seven residuals, mm, of `Touched` skin: net force, net moment over `ARM_MM`, and sum."""
        force = self.stiffness[skin.rows] * np.maximum(-skin.gap, 0.0) ** POWER
        push = -skin.outward * force[:, None]
        net = push.sum(axis=0) + self.outer_n
        moment = np.cross(skin.points - self.about_mm, push).sum(axis=0) + self.outer_moment_nmm
        excess = 0.0 if self.wanted_n is None else force.sum() - self.wanted_n
        return self.weight_mm / self.reference_n * np.concatenate([net, moment / ARM_MM, [excess]])

    def slopes(self, skin, moves):
        """Derivative (7, d) of the residuals; `moves` (k, d): how the gap of each vertex changes."""
        rise = self.stiffness[skin.rows] * POWER * np.maximum(-skin.gap, 0.0) ** (POWER - 1.0)
        change = -rise[:, None] * moves
        net = -skin.outward.T @ change
        moment = -np.cross(skin.points - self.about_mm, skin.outward).T @ change
        total = np.zeros(moves.shape[1]) if self.wanted_n is None else change.sum(axis=0)
        return self.weight_mm / self.reference_n * np.vstack([net, moment / ARM_MM, total])


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
