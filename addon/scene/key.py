"""The contact's shape key: the rest-space offsets that give a wanted displacement under any modifier stack.

Finite differences through Blender's own evaluation give each vertex's 3 x 3 Jacobian; residual corrections do
the rest. A key written without this is up to twice the displacement off under a bent armature.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from bpy.types import Context, Object, ShapeKey

from .. import names
from ..ownership import owned
from ..ownership.own import contact_key
from ..steps import PAUSE, Steps
from . import mesh
from .units import Bools, Floats

Moved: TypeAlias = Callable[[Floats | float], Floats]
"""Where the evaluated vertices are (n, 3) once the key has these offsets."""

CORRECTIONS = 12
"""Most corrections; nine usual stacks need at most three. What a key cannot reach is left to `correction`."""
SLOW = 0.8
"""A correction that leaves more than this share of the error is the last."""
TOLERANCE = 5e-4
"""Error over the largest displacement at which corrections stop."""
WORST_CONDITION = 1e4
"""Jacobians beyond this condition number (bones scaled to zero, collapsed lattices) are left alone."""


@dataclass(frozen=True)
class KeyReport:
    """What the key achieves: largest error, Blender units, as measured; corrections; vertices that cannot follow."""

    error: float
    corrections: int
    unsolvable: int


def ensure_key(hand: Object) -> ShapeKey:
    """The contact's key, made with value 1 where missing, unmuted; the user's active key stays active."""
    keys = hand.data.shape_keys
    index = hand.active_shape_key_index
    if keys is None:
        hand.shape_key_add(name="Basis", from_mix=False)
    key = contact_key(hand)
    if key is None:
        key = hand.shape_key_add(name=names.SHAPE_KEY, from_mix=False)
        owned.mark(hand.data, names.SHAPE_KEY)
        hand.active_shape_key_index = index
    key.relative_key = hand.data.shape_keys.reference_key
    key.value = 1.0
    key.mute = False
    return key


def remove_key(hand: Object) -> None:
    """Remove the contact's key, and the basis where nothing else needs it; the user's active key stays active."""
    key = contact_key(hand)
    if key is None:
        return
    active = hand.active_shape_key
    name = active.name if active is not None else ""
    hand.shape_key_remove(key)
    owned.unmark(hand.data, names.SHAPE_KEY)
    blocks = hand.data.shape_keys.key_blocks
    if len(blocks) == 1 and hand.thenar.made_basis:
        hand.shape_key_remove(blocks[0])
        hand.thenar.made_basis = False
    elif name in blocks:
        hand.active_shape_key_index = blocks.find(name)


def key_points(key: ShapeKey) -> Floats:
    """The key's positions (n, 3) float64, local, Blender units."""
    out = np.empty(len(key.points) * 3, np.float32)
    key.points.foreach_get("co", out)
    return out.reshape(-1, 3).astype(np.float64)


def put_points(hand: Object, key: ShapeKey, points: Floats) -> None:
    """Write the key's positions (n, 3), local, Blender units."""
    key.points.foreach_set("co", points.astype(np.float32).ravel())
    hand.data.update()


def fit_steps(context: Context, hand: Object, key: ShapeKey, wanted: Floats) -> Steps[KeyReport]:
    """Write the key so that the evaluated mesh moves by `wanted` (n, 3), object space, Blender units.

    Steps as in `addon/steps.py` that return a `KeyReport`. The key's value is respected. Nothing else may deform the
    hand by this key's own output.
    """
    base = key_points(hand.data.shape_keys.reference_key)
    count, largest = len(base), float(np.abs(wanted).max(initial=0.0))

    def moved(offsets: Floats | float) -> Floats:
        put_points(hand, key, base + offsets)
        context.view_layer.update()
        return mesh.evaluated_positions(hand, context.evaluated_depsgraph_get(), count)

    start = moved(0.0)
    if largest == 0.0:
        return KeyReport(0.0, 0, 0)
    active = np.abs(wanted).max(axis=1) > 1e-6 * largest
    fit = _Fit(moved, start, wanted, active, largest)
    yield PAUSE
    offsets, error, corrections = yield from fit.correct(wanted.copy(), np.eye(3)[None].repeat(active.sum(), 0), 0)
    solvable = np.ones(int(active.sum()), bool)
    if error > TOLERANCE:
        jacobian, solvable = yield from _jacobian(moved, base, active)
        seed = np.zeros_like(base)
        offsets, error, corrections = yield from fit.correct(seed, jacobian, CORRECTIONS, solvable)
    put_points(hand, key, base + offsets)
    context.view_layer.update()
    return KeyReport(error * largest, corrections, int((~solvable).sum()))


def _jacobian(moved: Moved, base: Floats, active: Bools) -> Steps[tuple[Floats, Bools]]:
    step = 1e-3 * float(np.ptp(base, axis=0).max())
    jacobian = np.empty((int(active.sum()), 3, 3))
    for axis in range(3):
        shift = np.zeros(3)
        shift[axis] = step
        ahead = moved(shift)[active]
        yield PAUSE
        jacobian[:, :, axis] = (ahead - moved(-shift)[active]) / (2.0 * step)
        yield PAUSE
    solvable = np.isfinite(jacobian).all(axis=(1, 2))
    solvable[solvable] = np.linalg.cond(jacobian[solvable]) < WORST_CONDITION
    return jacobian, solvable


@dataclass(frozen=True)
class _Fit:
    """The best offsets so far and their error, over residual corrections."""

    moved: Moved
    start: Floats
    wanted: Floats
    active: Bools
    largest: float

    def correct(
        self, offsets: Floats, jacobian: Floats, corrections: int, solvable: Any = slice(None)
    ) -> Steps[tuple[Floats, float, int]]:
        """Offsets (n, 3), relative error and corrections used, from `offsets` on."""
        best, before = (offsets, np.inf, 0), np.inf
        rows = np.flatnonzero(self.active)[solvable]
        for step in range(corrections + 1):
            residual = self.wanted - (self.moved(offsets) - self.start)
            error = float(np.abs(residual).max()) / self.largest
            if step == 0 or error < best[1]:
                best = (offsets.copy(), error, step)
            yield PAUSE
            if error < TOLERANCE or step == corrections or error > SLOW * before:
                break
            before = error
            offsets[rows] += np.linalg.solve(jacobian[solvable], residual[rows][..., None])[..., 0]
        return best
