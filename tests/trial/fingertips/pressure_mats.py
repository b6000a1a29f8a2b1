"""Mats between skin and tool: sensels on the tool's face, what they read of a pressure image, and their faults.

    Mat(pitch_mm, count, offset_mm).cells(image, cell_mm, shift_mm) -> mean pressure by (row, col)

Rows go along the finger, columns across it, from +y to -y. The image is pressure in square cells of the tool's face,
with its middle in the middle of the tool; the mat lies `offset_mm` off where its sensels are stated. Units: mm, kPa.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import RegularGridInterpolator


@dataclass(frozen=True)
class Mat:
    """A grid of square sensels, where it truly lies off its stated place, and its faults."""

    pitch_mm: float
    count: tuple
    offset_mm: tuple = (0.0, 0.0)
    gain: np.ndarray = field(default=1.0)
    dead: tuple = ()
    ceiling_kpa: float = np.inf

    def stated(self):
        """Middles (rows, cols, 2) along and across on the unrolled face."""
        rows, cols = self.count
        along = (np.arange(rows) - 0.5 * (rows - 1)) * self.pitch_mm
        across = (0.5 * (cols - 1) - np.arange(cols)) * self.pitch_mm
        return np.stack(np.meshgrid(along, across, indexing="ij"), axis=-1)

    def cells(self, image, cell_mm, shift_mm=0.0):
        """Mean pressure over each sensel of an image that is shifted along the finger."""
        edges = [(np.arange(n + 1) - 0.5 * n) * cell_mm for n in image.shape]
        load = np.zeros((image.shape[0] + 1, image.shape[1] + 1))
        load[1:, 1:] = np.cumsum(np.cumsum(image, axis=0), axis=1) * cell_mm**2
        total = RegularGridInterpolator(edges, load)
        middle = self.stated() + np.array(self.offset_mm) - [shift_mm, 0.0]

        def upto(x, y):
            ends = [np.clip(each, edge[0], edge[-1]) for each, edge in zip((x, y), edges, strict=True)]
            return total(np.stack(ends, axis=-1))

        half = 0.5 * self.pitch_mm
        (left, right), (low, high) = ((middle[..., k] - half, middle[..., k] + half) for k in (0, 1))
        inside = upto(right, high) - upto(left, high) - upto(right, low) + upto(left, low)
        return inside / self.pitch_mm**2

    def read(self, pressure, noise, random):
        """Readings of true mean pressures; `noise`: (share, kPa, kPa below which a sensel reads 0)."""
        share, even, floor = noise
        draw = random.standard_normal
        read = self.gain * pressure * (1.0 + share * draw(pressure.shape)) + even * draw(pressure.shape)
        read = np.minimum(np.where(read < floor, 0.0, read), self.ceiling_kpa)
        for row, col in self.dead:
            read[row, col] = 0.0
        return read
