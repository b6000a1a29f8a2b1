"""The Subdivision that ends a hand's stack: switched off while a contact is computed, and computed here instead.

Blender evaluates it once, when all is written, and what it shows is compared with what was computed. Where they differ,
Blender's own evaluation is used from then on.
"""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np
from bpy.types import Context, Mesh, Modifier, Object

from .. import cache
from ..ownership import own
from ..scene import mesh
from ..scene.checks import Refusal
from ..scene.units import Floats
from .catmull_clark import Faces, Level, Rules, level

AGREES_MM = 1e-3
"""How far a vertex may lie from where it was computed. Measured: 0.0001 mm, single precision on a hand of 200 mm."""
_SINGLE = 1e-6
"""The same as a share of the largest coordinate, where an object's origin lies far from its vertices."""
_CREASES = ("crease_edge", "crease_vert")
_refuted: set[str] = set()
"""Keys of levels that Blender showed otherwise than computed, in this session."""


class DiffersError(Refusal):
    """Blender shows a subdivided skin otherwise than computed; the next press takes what Blender shows."""


@dataclass(frozen=True)
class Last:
    """A Subdivision of one level that is switched off: the name of its modifier, its map, and the map's key."""

    name: str
    level: Level
    key: str

    def put_back(self, hand: Object) -> None:
        """Switch the Subdivision on."""
        modifier = hand.modifiers.get(self.name)
        if modifier is not None:
            modifier.show_viewport = True

    def check(self, hand: Object, shown_mm: Floats, computed_mm: Floats) -> None:
        """Refuse a level that Blender shows (m, 3) otherwise than computed (m, 3). Raises `DiffersError`."""
        allowed = max(AGREES_MM, _SINGLE * float(np.abs(shown_mm).max(initial=0.0)))
        if shown_mm.shape == computed_mm.shape and np.abs(shown_mm - computed_mm).max(initial=0.0) <= allowed:
            return
        _refuted.add(self.key)
        raise DiffersError(
            f"Blender shows the skin of '{hand.name}' behind '{self.name}' otherwise than computed; solve again: its "
            "own evaluation is used from now on, which takes longer"
        )


def take_out(context: Context, hand: Object, parts: Sequence[Object], restore: ExitStack) -> Last | None:
    """Take Thenar's own output out of the scene, and the hand's last modifier if it is a Subdivision to be computed.

    Returns that, or None; `restore` gets what puts all back.
    """
    last = _switch_off(context, hand, restore)
    own.take_out(context, hand, parts, restore)
    if last is None:
        return None
    with mesh.evaluated_mesh(hand, context.evaluated_depsgraph_get()) as cage:
        if mesh.is_same_topology(hand.data, cage) and not _is_creased(hand.modifiers[last.name], cage):
            return last
    last.put_back(hand)
    context.view_layer.update()
    return None


def _switch_off(context: Context, hand: Object, restore: ExitStack) -> Last | None:
    """The last modifier, switched off without an update, or None."""
    modifier = _candidate(context, hand)
    if modifier is None or _is_creased(modifier, hand.data):
        return None
    faces = _faces(hand.data)
    rules = Rules(modifier.use_limit_surface, modifier.boundary_smooth == "PRESERVE_CORNERS")
    key = cache.content_hash(
        faces.count, faces.corners, faces.sides, faces.starts, faces.edges, rules, modifier.quality
    )
    computed = None if key in _refuted else cache.level(key, lambda: level(faces, rules))
    if computed is None:
        return None
    last = Last(modifier.name, computed, key)
    restore.callback(context.view_layer.update)
    restore.callback(last.put_back, hand)
    modifier.show_viewport = False
    return last


def _candidate(context: Context, hand: Object) -> Modifier | None:
    """The hand's last visible modifier, if it is a Catmull-Clark Subdivision at one level."""
    visible = list(_visible(hand))
    last = visible[-1] if visible else None
    if last is None or last.type != "SUBSURF" or last.subdivision_type != "CATMULL_CLARK":
        return None
    render = context.scene.render
    levels = min(last.levels, render.simplify_subdivision) if render.use_simplify else last.levels
    return last if levels == 1 else None


def _visible(hand: Object) -> Iterator[Modifier]:
    ours = (*own.shown_modifiers(hand), *own.played_modifiers(hand))
    return (modifier for modifier in hand.modifiers if modifier.show_viewport and modifier not in ours)


def _is_creased(modifier: Modifier, surface: Mesh) -> bool:
    """Whether sharp edges or vertices change the surface."""
    return bool(modifier.use_creases) and any(_has_values(surface, name) for name in _CREASES)


def _has_values(surface: Mesh, name: str) -> bool:
    attribute = surface.attributes.get(name)
    if attribute is None:
        return False
    values = np.zeros(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", values)
    return bool(values.any())


def _faces(surface: Mesh) -> Faces:
    corners, sides = (np.empty(len(surface.loops), np.int32) for _ in range(2))
    surface.loops.foreach_get("vertex_index", corners)
    surface.loops.foreach_get("edge_index", sides)
    starts, ends = np.empty(len(surface.polygons), np.int32), np.empty(2 * len(surface.edges), np.int32)
    surface.polygons.foreach_get("loop_start", starts)
    surface.edges.foreach_get("vertices", ends)
    return Faces(len(surface.vertices), corners, sides, starts, ends.reshape(-1, 2))
