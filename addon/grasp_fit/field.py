"""Distances to a product on a grid, for skin that is far from it. Knows nothing of Blender."""

from dataclasses import dataclass

import numpy as np

MARGIN_MM = 70.0
"""The grid reaches so far beyond the product: about a finger's length."""

POINTS = 80_000
LEAST_STEP_MM = 5.0

FAR_STEPS = 1.2
"""Skin is far from the product beyond so many steps of the grid."""


@dataclass(frozen=True)
class Field:
    """Distances `values` (i, j, k), mm, and their `slopes` (i, j, k, 3), at `origin` (3) + `step` times the index."""

    origin: np.ndarray
    step: float
    values: np.ndarray
    slopes: np.ndarray

    def read(self, points):
        """Distances (n,), slopes (n, 3), and where both will do (n,) bool: far outside the product, and on the grid."""
        cells = (points - self.origin) / self.step
        shape = np.array(self.values.shape)
        low = np.minimum(np.maximum(cells.astype(int), 0), shape - 2)
        part = cells - low
        strides = np.array([shape[1] * shape[2], shape[2], 1])
        at = low @ strides
        values = self.values.ravel()
        x, y, z = part.T
        below = (1.0 - y) * ((1.0 - z) * values[at] + z * values[at + 1])
        below += y * ((1.0 - z) * values[at + strides[1]] + z * values[at + strides[1] + 1])
        at = at + strides[0]
        above = (1.0 - y) * ((1.0 - z) * values[at] + z * values[at + 1])
        above += y * ((1.0 - z) * values[at + strides[1]] + z * values[at + strides[1] + 1])
        gap = (1.0 - x) * below + x * above
        is_on = ((part >= 0.0) & (part <= 1.0)).all(axis=1)
        nearest = np.minimum(np.maximum(np.rint(cells).astype(int), 0), shape - 1) @ strides
        return gap, self.slopes.reshape(-1, 3)[nearest], is_on & (gap > FAR_STEPS * self.step)


def field_of(product, vertices):
    """The `Field` around a product (gap_mm) with `vertices` (k, 3), mm."""
    low, high = vertices.min(axis=0) - MARGIN_MM, vertices.max(axis=0) + MARGIN_MM
    step = max(LEAST_STEP_MM, float(np.prod(high - low) / POINTS) ** (1.0 / 3.0))
    counts = np.ceil((high - low) / step).astype(int) + 1
    grids = [low[k] + step * np.arange(counts[k]) for k in range(3)]
    places = np.stack(np.meshgrid(*grids, indexing="ij"), axis=-1).reshape(-1, 3)
    parts = np.array_split(places, len(places) // 20_000 + 1)
    values = np.concatenate([product.gap_mm(part)["gap_mm"] for part in parts]).reshape(counts)
    slopes = np.stack(np.gradient(values, step), axis=-1)
    return Field(low, step, values, slopes / np.maximum(np.linalg.norm(slopes, axis=-1, keepdims=True), 1e-9))
