"""Takes Thenar's own earlier output out of a scene while it is read, and puts it back."""

from collections.abc import Container, Iterator, Sequence
from contextlib import ExitStack, contextmanager

import bpy
from bpy.types import Context, Depsgraph, Modifier, Object, ShapeKey

from .. import names
from . import owned


def contact_key(obj: Object) -> ShapeKey | None:
    """The contact's shape key of a hand, or None."""
    keys = obj.data.shape_keys if obj.type == "MESH" else None
    return keys.key_blocks.get(names.SHAPE_KEY) if keys is not None and owned.is_own_key(obj.data) else None


def bake_modifiers(obj: Object) -> list[Modifier]:
    """The modifiers that play a bake on this hand."""
    return [modifier for modifier in obj.modifiers if modifier.name.startswith(names.BAKE_MODIFIER)]


BAKE_CURVES = {"force_n": "force_n", "area_mm2": "area_mm2", "frame_peak_kpa": "peak_kpa"}
"""Properties of `hand.thenar.bake` that are keyed in every frame of the take that plays, and their columns."""


def remove_bake_curves(obj: Object) -> None:
    """Take the F-curves of a bake's numbers off the hand, and its action where it holds nothing else."""
    data = obj.animation_data
    if data is None or data.action is None:
        return
    action = data.action
    if hasattr(action, "fcurves"):
        bags = [action]
    else:  # Blender 5.0: curves stand in the layers of an action
        strips = [strip for layer in action.layers for strip in layer.strips]
        bags = [bag for strip in strips if (bag := strip.channelbag(data.action_slot)) is not None]
    for bag in bags:
        for curve in list(bag.fcurves):
            if curve.data_path in {f"thenar.bake.{name}" for name in BAKE_CURVES}:
                bag.fcurves.remove(curve)
    if not any(len(bag.fcurves) for bag in bags) and action.users == 1 and action.library is None:
        data.action = None
        bpy.data.actions.remove(action)
        obj.animation_data_clear()


def live_modifier(obj: Object) -> Modifier | None:
    """The modifier that shows a live contact on this hand, or None."""
    return next((modifier for modifier in obj.modifiers if modifier.name == names.LIVE_MODIFIER), None)


def played_modifiers(obj: Object) -> list[Modifier]:
    """All modifiers of Thenar's on this hand."""
    live = live_modifier(obj)
    return [*bake_modifiers(obj), *([live] if live is not None else [])]


def roots(parts: Sequence[Object]) -> list[Object]:
    """Those of `parts` that no other part carries along as a parent."""
    chosen = set(parts)
    return [part for part in parts if not any(parent in chosen for parent in _parents(part))]


def shown_modifiers(obj: Object) -> list[Modifier]:
    """The modifiers that bring the shown surface to the contact, as far as its key does not."""
    return [modifier for modifier in obj.modifiers if modifier.name.startswith(names.SHOWN_MODIFIER)]


@contextmanager
def without_own_output(context: Context, hand: Object, parts: Sequence[Object]) -> Iterator[Depsgraph]:
    """The scene as if Thenar had never run; yields the evaluated depsgraph, and restores on leaving."""
    with ExitStack() as restore:
        take_out(context, hand, parts, restore)
        yield context.evaluated_depsgraph_get()


def take_out(context: Context, hand: Object, parts: Sequence[Object], restore: ExitStack) -> None:
    """Take Thenar's own output out of the scene; the stack `restore` gets what puts it back."""
    restore.callback(context.view_layer.update)
    key = contact_key(hand)
    if key is not None and not key.mute:
        restore.callback(setattr, key, "mute", False)
        key.mute = True
    for modifier in (*played_modifiers(hand), *shown_modifiers(hand)):
        if modifier.show_viewport:  # setting it again, even to the same value, makes Blender evaluate the hand
            restore.callback(setattr, modifier, "show_viewport", True)
            modifier.show_viewport = False
    for part in parts:
        if part.thenar.is_moved:
            restore.callback(setattr, part, "delta_location", part.delta_location.copy())
            part.delta_location = part.thenar.home
    context.view_layer.update()


@contextmanager
def without_types(hand: Object, types: Container[str]) -> Iterator[None]:
    """The hand without its modifiers of these types."""
    shown = [modifier for modifier in hand.modifiers if modifier.type in types and modifier.show_viewport]
    for modifier in shown:
        modifier.show_viewport = False
    try:
        yield
    finally:
        for modifier in shown:
            modifier.show_viewport = True


@contextmanager
def without_generators(hand: Object, first: int) -> Iterator[None]:
    """The hand without its modifiers from index `first` on, Thenar's own not counted."""
    others = [modifier for modifier in hand.modifiers if not modifier.name.startswith(names.BAKE_MODIFIER)]
    shown = [modifier for modifier in others[first:] if modifier.show_viewport]
    for modifier in shown:
        modifier.show_viewport = False
    try:
        yield
    finally:
        for modifier in shown:
            modifier.show_viewport = True


def _parents(obj: Object) -> Iterator[Object]:
    parent = obj.parent
    while parent is not None:
        yield parent
        parent = parent.parent
