"""Refuses, with a sentence, every state of hand and product from which no right result can come."""

from collections.abc import Sequence
from itertools import chain
from math import hypot, isfinite
from typing import Any

import numpy as np
from bpy.types import Context, LayerCollection, Object, Scene

from .units import Floats

PRODUCT_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
_SAFE_MODES = {"OBJECT", "POSE", "WEIGHT_PAINT", "VERTEX_PAINT", "TEXTURE_PAINT"}
_FARTHEST = 1e12
HAND_MM = (2.0, 500.0)
"""Largest extent of a skin that is believed: a fingertip patch to a forearm with hand."""


class Refusal(Exception):
    """A mistake that the user can mend; the text names the object and the remedy."""


def check_hand(context: Context, hand: Object | None) -> None:
    """Refuse a hand that cannot be read and written back. Raises `Refusal`."""
    if hand is None:
        raise Refusal("no hand is chosen; pick the hand's mesh under Hand")
    if hand.type != "MESH":
        raise Refusal(f"the hand '{hand.name}' is a {hand.type.lower()}; pick a mesh object")
    _check_editable(hand)
    _check_mode(hand, "hand")
    check_visible(context, hand, "hand")
    mesh = hand.data
    if mesh.users - mesh.use_fake_user > 1:
        raise Refusal(
            f"the mesh of '{hand.name}' is shared by several objects, and one shape key cannot serve them all; "
            "use Object > Relations > Make Single User > Object & Data"
        )
    if not mesh.polygons:
        raise Refusal(f"the hand '{hand.name}' has no faces; pick a mesh with a surface")
    keys = mesh.shape_keys
    if keys is not None and not keys.use_relative:
        raise Refusal(f"the shape keys of '{hand.name}' are absolute; switch on Relative in its shape key panel")
    if keys is not None and hand.show_only_shape_key:
        raise Refusal(f"a shape key of '{hand.name}' is pinned; switch off Shape Key Lock (the pin) in its panel")
    _check_matrix(hand)


def check_product(context: Context, parts: Sequence[Object], hand: Object | None) -> None:
    """Refuse products that cannot be read; `parts` are their objects. Raises `Refusal`."""
    if not parts:
        raise Refusal("no product is chosen; pick an object under Product, or a collection of its parts")
    for part in parts:
        if part == hand:
            raise Refusal(f"'{part.name}' is both hand and product; pick two objects")
        if part.type not in PRODUCT_TYPES and part.instance_type == "NONE":
            raise Refusal(f"the product '{part.name}' is a {part.type.lower()}; pick a mesh, curve, text or metaball")
        _check_mode(part, "product")
        check_visible(context, part, "product")
        _check_matrix(part)


def check_writable(hand: Object | None) -> None:
    """Refuse a hand on which nothing can be written. Raises `Refusal`."""
    if hand is None or hand.type != "MESH":
        raise Refusal("no hand is chosen; pick the hand's mesh under Hand")
    _check_editable(hand)
    _check_mode(hand, "hand")


def check_visible(context: Context, obj: Object, role: str) -> None:
    """Refuse what the view layer does not evaluate: Blender would hand back its rest shape without a word."""
    layer = context.view_layer
    if not _holds(layer.objects, obj):
        raise Refusal(
            f"the {role} '{obj.name}' is not in the view layer '{layer.name}'; "
            "link it to the scene or tick its collection in the Outliner"
        )
    if obj.hide_viewport:
        raise Refusal(f"the {role} '{obj.name}' is disabled in viewports; switch its monitor icon on in the Outliner")
    if not _is_evaluated(layer.layer_collection, obj):
        raise Refusal(f"a collection of the {role} '{obj.name}' is disabled in viewports; enable it in the Outliner")


def check_finite(positions: Floats, name: str, what: str) -> None:
    """Refuse NaN and infinity, which Blender accepts silently; it may hold infinity as its largest number."""
    if np.vdot(positions, positions) < 0.9 * _FARTHEST**2:  # then none is farther, and Live asks every frame
        return
    bad = np.flatnonzero(~(np.abs(positions) < _FARTHEST).all(axis=1))
    if bad.size:
        raise Refusal(f"vertex {bad[0]} of the {what} '{name}' is not a number ({bad.size} in all); delete or reset it")


def check_size(positions_mm: Floats, name: str, scene: Scene) -> None:
    """Refuse a hand of impossible size and name the unit scale that would mend it."""
    extent = float(np.ptp(positions_mm, axis=0).max())
    low, high = HAND_MM
    if low <= extent <= high:
        return
    if extent == 0.0:
        raise Refusal(f"the hand '{name}' has no extent; all its vertices coincide")
    settings = scene.unit_settings
    now = 1.0 if settings.system == "NONE" else settings.scale_length
    for factor in (1e-3, 1e3, 1e-2, 1e2, 1e-1, 10.0, 0.0254, 1 / 0.0254):
        if 60.0 <= extent * factor <= 320.0:
            raise Refusal(
                f"the hand '{name}' is {_length(extent)} long; set Scene > Units > Unit Scale to {now * factor:g} "
                f"(it is {now:g}) or scale the object"
            )
    raise Refusal(f"the hand '{name}' is {_length(extent)} long, outside 2 mm to 0.5 m; scale it to its true size")


def _length(mm: float) -> str:
    return f"{mm / 1000:.4g} m" if mm > 1000 else f"{mm:.3g} mm"


def _check_editable(obj: Object) -> None:
    if obj.library is not None or not obj.is_editable:
        raise Refusal(f"'{obj.name}' is linked from a library; use Object > Relations > Make Local > Selected & Data")
    if obj.data is not None and not obj.data.is_editable:
        raise Refusal(
            f"the mesh of '{obj.name}' is linked from a library and would lose the result on reload; "
            "use Object > Relations > Make Local > Selected Objects & Data"
        )
    if obj.data is not None and obj.data.override_library is not None:
        raise Refusal(f"the mesh of '{obj.name}' is a library override; make it local first")


def _check_mode(obj: Object, role: str) -> None:
    if obj.mode not in _SAFE_MODES:
        mode = obj.mode.replace("_", " ").title()
        raise Refusal(
            f"the {role} '{obj.name}' is in {mode} Mode, where results are lost; go back to Object Mode (Tab)"
        )


def _check_matrix(obj: Object) -> None:
    """Plain numbers: of nine, numpy takes ten times as long, and Live asks every frame."""
    rows = [tuple(row) for row in obj.matrix_world]
    if not all(map(isfinite, chain(*rows))):
        raise Refusal(f"the transform of '{obj.name}' is not a number; clear its location, rotation and scale")
    a, b, c = (axis[:3] for axis in tuple(zip(*rows, strict=True))[:3])
    across = b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]
    volume = a[0] * across[0] + a[1] * across[1] + a[2] * across[2]
    if abs(volume) <= 1e-6 * hypot(*a) * hypot(*b) * hypot(*c):
        raise Refusal(f"the scale of '{obj.name}' is zero along an axis; give it a size again")


def _holds(objects: Any, obj: Object) -> bool:
    """Whether a collection holds the object; a linked one may have the name of a local one, which is found first."""
    return objects.get(obj.name) == obj or obj in objects.values()


def _is_evaluated(layer_collection: LayerCollection, obj: Object) -> bool:
    collection = layer_collection.collection
    if layer_collection.exclude or collection.hide_viewport:
        return False
    if _holds(collection.objects, obj):
        return True
    return any(_is_evaluated(child, obj) for child in layer_collection.children)
