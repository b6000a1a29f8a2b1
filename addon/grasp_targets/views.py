"""What a target looks at, as a fit reads it: forces by part of the hand, pressure around cells of a mat, skin that is
too deep. Each has a value for the forces of vertices at their places, and slopes. Knows nothing of Blender.
"""

from dataclasses import dataclass

import numpy as np

from ..grasp_fit.load import POWER

KPA = 1e3
"""kPa in a MPa."""


@dataclass(frozen=True)
class Pressed:
    """Skin that presses, as `load.Touched`, with the `force` (k,) of every vertex, N, and its `rise`, N/mm."""

    rows: np.ndarray
    points: np.ndarray
    gap: np.ndarray
    slope: np.ndarray
    outward: np.ndarray
    force: np.ndarray
    rise: np.ndarray

    @property
    def on_product(self):
        """Where the skin touches the product (k, 3), mm."""
        return self.points - np.minimum(self.gap, 0.0)[:, None] * self.outward


def pressed_of(touched, stiffness):
    """`Pressed` of `load.Touched` skin; `stiffness` (n,) of all vertices, N / mm^1.6."""
    depth, here = np.maximum(-touched.gap, 0.0), stiffness[touched.rows]
    force, rise = here * depth**POWER, here * POWER * depth ** (POWER - 1.0)
    return Pressed(touched.rows, touched.points, touched.gap, touched.slope, touched.outward, force, rise)


@dataclass(frozen=True)
class ByPart:
    """Sum of forces, N, over each of `count` parts; `part` (n,) of every vertex, -1 where none is."""

    part: np.ndarray
    count: int

    def values(self, skin):
        """Sums (count,) of `Pressed` skin."""
        part = self.part[skin.rows]
        return np.bincount(part[part >= 0], skin.force[part >= 0], self.count)

    def slopes(self, skin, moves):
        """Derivative (count, d) of the sums; `moves` (k, d, 3): how each point moves with each unknown."""
        part, growth = self.part[skin.rows], _growth(skin, moves)
        out = np.zeros((self.count, moves.shape[1]))
        np.add.at(out, part[part >= 0], growth[part >= 0])
        return out


@dataclass(frozen=True)
class ByCell:
    """Pressure, kPa, at the `centers` (c, 3) of cells, each force spread by a normal distribution of `spread_mm`."""

    centers: np.ndarray
    spread_mm: float

    def of_forces(self, places, force):
        """Pressure (c,) of forces (k,), N, at places (k, 3)."""
        return self._kernel(places) @ force

    def values(self, skin):
        """Pressure (c,) of `Pressed` skin."""
        is_pressing = skin.force > 0.0
        return self.of_forces(skin.on_product[is_pressing], skin.force[is_pressing])

    def slopes(self, skin, moves):
        """Derivative (c, d) of the pressures."""
        places = skin.on_product
        kernel = self._kernel(places)
        along = moves - np.einsum("kdi,ki->kd", moves, skin.outward)[:, :, None] * skin.outward[:, None]
        carried = (skin.force[:, None, None] * along) / self.spread_mm**2
        out = kernel @ (_growth(skin, moves) - np.einsum("kdi,ki->kd", carried, places))
        for axis in range(3):
            out += self.centers[:, axis, None] * (kernel @ carried[:, :, axis])
        return out

    def _kernel(self, places):
        square = (self.centers**2).sum(axis=1)[:, None] + (places**2).sum(axis=1) - 2.0 * self.centers @ places.T
        two = 2.0 * self.spread_mm**2
        return KPA / (np.pi * two) * np.exp(-np.maximum(square, 0.0) / two)


@dataclass(frozen=True)
class TooDeep:
    """How far skin of each of `count` parts is deeper than its `limit` (n,), mm: root of the sum of squares."""

    part: np.ndarray
    limit: np.ndarray
    count: int

    def values(self, skin):
        """Millimetres (count,) of `Pressed` skin."""
        return np.sqrt(self._squares(skin))

    def slopes(self, skin, moves):
        """Derivative (count, d) of the same."""
        part, size = self.part[skin.rows], np.maximum(np.sqrt(self._squares(skin)), 1e-9)
        is_deep = self._excess(skin) > 0.0
        share = self._excess(skin)[is_deep] / size[part[is_deep]]
        deeper = -np.einsum("kdi,ki->kd", moves[is_deep], skin.slope[is_deep])
        out = np.zeros((self.count, moves.shape[1]))
        np.add.at(out, part[is_deep], share[:, None] * deeper)
        return out

    def _excess(self, skin):
        part = self.part[skin.rows]
        return np.where(part >= 0, np.maximum(-skin.gap - self.limit[skin.rows], 0.0), 0.0)

    def _squares(self, skin):
        part = self.part[skin.rows]
        return np.bincount(part[part >= 0], self._excess(skin)[part >= 0] ** 2, self.count)


@dataclass(frozen=True)
class Watched:
    """Rows that a view adds to a fit: (value + offset - wanted) times weight, mm. `offset`: what the contact model
    said where the fit begins, less what the view said there."""

    view: object
    wanted: np.ndarray
    offset: np.ndarray
    weight: np.ndarray


@dataclass(frozen=True)
class Load:
    """Stands for a `load.Load` in a fit: the rows of `watched`, then those of `balance`, a `load.Load`."""

    balance: object
    watched: tuple

    @property
    def stiffness(self):
        """As the `load.Load` has it."""
        return self.balance.stiffness

    def residuals(self, skin):
        """All rows, mm, of `load.Touched` skin."""
        pressed = pressed_of(skin, self.stiffness)
        rows = [each.weight * (each.view.values(pressed) + each.offset - each.wanted) for each in self.watched]
        return np.concatenate([*rows, self.balance.residuals(skin)])

    def slopes(self, skin, moves, turning):
        """Their derivative (rows, d), as `load.Load.slopes`."""
        pressed = pressed_of(skin, self.stiffness)
        rows = [each.weight[:, None] * each.view.slopes(pressed, moves) for each in self.watched]
        return np.vstack([*rows, self.balance.slopes(skin, moves, turning)])


def _growth(skin, moves):
    """How the force of every vertex grows with every unknown (k, d), N."""
    return -skin.rise[:, None] * np.einsum("kdi,ki->kd", moves, skin.slope)
