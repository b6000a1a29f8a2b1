"""Arrays out of evaluated meshes: positions, triangles, and whether vertices are still the ones of the base mesh."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from bpy.types import Context, Depsgraph, Mesh, Modifier, Object

from .checks import Refusal
from .units import Bools, Floats, Ints

_ID = ".thenar_vertex"
_APPENDING = {"ARMATURE", "LATTICE", "CORRECTIVE_SMOOTH", "SMOOTH", "SUBSURF"}
"""Modifiers that are known to leave the vertices there are, in order, and to put new ones behind them."""


def positions(mesh: Mesh) -> Floats:
    """Vertex positions (n, 3) float32, local, Blender units."""
    out = np.empty(len(mesh.vertices) * 3, np.float32)
    attribute = mesh.attributes.get("position")
    if attribute is not None:
        attribute.data.foreach_get("vector", out)
    return out.reshape(-1, 3)


def triangles(mesh: Mesh) -> Ints:
    """Triangles (m, 3) int32 of the mesh's faces."""
    mesh.calc_loop_triangles()
    out = np.empty(len(mesh.loop_triangles) * 3, np.int32)
    mesh.loop_triangles.foreach_get("vertices", out)
    return out.reshape(-1, 3)


@contextmanager
def evaluated_mesh(obj: Object, depsgraph: Depsgraph) -> Iterator[Mesh]:
    """The mesh of `obj` with its modifiers, for as long as the block lasts.

    `to_mesh` is taken where Blender may keep the subdivision on the graphics card, and for what is not a mesh.
    """
    evaluated = obj.evaluated_get(depsgraph)
    subdivides = any(modifier.type == "SUBSURF" and modifier.show_viewport for modifier in obj.modifiers)
    if obj.type == "MESH" and not subdivides:
        yield evaluated.data
        return
    mesh = evaluated.to_mesh()
    try:
        yield mesh
    finally:
        evaluated.to_mesh_clear()


def evaluated_positions(obj: Object, depsgraph: Depsgraph, count: int) -> Floats:
    """Evaluated positions (count, 3) float64 of the base mesh's vertices, which come first (see `keeps_vertices`)."""
    with evaluated_mesh(obj, depsgraph) as mesh:
        return positions(mesh)[:count].astype(np.float64)


def keeps_vertices(context: Context, obj: Object) -> bool:
    """Whether the first vertices of the evaluated mesh are those of the base mesh, in order."""
    base = obj.data
    if all(modifier.type in _APPENDING for modifier in obj.modifiers if modifier.show_viewport):
        return True
    with evaluated_mesh(obj, context.evaluated_depsgraph_get()) as mesh:
        if is_same_topology(base, mesh):
            return True
        if len(mesh.vertices) < len(base.vertices):
            return False
    if not base.is_editable:
        return False
    return _ids_come_first(context, obj)


def require_vertices(context: Context, obj: Object) -> None:
    """Refuse a hand whose modifiers reorder or remove vertices. Raises `Refusal`."""
    if keeps_vertices(context, obj):
        return
    guilty = _changers(context, obj)
    listed = ", ".join(f"'{name}'" for name in guilty) or "a modifier"
    if len(guilty) > 1:
        raise Refusal(
            f"{listed} on '{obj.name}' change which vertices there are, so results cannot be written back; "
            "apply them or switch them off in the viewport"
        )
    raise Refusal(
        f"{listed} on '{obj.name}' changes which vertices there are, so results cannot be written back; "
        "apply it or switch it off in the viewport"
    )


def _changers(context: Context, obj: Object) -> list[str]:
    """Names of the modifiers that change which vertices there are: each by itself, or else the first after others."""
    shown = [modifier for modifier in obj.modifiers if modifier.show_viewport]

    def breaks(active: Sequence[Modifier]) -> bool:
        for modifier in shown:
            modifier.show_viewport = modifier in active
        context.view_layer.update()
        return not keeps_vertices(context, obj)

    try:
        alone = [modifier.name for modifier in shown if breaks([modifier])]
        prefixes = (shown[: count + 1] for count in range(len(shown)))
        return alone or [prefix[-1].name for prefix in prefixes if breaks(prefix)][:1]
    finally:
        for modifier in shown:
            modifier.show_viewport = True
        context.view_layer.update()


def is_used(faces: Ints, count: int) -> Bools:
    """Whether each of `count` vertices is a corner of one of the triangles `faces`."""
    used = np.zeros(count, bool)
    used[faces] = True
    return used


def is_same_topology(base: Mesh, mesh: Mesh) -> bool:
    """Whether two meshes have the same corners, so that their vertices are the same ones."""
    if len(base.vertices) != len(mesh.vertices) or len(base.loops) != len(mesh.loops):
        return False
    return np.array_equal(_corners(base), _corners(mesh))


def _corners(mesh: Mesh) -> Ints:
    out = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", out)
    return out


def _ids_come_first(context: Context, obj: Object) -> bool:
    count = len(obj.data.vertices)
    wanted = np.arange(1, count + 1, dtype=np.int32)
    obj.data.attributes.new(_ID, "INT", "POINT").data.foreach_set("value", wanted)
    try:
        obj.data.update()
        context.view_layer.update()
        with evaluated_mesh(obj, context.evaluated_depsgraph_get()) as mesh:
            attribute = mesh.attributes.get(_ID)
            if attribute is None or attribute.domain != "POINT" or len(attribute.data) < count:
                return False
            found = np.empty(len(attribute.data), np.int32)
            attribute.data.foreach_get("value", found)
            return np.array_equal(found[:count], wanted)
    finally:
        obj.data.attributes.remove(obj.data.attributes[_ID])
        context.view_layer.update()
