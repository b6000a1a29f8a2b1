"""The paper's contact model in dense numpy (Xie Eq. 1-14), for flat skins, where skin distance is straight.

Corrected as physics.md asks: the response is divided by G; G is held beyond d_lim. Displacement > 0 is into the skin.
"""

from dataclasses import dataclass

import numpy as np

CLAMP_MM = 0.5  # r0 of Eq. 4


@dataclass
class Tissue:
    """Moduli in MPa, lengths in mm, swelling height in mm/N (Xie Table 2)."""

    g0: float
    g_lim: float
    d_lim: float
    height: float
    radius: float
    width: float

    def shear_modulus(self, depth):
        """G(dmax), Eq. 3, held at G_lim beyond d_lim."""
        return self.g0 + (self.g_lim - self.g0) * min(depth / self.d_lim, 1.0)

    def swelling_height(self, depth):
        """a(dmax), Eq. 6."""
        return self.height * self.g0 / self.shear_modulus(depth)


def distances(vertices):
    """All straight distances (n, n)."""
    return np.linalg.norm(vertices[:, None, :] - vertices[None, :, :], axis=-1)


def boussinesq(vertices):
    """R_Bou of Eq. 10: 1 / (4 pi r), r not below r0."""
    return 1.0 / (4.0 * np.pi * np.maximum(distances(vertices), CLAMP_MM))


def gaussian(vertices, tissue):
    """R_Gau of Eq. 11: exp(-(r - b)^2 / (2 c^2))."""
    return np.exp(-((distances(vertices) - tissue.radius) ** 2) / (2.0 * tissue.width**2))


def response(vertices, gap, tissue):
    """R / G(dmax) for one region with the given gaps."""
    return boussinesq(vertices) / tissue.shear_modulus(max(-gap.min(), 0.0))


def swelling(vertices, force, gap, tissue):
    """Bulge (mm, outward > 0) that the forces raise, Eq. 5 to 8: to be added outside the pressed vertices."""
    return tissue.swelling_height(max(-gap.min(), 0.0)) * gaussian(vertices, tissue) @ force


def swelling_inside(vertices, gap, tissue):
    """Eq. 12 as a complementarity problem would need it: the Gaussian in the rows of vertices that do not collide."""
    depth = max(-gap.min(), 0.0)
    rows = (gap >= 0.0)[:, None]
    return response(vertices, gap, tissue) - tissue.swelling_height(depth) * rows * gaussian(vertices, tissue)
