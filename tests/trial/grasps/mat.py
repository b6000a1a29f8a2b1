"""A mat around a cylinder, and what it makes of the forces on it: its own code, not the library's."""

from dataclasses import dataclass

import numpy as np

_DISC = np.array(
    [(0.0, 0.0)]
    + [
        (r * np.cos(a), r * np.sin(a))
        for r, count in ((0.45, 6), (0.8, 12))
        for a in np.arange(count) * 2 * np.pi / count
    ]
)
"""Points of a disc of radius 1 over which a vertex's force is spread."""


@dataclass(frozen=True)
class Wrapped:
    """Cells around a cylinder: `rows` along `axis` from `origin_mm`, `columns` from `seam` by the right-hand rule."""

    origin_mm: np.ndarray
    axis: np.ndarray
    seam: np.ndarray
    radius_mm: float
    rows: int
    columns: int
    pitch_mm: float

    @property
    def cell_mm2(self):
        """Area of a cell."""
        return self.pitch_mm * 2 * np.pi * self.radius_mm / self.columns

    def read(self, places_mm, forces_n, areas_mm2, shift_mm=(0.0, 0.0)):
        """Mean pressure (rows, columns), kPa, of forces at places (n, 3), shifted by `shift_mm` along and around."""
        third = np.cross(self.axis, self.seam)
        away = places_mm - self.origin_mm
        along, x, y = away @ self.axis, away @ self.seam, away @ third
        arc = np.arctan2(y, x) * self.radius_mm
        spread = np.sqrt(areas_mm2 / np.pi)[:, None] * 1.0
        along = along[:, None] + spread * _DISC[:, 0] + shift_mm[0]
        arc = arc[:, None] + spread * _DISC[:, 1] + shift_mm[1]
        row = np.floor(along / self.pitch_mm).astype(int)
        column = np.floor(arc / (2 * np.pi * self.radius_mm) * self.columns).astype(int) % self.columns
        is_on = (row >= 0) & (row < self.rows)
        force = np.broadcast_to(forces_n[:, None] / len(_DISC), row.shape)
        cells = np.bincount(row[is_on] * self.columns + column[is_on], force[is_on], minlength=self.rows * self.columns)
        return 1e3 * cells.reshape(self.rows, self.columns) / self.cell_mm2

    def cylinder(self, product_mm, sectors):
        """Points and triangles, outward, of a closed cylinder as long as the product, with so many sectors."""
        heights = (product_mm - self.origin_mm) @ self.axis
        third = np.cross(self.axis, self.seam)
        angle = 2 * np.pi * np.arange(sectors) / sectors
        ring = self.origin_mm + self.radius_mm * (np.outer(np.cos(angle), self.seam) + np.outer(np.sin(angle), third))
        ends = [self.origin_mm + height * self.axis for height in (heights.min(), heights.max())]
        points = np.concatenate([ring + heights.min() * self.axis, ring + heights.max() * self.axis, ends])
        a = np.arange(sectors)
        b = (a + 1) % sectors
        low, high = np.full(sectors, 2 * sectors), np.full(sectors, 2 * sectors + 1)
        faces = [(a, b, b + sectors), (a, b + sectors, a + sectors), (low, b, a), (high, a + sectors, b + sectors)]
        return points, np.concatenate([np.column_stack(each) for each in faces])

    def placing(self):
        """The table of `study.toml` that says how it lies."""

        def numbers(of):
            return "[" + ", ".join(f"{each:.5f}" for each in of) + "]"

        return (
            "[recordings.placing]\n"
            'on = "cylinder"\n'
            f"origin_mm = {numbers(self.origin_mm)}\naxis = {numbers(self.axis)}\nseam = {numbers(self.seam)}\n"
            f'diameter_mm = {2 * self.radius_mm:.4f}\nturn = "right"\n'
        )


def around(product_mm, places_mm, pitch_mm=5.0):
    """The mat that closes around a cylinder's mesh where it is touched at `places_mm`."""
    middle = product_mm.mean(axis=0)
    spread = product_mm - middle
    axis = np.linalg.eigh(spread.T @ spread)[1][:, -1]
    seam = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    seam /= np.linalg.norm(seam)
    # The widest part of the mesh is the cylinder's side.
    across = spread - np.outer(spread @ axis, axis)
    radius = float(np.linalg.norm(across, axis=1).max())
    heights = (places_mm - middle) @ axis
    rows = int(np.ceil((np.ptp(heights) + 4 * pitch_mm) / pitch_mm))
    origin = middle + axis * (heights.mean() - 0.5 * rows * pitch_mm)
    return Wrapped(origin, axis, seam, radius, rows, round(2 * np.pi * radius / pitch_mm), pitch_mm)


def sensor(pressure_kpa, rng, fault):
    """Frames (t, rows, columns) of true pressure as an instrument shows them. `fault` is a dictionary; see `drawn`."""
    frames, shape = pressure_kpa, pressure_kpa.shape[1:]
    frames = frames * np.exp(rng.normal(0.0, 0.04, shape)) * fault.get("gain", 1.0) * rng.normal(1.0, 0.02)
    if "part" in fault:
        first, last, factor, is_columns = fault["part"]
        band = np.zeros(shape, bool)
        band[:, first : last + 1] = is_columns
        if not is_columns:
            band[first : last + 1] = True
        frames = frames * np.where(band, factor, 1.0)
    time = fault["time_s"]
    creep = fault.get("creep", rng.uniform(-0.005, 0.01))
    frames = frames * (1.0 + creep * np.log10(1.0 + time))[:, None, None]
    white = rng.normal(0.0, rng.uniform(0.3, 0.9), frames.shape)
    slow = np.cumsum(rng.normal(0.0, 0.08, frames.shape), axis=0) - 0.04
    touched = frames > 0.3
    frames = np.where(touched, frames + white + slow, np.where(rng.random(frames.shape) < 0.02, np.abs(white), 0.0))
    frames = np.clip(frames, 0.0, fault.get("ceiling", np.inf))
    step = fault["step"]
    frames = np.round(frames / step) * step
    frames[frames < fault.get("floor", 0.0)] = 0.0
    if "dead" in fault:
        frames[:, fault["dead"]] = 0.0
    return frames
