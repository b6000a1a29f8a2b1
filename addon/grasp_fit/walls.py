"""How deep skin lies in a product, however thin its walls. Knows nothing of Blender or of the native module.

The plain distance to a wall of 2 mm is never deeper than 1 mm, and beyond it points away again. Where a product has
walls thinner than the fit reaches, distances are asked with the skin's normals: measured to the side that the skin
came from.
"""

from dataclasses import dataclass

import numpy as np

FAR_MM = 80.0
"""Gaps beyond this count as this much."""

REACH = 1.1
"""Depth to look into walls, in parts of the deepest target; walls thinner than twice as much are thin."""

THROUGH = 0.3
"""Cosine between the way in and the way out from which the latter leads through: beside an edge it is about 0."""

THIN_SHARE = 0.02
"""Share of the points of the product's surface that must stand on thin walls: fewer are a rim or a ridge."""

FACED = (0.3, 0.7)
"""Skin faces a wall in full from the second cosine on, 46 degrees, and not at all below the first, from which the other
wall is read: so that depth fades out and in, and does not jump."""

DEEPEST_MM = 15.0
"""Depth to which skin is followed through a wall, mm: the tissue of a palm."""

BONE_MM = 1.2
"""The center line of a finger this near a thin wall is about to pass through it; half the way between its points."""


@dataclass(frozen=True)
class Gauge:
    """A product's distances as the fit reads them; `is_thin`: with the skin's normals. A `field.Field` answers for
    skin that is far away, if there is one. `is_faced`: depth through thin walls counts as far as the skin faces the
    product there, so that it does not jump where the next vertex is read from the other side."""

    product: object
    is_thin: bool
    field: object = None
    is_faced: bool = False

    def gaps(self, points, normals=None):
        """Signed gaps (n,) of world points, mm, at most `FAR_MM`; `normals` (n, 3) of the skin if it is thin."""
        return self.read(points, normals)[0]

    def read(self, points, normals=None):
        """Signed gaps (n,), mm, and their gradients (n, 3): the outward direction at the nearest point, a unit vector;
        shorter where the depth counts in part."""
        if self.field is None:
            return self._exact(points, normals)
        gap, slope, is_far = self.field.read(points)
        near = np.flatnonzero(~is_far)
        gap[near], slope[near] = self._exact(points[near], None if normals is None else normals[near])
        return np.minimum(gap, FAR_MM), slope

    def _exact(self, points, normals):
        limits = {"cut_off_mm": FAR_MM}
        if self.is_thin and normals is not None:
            limits |= {"skin_normals": normals, "max_depth_mm": DEEPEST_MM}
        found = self.product.gap_mm(points, **limits)
        gap, slope = np.minimum(found["gap_mm"], FAR_MM), np.nan_to_num(found["normal"])
        if self.is_faced and "skin_normals" in limits:
            cosine = -(normals * slope).sum(axis=1)
            counts = np.clip((cosine - FACED[0]) / (FACED[1] - FACED[0]), 0.0, 1.0)
            counts[(gap >= 0.0) | ~normals.any(axis=1)] = 1.0
            gap, slope = gap * counts, slope * counts[:, None]
        return gap, slope

    def is_crossed(self, points):
        """Whether some of `points` (k, 3) on bones, at most 2 mm apart, stand in a thin wall."""
        return self.is_thin and bool(
            (np.abs(self.product.gap_mm(points, cut_off_mm=BONE_MM)["gap_mm"]) < BONE_MM).any()
        )


def gauge_of(product, points, depth_mm):
    """The `Gauge` of a product with `points` (k, 3) of its surface, world mm, into which skin is to go `depth_mm`."""
    return Gauge(product, thin_share(product, points, REACH * depth_mm) > THIN_SHARE)


def thin_share(product, points, reach_mm):
    """Share of the points where, `reach_mm` in, the way out leads to another side than the one come from."""
    inward = -np.nan_to_num(product.gap_mm(points)["normal"])
    beyond = np.nan_to_num(product.gap_mm(points + reach_mm * inward)["normal"])
    return float(((beyond * inward).sum(axis=1) > THROUGH).mean())
