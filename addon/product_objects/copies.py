"""Copies of product surfaces that cannot carry pressure: curves, nodes, instances, shared or linked meshes."""

import bpy
import numpy as np
from bpy.types import Collection, Context, Mesh, Object

from .. import names
from ..scene import attributes, read, units
from ..scene.units import Floats, Ints
from ..skin_display import colors, shading


def copy_name(part_name: str) -> str:
    """Name of the copy of the product part of that name; Blender may have to number it."""
    return names.suffixed(part_name, names.COPY_SUFFIX)


def find_copy(part_name: str) -> Object | None:
    """The copy of that product part, or None."""
    home = bpy.data.collections.get(names.RESULTS_COLLECTION)
    usual = bpy.data.objects.get(copy_name(part_name))
    found = [usual] if usual is not None else []
    found += home.objects if home is not None else ()
    return next((obj for obj in found if obj.thenar.copy_of == part_name), None)


def write_copy(
    context: Context,
    record: read.Part,
    reading: read.Reading,
    offset_mm: Floats,
    carried: tuple[Floats, Floats | None, Floats | None],
) -> Object:
    """Make a new mesh object that shows the part's pressure; hidden until the pressure is shown.

    `carried`: pressure (k,), MPa, distance to the edge of the contact (k,), mm, and how far its soft grip yields
    (k, 3), mm; each of the last two may be None.
    """
    pressure_mpa, edge_mm, yielded_mm = carried
    skin, product, look = reading.hand, reading.product, context.scene.thenar
    remove_copy(record.name)
    last = record.first + record.count
    places = product.vertices_mm[record.first : last] + (0.0 if yielded_mm is None else yielded_mm)
    world = (places + skin.origin_mm + offset_mm) / skin.scale
    inside = (product.triangles >= record.first).all(axis=1) & (product.triangles < last).all(axis=1)
    mesh = _mesh(copy_name(record.name), world, product.triangles[inside] - record.first)
    if not record.reason:
        _dress(mesh, bpy.data.objects[record.name])
    attributes.write(mesh, names.PRESSURE_KPA, "FLOAT", units.kpa(pressure_mpa))
    if edge_mm is not None:
        attributes.write(mesh, names.EDGE_MM, "FLOAT", edge_mm)
    if yielded_mm is not None:
        attributes.write(mesh, names.GRIP_MM, "FLOAT_VECTOR", yielded_mm)
    copy = bpy.data.objects.new(copy_name(record.name), mesh)
    tinted = colors.linear((units.kpa(pressure_mpa), edge_mm), look, colors.ground(copy, colors.BARE))
    attributes.write(mesh, names.COLOR, "FLOAT_COLOR", tinted)
    copy.thenar.copy_of = record.name
    copy.hide_viewport = copy.hide_render = True
    collection(context).objects.link(copy)
    return copy


def remove_copy(part_name: str) -> None:
    """Remove the copy of that part, if there is one, and the collection once it is empty."""
    copy = find_copy(part_name)
    if copy is None:
        return
    shading.hide(copy)
    if not copy.hide_viewport:
        swap(copy, False)
    mesh = copy.data
    bpy.data.objects.remove(copy)
    bpy.data.meshes.remove(mesh)
    home = bpy.data.collections.get(names.RESULTS_COLLECTION)
    if home is not None and not home.objects:
        bpy.data.collections.remove(home)


def swap(copy: Object, shown: bool) -> None:
    """Show the copy in place of its part, or the part again as it was."""
    copy.hide_viewport = copy.hide_render = not shown
    part = bpy.data.objects.get(copy.thenar.copy_of)
    if part is None:
        return
    if shown:
        copy.thenar.was_hidden = part.hide_get()
        part.hide_set(True)
        copy.thenar.hid_render = not part.hide_render
        part.hide_render = True
    else:
        part.hide_set(copy.thenar.was_hidden)
        if copy.thenar.hid_render:
            part.hide_render = False


def collection(context: Context) -> Collection:
    """The collection of results in the scene, made where missing."""
    home = bpy.data.collections.get(names.RESULTS_COLLECTION)
    if home is None:
        home = bpy.data.collections.new(names.RESULTS_COLLECTION)
    if home.name not in context.scene.collection.children:
        context.scene.collection.children.link(home)
    return home


def _dress(mesh: Mesh, part: Object) -> None:
    """Give the copy the part's first material, and flat faces where the part has them."""
    if part.material_slots:
        mesh.materials.append(part.material_slots[0].material)
    if len(part.data.polygons) and not part.data.polygons[0].use_smooth:
        mesh.polygons.foreach_set("use_smooth", np.zeros(len(mesh.polygons), bool))


def _mesh(name: str, positions: Floats, triangles: Ints) -> Mesh:
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(positions, np.float32).ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", np.ascontiguousarray(triangles, np.int32).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(triangles), bool))
    mesh.update(calc_edges=True)
    return mesh
