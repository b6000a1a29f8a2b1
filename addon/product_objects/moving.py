"""Moves the product to where it carries its force, and home again; its own location and keys stay untouched."""

from collections.abc import Sequence
from contextlib import ExitStack

import numpy as np
from bpy.types import Context, Object
from mathutils import Vector

from ..ownership import own
from ..scene import units
from ..scene.checks import Refusal
from ..scene.units import Floats

_TRIAL = 1e-3
"""Share of the product's size, by which it is moved to learn whether it can be moved."""


def move_parts(context: Context, undo: ExitStack, parts: Sequence[Object], offset: Floats) -> None:
    """Move the product by `offset` (3), world, Blender units, from its home, and remember that home."""
    for part in own.roots(parts):
        state = part.thenar
        before, home, was_moved = part.delta_location.copy(), state.home[:], state.is_moved
        undo.callback(_place, part, before, home, was_moved)
        send_home(part)
    context.view_layer.update()
    if np.any(offset):
        for part in own.roots(parts):
            _move(context, part, offset)


def check_movable(context: Context, parts: Sequence[Object]) -> None:
    """Refuse a product that does not follow its delta location. Raises `Refusal`; nothing stays moved."""
    sizes = [max(part.dimensions) for part in parts]
    with ExitStack() as undo:
        undo.callback(context.view_layer.update)
        move_parts(context, undo, parts, np.full(3, _TRIAL * max(*sizes, 1e-6)))


def shift(part: Object, offset: Floats) -> None:
    """Set the part at its home plus `offset` (3), world, Blender units, without asking whether it follows."""
    basis = np.array(part.matrix_basis, dtype=np.float64)
    parent = (units.world_from_local(part) @ np.linalg.inv(basis))[:3, :3]
    if not part.thenar.is_moved:
        part.thenar.home = part.delta_location
        part.thenar.is_moved = True
    part.delta_location = np.array(part.thenar.home) + np.linalg.solve(parent, offset)


def send_home(part: Object) -> None:
    """Put the part back where it was before a solve moved it."""
    if part.thenar.is_moved:
        part.delta_location = part.thenar.home
        part.thenar.is_moved = False


def _move(context: Context, part: Object, offset: Floats) -> None:
    if not part.is_editable:
        raise Refusal(f"the product '{part.name}' is linked and cannot be moved to reach the force; make it local")
    before = units.world_from_local(part)[:3, 3]
    shift(part, offset)
    context.view_layer.update()
    achieved = units.world_from_local(part)[:3, 3] - before
    if np.abs(achieved - offset).max() > 1e-3 * np.abs(offset).max() + 1e-6 * np.abs(before).max():
        raise Refusal(
            f"the product '{part.name}' is held by a constraint or driver and cannot move to reach the force; "
            "mute it, or solve without a force target"
        )


def _place(part: Object, delta: Vector, home: Vector, is_moved: bool) -> None:
    part.delta_location = delta
    part.thenar.home = home
    part.thenar.is_moved = is_moved
