"""Fingertips of the tables of finite elements: force, contact area and pressure on a tool's face by its depth.

Tables: `tips.npz`, made by `tips_by_finite_elements.py`. A `Tip` is one of them, larger by a drawn size, of a drawn
modulus, mirrored. Units: mm, N, kPa.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.polynomial import Polynomial
from scipy.interpolate import PchipInterpolator

# Read at once: workers that are forked would share the place in an open file.
TIPS = dict(np.load(Path(__file__).with_name("tips.npz")))
PADS = {"slim": ((11.5, 8.0, 10.0), 6.8), "wide": ((13.5, 9.5, 10.5), 6.2)}  # semi-axes, tissue under the apex
SPOTS = {"spot_a": (2.6, 0.0, 0.0), "spot_b": (0.0, 2.2, 1.0)}  # along, across, b
CELL_MM, TABLE_MODULUS_MPA, RADIUS_MM, DEEPEST_MM = 0.5, 0.01, 24.0, 3.25
SMOOTH = 4


@dataclass(frozen=True)
class Tip:
    """A tip of the tables: larger by `size`, of tissue with that modulus (MPa), mirrored along and across."""

    name: str
    variant: str
    stiffening: float
    size: float
    modulus_mpa: float
    mirror: tuple

    @property
    def semi_axes_mm(self):
        """Of the skin: along the finger, across it, down to the apex."""
        return self.size * np.array(PADS[self.name][0])

    @property
    def thickness_mm(self):
        """Of the tissue under the apex."""
        return self.size * PADS[self.name][1]

    @property
    def spot_mm(self):
        """Place of the stiff spot along and across; None without one."""
        return self.size * np.array(SPOTS[self.variant][:2]) * self.mirror if self.variant in SPOTS else None

    def _of(self, tool):
        key = f"{self.name}/{self.variant}/{tool}/{self.stiffening:g}"
        return TIPS[key].astype(float), TIPS[key + "/map"].astype(float)

    def force_n(self, tool, depth_mm):
        """Elastic force at depths; 0 above the skin."""
        depth, force = self._of(tool)[0][:, :2].T
        curve = Polynomial.fit(depth, np.log(force / depth**1.5), SMOOTH, w=depth)
        x = np.maximum(np.asarray(depth_mm, dtype=float) / self.size, 0.0)
        inside = np.clip(x, depth[0], depth[-1])
        found = curve(inside) + np.minimum(x - inside, 0.0) * curve.deriv()(depth[0])
        return self.size**2 * self.modulus_mpa / TABLE_MODULUS_MPA * x**1.5 * np.exp(found)

    def area_mm2(self, tool, depth_mm):
        """Contact area at depths; 0 above the skin."""
        rows = self._of(tool)[0]
        curve = PchipInterpolator(np.append(0.0, rows[:, 0]), np.append(0.0, rows[:, 2]))
        return self.size**2 * curve(np.clip(np.asarray(depth_mm) / self.size, 0.0, rows[-1, 0]))

    def image_kpa(self, tool, depth_mm, force_n):
        """Pressure in cells of `size` times `CELL_MM` at a depth, as large as that force makes it."""
        rows, maps = self._of(tool)
        x = np.clip(depth_mm / self.size, rows[0, 0], rows[-1, 0])
        k = int(np.clip(np.searchsorted(rows[:, 0], x) - 1, 0, len(rows) - 2))
        part = (x - rows[k, 0]) / (rows[k + 1, 0] - rows[k, 0])
        image = (1.0 - part) * maps[k] + part * maps[k + 1]
        image = image[:: self.mirror[0], :: self.mirror[1]]
        return 1000.0 * force_n * image / (image.sum() * (self.size * CELL_MM) ** 2)
