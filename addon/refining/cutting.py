"""Carries a plan out on the hand's mesh, through BMesh: it takes weights, shape keys, attributes and UVs along."""

import bmesh
import numpy as np

from ..scene.regions import LEAST_WEIGHT

HALF = 0.5
_WHOLE = {
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, bool),
    "INT16_2D": ("value", 2, np.int32),
    "INT32_2D": ("value", 2, np.int32),
    "QUATERNION": ("value", 4, np.float32),
}
"""Types of attributes of which a mean says nothing: property, numbers each, and type in NumPy."""


def cut(hand, levels, names):
    """Halve edges and cut faces of the hand's mesh as the `planning.Level`s say; old vertices keep their numbers.

    `names`: of the vertex groups that are regions, which a vertex between two regions gets from the end that it takes
    after, and of those that bones move, whose sum stays as it is.
    """
    mesh, (listed, deforming) = hand.data, names
    groups = [hand.vertex_groups[name].index for name in listed if name in hand.vertex_groups]
    moving = {hand.vertex_groups[name].index for name in deforming if name in hand.vertex_groups}
    whole = {attribute.name: _read(attribute) for attribute in _of_points(mesh)}
    work = bmesh.new()
    try:
        work.from_mesh(mesh)
        deform = work.verts.layers.deform.active
        for level in levels:
            _carry_out(work, level)
            if deform is not None and groups:
                _sort_into_regions(work, level, deform, (groups, moving))
        work.to_mesh(mesh)
    finally:
        work.free()
    for attribute in _of_points(mesh):
        values = whole[attribute.name]
        for level in levels:
            values = np.concatenate([values, values[level.ends]])
        attribute.data.foreach_set(_WHOLE[attribute.data_type][0], values.ravel())
    mesh.update()


def _of_points(mesh):
    """The user's attributes of points that are whole numbers or turns."""
    return [
        attribute
        for attribute in mesh.attributes
        if attribute.domain == "POINT" and attribute.data_type in _WHOLE and not attribute.name.startswith(".select")
    ]


def _read(attribute):
    field, width, kind = _WHOLE[attribute.data_type]
    out = np.empty(width * len(attribute.data), kind)
    attribute.data.foreach_get(field, out)
    return out.reshape(-1, width)


def _carry_out(work, level):
    work.verts.ensure_lookup_table()
    vertices, count, layers = list(work.verts), len(work.verts), work.loops.layers
    whole = [layer for kind in (layers.int, layers.bool, layers.string) for layer in kind.values()]
    for one, other in level.first.tolist():
        _join(vertices[one], vertices[other])
    for (one, other), end in zip(level.parents.tolist(), level.ends.tolist(), strict=True):
        edge = work.edges.get((vertices[one], vertices[other]))
        vertices.append(bmesh.utils.edge_split(edge, vertices[end], HALF)[1])
        for loop in vertices[-1].link_loops if whole else ():
            before, after = loop.link_loop_prev, loop.link_loop_next
            for layer in whole:
                loop[layer] = (before if before.vert == vertices[end] else after)[layer]
    work.verts.index_update()
    assert vertices[-1].index == count + len(level.parents) - 1, "new vertices are numbered on"
    for one, other in level.cuts.tolist():
        _join(vertices[one], vertices[other])


def _join(one, other):
    """Cut the face that has both vertices and no edge between them yet."""
    for face in one.link_faces:
        if other in face.verts:
            loop = _corner(face, one)
            if other not in (loop.link_loop_next.vert, loop.link_loop_prev.vert):
                bmesh.utils.face_split(face, one, other)
                return
    raise AssertionError(f"no face joins vertices {one.index} and {other.index}")


def _corner(face, vertex):
    """The loop of a face, a triangle or little more, at one of its vertices."""
    corners = tuple(face.loops)
    return corners[[corner.vert for corner in corners].index(vertex)]


def _sort_into_regions(work, level, deform, groups):
    """Give new vertices whose ends differ in region the groups of the end that they take after."""
    work.verts.ensure_lookup_table()
    listed, moving = groups
    first = len(work.verts) - len(level.parents)
    for row, (pair, end) in enumerate(zip(level.parents.tolist(), level.ends.tolist(), strict=True)):
        weights, wanted = work.verts[first + row][deform], work.verts[end][deform]
        other = work.verts[pair[0] if pair[1] == end else pair[1]][deform]
        region = _region(wanted, listed)
        if region == _region(other, listed):
            continue
        if moving.isdisjoint(listed):
            for group in listed:
                if group in weights:
                    del weights[group]
                if group in wanted:
                    weights[group] = wanted[group]
        elif region is not None and _region(weights, listed) != region:
            largest = _region(weights, listed)
            weights[region], weights[largest] = weights[largest], weights.get(region, 0.0)


def _region(weights, listed):
    """The listed group with the largest weight, the first of equal ones; None where there is none."""
    found = np.array([weights.get(group, 0.0) for group in listed])
    return None if found.max() < LEAST_WEIGHT else listed[int(found.argmax())]
