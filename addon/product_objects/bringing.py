"""Carries the whole product through the world, into a hand that stays: parts, their parents and children."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from typing import Any

import numpy as np
from bpy.types import Context, FCurve, Object
from mathutils import Matrix, Vector

from ..hand_bones import channels
from ..ownership import own
from ..scene.checks import Refusal

_TRIAL_TURN = 0.1
"""Turn, radians, by which the product is moved to learn whether it can be."""
_TRIAL_SHIFT = 0.1
_MISS = 2e-3
"""Shares of the product's size: how far it is moved to learn that, and how far it may be off its place."""
_PLACES = ("location", "rotation_", "scale", "delta_")


def check(context: Context, parts: Sequence[Object], stays: Sequence[Object]) -> None:
    """Refuse a product that cannot be carried without `stays`: hand and armature. Nothing stays moved."""
    middle = parts[0].matrix_world.translation
    turn = Matrix.Rotation(_TRIAL_TURN, 4, "X") @ Matrix.Rotation(_TRIAL_TURN, 4, "Z")
    shift = [_TRIAL_SHIFT * max(_size(part) for part in parts)] * 3
    trial = Matrix.Translation(shift) @ Matrix.Translation(middle) @ turn @ Matrix.Translation(-middle)
    with ExitStack() as undo:
        undo.callback(context.view_layer.update)
        bring(context, carriers(parts, stays), [(part, trial @ part.matrix_world) for part in parts], undo)


def bring(context: Context, moved: Sequence[Object], goals: Sequence[tuple[Object, Matrix]], undo: ExitStack) -> None:
    """Bring every part to its world matrix, all by one motion of the `carriers`; `undo` gets what takes it back.

    Raises `Refusal` for parts that are linked, keyed, or held by a constraint or driver.
    """
    first, goal = goals[0]
    motion = goal @ first.matrix_world.inverted()
    for obj in moved:
        _check_free(obj)
        undo.callback(_place, obj, channels.kept(obj), (obj.thenar.home[:], obj.thenar.is_moved))
    for obj, matrix in [(obj, motion @ obj.matrix_world) for obj in moved]:
        obj.matrix_world = matrix
        obj.thenar.is_moved = False  # where it is brought to is its home
    context.view_layer.update()
    for part, goal in goals:
        if _distance(part, goal) > _MISS * max(_size(part), 1e-9):
            raise Refusal(
                f"the product '{part.name}' is held by a constraint, a driver or a stretched parent and cannot come to "
                "the hand; mute or clear it, or set Moves to Hand in the redo panel (F9)"
            )


def carriers(parts: Sequence[Object], stays: Sequence[Object]) -> list[Object]:
    """The objects to move so that every part is carried once: parts that no other part carries, or an empty above them
    that carries parts alone."""
    fixed = {each for obj in stays for each in (obj, *_above(obj))}
    out: list[Object] = []
    for part in own.roots(parts):
        top = part
        while top.parent is not None and top.parent not in fixed and _groups(top.parent, parts):
            top = top.parent
        if top not in out:
            out.append(top)
    return out


def _groups(obj: Object, parts: Sequence[Object]) -> bool:
    """Whether it is an empty below which all but empties are parts, or hang on parts."""
    others = [child for child in obj.children_recursive if child.type != "EMPTY"]
    return obj.type == "EMPTY" and all(any(each in parts for each in (one, *_above(one))) for one in others)


def _above(obj: Object) -> Iterator[Object]:
    while obj.parent is not None:
        obj = obj.parent
        yield obj


def _check_free(obj: Object) -> None:
    if not obj.is_editable or obj.library is not None:
        raise Refusal(f"the product '{obj.name}' is linked and cannot come to the hand; make it local")
    if any(curve.data_path.startswith(_PLACES) and not curve.mute for curve in _curves(obj)):
        raise Refusal(
            f"the product '{obj.name}' has keyframes of its place, which would take it from the hand again; clear or "
            "mute them, or set Moves to Hand in the redo panel (F9)"
        )


def _curves(obj: Object) -> list[FCurve]:
    """F-curves of the object's own action."""
    data = obj.animation_data
    if data is None or data.action is None:
        return []
    if hasattr(data.action, "fcurves"):
        return list(data.action.fcurves)
    strips = [strip for layer in data.action.layers for strip in layer.strips]
    bags = [bag for strip in strips if (bag := strip.channelbag(data.action_slot)) is not None]
    return [curve for bag in bags for curve in bag.fcurves]


def _size(part: Object) -> float:
    return float(max(part.dimensions))


def _distance(part: Object, goal: Matrix) -> float:
    """How far a corner of the part's box is from where `goal` has it."""
    found = np.array([part.matrix_world @ Vector(corner) - goal @ Vector(corner) for corner in part.bound_box])
    return float(np.linalg.norm(found, axis=1).max())


def _place(obj: Object, values: dict[str, list[float]], home: tuple[Any, bool]) -> None:
    channels.restore(obj, values)
    obj.thenar.home, obj.thenar.is_moved = home
