"""New vertices and faces for a mesh that keeps its shape keys, attributes, materials and vertex groups' names."""

import bmesh
import numpy as np

from ..hand_look import studio


def replace(hand, surface, groups):
    """Give `hand` the `surface` (positions in Blender units, triangles) and the weights `groups`: name -> (n,).

    Attributes are zero then, shape keys undefined. Through BMesh: it is the one way that keeps the shape keys' data
    block with its animation and drivers.
    """
    positions, triangles = surface
    mesh = hand.data
    work = bmesh.new()
    try:
        work.from_mesh(mesh)
        bmesh.ops.delete(work, geom=work.verts, context="VERTS")
        vertices = [work.verts.new(place) for place in positions.tolist()]
        for a, b, c in triangles.tolist():
            work.faces.new((vertices[a], vertices[b], vertices[c])).smooth = True
        layer = work.verts.layers.deform.verify()
        for name, weights in groups.items():
            group = hand.vertex_groups.get(name)
            if group is not None:
                index, rows = group.index, np.flatnonzero(weights)
                for row, weight in zip(rows.tolist(), weights[rows].tolist(), strict=True):
                    vertices[row][layer][index] = weight
        work.to_mesh(mesh)
    finally:
        work.free()
    studio.forget_selection(mesh)
    mesh.update()
