"""Carries the whole product through the world, into a hand that stays: parts, their parents and children."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from typing import Any

import numpy as np
from bpy.types import Action, Context, FCurve, Object
from mathutils import Matrix

from ..hand_bones import channels
from ..ownership import own
from ..scene import mesh, units
from ..scene.checks import Refusal
from ..scene.units import Floats

_TRIAL_TURN = 0.1
"""Turn, radians, by which the product is moved to learn whether it can be."""
_TRIAL_SHIFT = 0.1
_MISS = 2e-3
"""Shares of the product's size: how far it is moved to learn that, and how far it may be off its place."""
_BARE_MM = 100.0
"""Size taken for a part without a surface of its own, as an empty that instances a collection."""
_BARE = {"EMPTY", "ARMATURE"}
_PLACES = ("location", "rotation_", "scale", "delta_")


def check(context: Context, parts: Sequence[Object], stays: Sequence[Object]) -> None:
    """Refuse a product that cannot be carried without `stays`: hand and armature. Nothing stays moved."""
    middle = parts[0].matrix_world.translation
    turn = Matrix.Rotation(_TRIAL_TURN, 4, "X") @ Matrix.Rotation(_TRIAL_TURN, 4, "Z")
    shift = [_TRIAL_SHIFT * max(_size(context, part) for part in parts)] * 3
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
    shapes = [_surface(context, part) for part, _ in goals]
    for obj in moved:
        _check_free(obj)
        undo.callback(_place, obj, channels.kept(obj), (obj.thenar.home[:], obj.thenar.is_moved))
    for obj, matrix in [(obj, motion @ obj.matrix_world) for obj in moved]:
        obj.matrix_world = matrix
        obj.thenar.is_moved = False  # where it is brought to is its home
    context.view_layer.update()
    for (part, goal), shape in zip(goals, shapes, strict=True):
        if _distance(context, part, goal, shape) > _MISS * _size(context, part):
            raise Refusal(
                f"the product '{part.name}' is held by a constraint, a driver or a stretched parent, or a modifier of "
                "it follows an object that stays, so that it cannot come to the hand; mute, clear or apply that, or "
                "set Moves to Hand under Grasp"
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
    """Whether it is an empty or an armature below which all but empties are parts, or hang on parts."""
    others = [child for child in obj.children_recursive if child.type not in _BARE]
    is_carried = [any(each in parts for each in (one, *_above(one))) for one in others]
    return obj.type in _BARE and all(is_carried)


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
            "mute them, or set Moves to Hand under Grasp"
        )


def _curves(obj: Object) -> list[FCurve]:
    """F-curves of the object's own action, and of those that its NLA plays."""
    data = obj.animation_data
    if data is None:
        return []
    strips = [strip for track in data.nla_tracks if not track.mute for strip in track.strips if not strip.mute]
    played = [(each.action, getattr(each, "action_slot", None)) for each in (data, *strips)]
    return [curve for action, slot in played if action is not None for curve in _curves_of(action, slot)]


def _curves_of(action: Action, slot: Any) -> list[FCurve]:
    if hasattr(action, "fcurves"):
        return list(action.fcurves)
    if slot is None:  # it moves nothing, and Blender 5.0 raises
        return []
    strips = [strip for layer in action.layers for strip in layer.strips]
    bags = [bag for strip in strips if (bag := strip.channelbag(slot)) is not None]
    return [curve for bag in bags for curve in bag.fcurves]


def _size(context: Context, part: Object) -> float:
    return float(max(part.dimensions)) or _BARE_MM / units.mm_per_unit(context.scene)


def _surface(context: Context, part: Object) -> Floats:
    """Local positions (n, 3) of the part's surface with its modifiers; of an empty ends of its axes."""
    if part.type == "EMPTY":
        return _size(context, part) * np.eye(4, 3)
    with mesh.evaluated_mesh(part, context.evaluated_depsgraph_get()) as shown:
        return mesh.positions(shown).astype(np.float64)


def _distance(context: Context, part: Object, goal: Matrix, shape: Floats) -> float:
    """How far a vertex of the part is from where `goal` has the one of `shape`."""
    found, here, there = _surface(context, part), np.array(part.matrix_world), np.array(goal)
    if found.shape != shape.shape:
        return float("inf")
    off = found @ here[:3, :3].T + here[:3, 3] - shape @ there[:3, :3].T - there[:3, 3]
    return float(np.linalg.norm(off, axis=1).max(initial=0.0))


def _place(obj: Object, values: dict[str, list[float]], home: tuple[Any, bool]) -> None:
    channels.restore(obj, values)
    obj.thenar.home, obj.thenar.is_moved = home
