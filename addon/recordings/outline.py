"""The mat as a mesh of its sensels on the product, to see how it lies and what it reads."""

import bpy
import numpy as np

from ..scene import attributes, units
from . import comparing, frames, laying

NAME = "Thenar Mat"


def draw(context, item):
    """Make or renew the object that shows the mat of a recording. Returns it. Raises `Refusal`, `RecordingError`."""
    seat = comparing.seat_of(context)
    mat = laying.lay(laying.lie_of(item), seat)
    values, _ = frames.shown(item)
    is_placed = np.isfinite(np.asarray(mat.area_mm2))
    mesh = mesh_of(corners(mat, is_placed).reshape(-1, 3) / units.mm_per_unit(context.scene))
    attributes.write(mesh, "reading", "FLOAT", np.repeat(np.nan_to_num(values[is_placed]), 4))
    return _shown(context, mesh)


def mesh_of(corners):
    """A mesh of squares from their corners (4 n, 3), units."""
    mesh = bpy.data.meshes.new(NAME)
    mesh.from_pydata(corners.tolist(), [], np.arange(len(corners)).reshape(-1, 4).tolist())
    return mesh


def corners(mat, is_placed):
    """Corners (n, 4, 3) of every sensel, mm: squares of its area across its normal, drawn a tenth smaller."""
    center, normal = np.asarray(mat.center_mm)[is_placed], np.asarray(mat.normal)[is_placed]
    half = 0.45 * np.sqrt(np.asarray(mat.area_mm2)[is_placed])[:, None]
    row = np.asarray(mat.row)[is_placed]
    first = _towards_neighbor(center, normal, row)
    second = np.cross(normal, first)
    signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return np.stack([center + half * (a * first + b * second) for a, b in signs], axis=1)


def _towards_neighbor(center, normal, row):
    """Unit vectors (n, 3) along the rows: to the next sensel of the same row, across the normal."""
    ahead = np.roll(center, -1, axis=0) - center
    ends = np.roll(row, -1) != row
    ahead[ends] = (center - np.roll(center, 1, axis=0))[ends]
    flat = ahead - normal * np.sum(ahead * normal, axis=1, keepdims=True)
    length = np.linalg.norm(flat, axis=1, keepdims=True)
    across = np.cross(normal, np.where(np.abs(normal[:, :1]) < 0.9, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return np.where(length > 1e-9, flat / np.maximum(length, 1e-9), across)


def _shown(context, mesh):
    """The object of that name with this mesh; made if it is not there."""
    obj = bpy.data.objects.get(NAME)
    if obj is None:
        obj = bpy.data.objects.new(NAME, mesh)
    else:
        before, obj.data = obj.data, mesh
        if before.users == 0:
            bpy.data.meshes.remove(before)
    mesh.name = NAME
    if obj.name not in context.scene.collection.all_objects:
        context.scene.collection.objects.link(obj)
    obj.display_type, obj.hide_render, obj.hide_select = "WIRE", True, True
    context.view_layer.update()
    return obj
