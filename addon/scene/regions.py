"""Regions of the skin from vertex groups, without a loop over vertices."""

from collections.abc import Iterable, Sequence

import bpy
import numpy as np
from bpy.types import Context, Mesh, NodeSocket, NodeTree, Object, VertexGroup

from .. import names
from . import attributes
from .units import Bools, Floats, Ints

_WEIGHT = ".thenar_weight_"
LEAST_WEIGHT = 1e-4
"""A vertex belongs to a region from this weight on; Blender's brushes leave smaller remains."""


def vertex_regions(context: Context, hand: Object, group_names: Sequence[str]) -> Ints:
    """Region per vertex (n,) int32: the listed group with the largest weight there, -1 for none.

    With no names the whole mesh is one region, 0.
    """
    count = len(hand.data.vertices)
    if not group_names:
        return np.zeros(count, np.int32)
    weights = group_weights(context, hand, group_names)
    regions: Ints = weights.argmax(axis=0).astype(np.int32)
    regions[weights.max(axis=0) < LEAST_WEIGHT] = -1
    return regions


def region_vertices(mesh: Mesh, region: int) -> Ints:
    """Numbers of the vertices that the last result counted to `region`. Not in Edit Mode, which hides attributes."""
    return np.flatnonzero(attributes.read(mesh, names.REGION) == region)


def select_only(mesh: Mesh, vertices: Ints | Bools) -> None:
    """Select vertices, given as numbers or as a mask, and nothing else."""
    chosen = np.zeros(len(mesh.vertices), bool)
    chosen[vertices] = True
    mesh.vertices.foreach_set("select", chosen)
    for name in (".select_edge", ".select_poly"):
        # Not by `edges.foreach_set`: it crashes on a mesh that was never in Edit Mode (Blender 5.0).
        layer = mesh.attributes.get(name)
        if layer is not None:
            layer.data.foreach_set("value", [False] * len(layer.data))


def group_weights(context: Context, hand: Object, group_names: Sequence[str]) -> Floats:
    """Weights (k, n) float32 of vertex groups; a group that does not exist weighs nothing.

    Vertex groups have no array access in Python, but Geometry Nodes read them as attributes: a passing object
    that shares the mesh carries the nodes, so that the hand itself is not touched.
    """
    tree = _reader(group_names)
    carrier = bpy.data.objects.new(_WEIGHT, hand.data)
    try:
        context.scene.collection.objects.link(carrier)
        carrier.modifiers.new(_WEIGHT, "NODES").node_group = tree
        context.view_layer.update()
        mesh = carrier.evaluated_get(context.evaluated_depsgraph_get()).data
        out = np.zeros((len(group_names), len(hand.data.vertices)), np.float32)
        for row, _ in enumerate(group_names):
            mesh.attributes[f"{_WEIGHT}{row}"].data.foreach_get("value", out[row])
        return out
    finally:
        bpy.data.objects.remove(carrier)
        bpy.data.node_groups.remove(tree)


def painted_weights(hand: Object, group_name: str) -> Floats:
    """Weights (n,) float32 of one vertex group, 0 for vertices outside, read without touching the scene.

    A loop over vertices, 25 ms for 10,000: for digests that must not set off another change; `group_weights` is faster.
    """
    index = hand.vertex_groups[group_name].index
    weights = np.zeros(len(hand.data.vertices), np.float32)
    for vertex in hand.data.vertices:
        for element in vertex.groups:
            if element.group == index:
                weights[vertex.index] = element.weight
    return weights


def paint(hand: Object, group_name: str, weights: Floats) -> VertexGroup:
    """Make the vertex group of that name anew with `weights` (n,), vertices of weight 0 left out; it becomes active."""
    old = hand.vertex_groups.get(group_name)
    if old is not None:
        hand.vertex_groups.remove(old)
    group = hand.vertex_groups.new(name=group_name)
    for value in np.unique(weights[weights > 0.0]):
        group.add(np.flatnonzero(weights == value).tolist(), float(value), "REPLACE")
    hand.vertex_groups.active_index = group.index
    return group


def _reader(group_names: Sequence[str]) -> NodeTree:
    tree = bpy.data.node_groups.new(_WEIGHT, "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    last = tree.nodes.new("NodeGroupInput").outputs[0]
    for row, name in enumerate(group_names):
        read = tree.nodes.new("GeometryNodeInputNamedAttribute")
        read.data_type = "FLOAT"
        read.inputs["Name"].default_value = name
        store = tree.nodes.new("GeometryNodeStoreNamedAttribute")
        store.data_type = "FLOAT"
        store.domain = "POINT"
        store.inputs["Name"].default_value = f"{_WEIGHT}{row}"
        tree.links.new(last, store.inputs["Geometry"])
        tree.links.new(_enabled(read.outputs, "Attribute"), _enabled(store.inputs, "Value"))
        last = store.outputs[0]
    tree.links.new(last, tree.nodes.new("NodeGroupOutput").inputs[0])
    return tree


def _enabled(sockets: Iterable[NodeSocket], name: str) -> NodeSocket:
    return next(socket for socket in sockets if socket.name == name and socket.enabled)
