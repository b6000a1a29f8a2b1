"""The modifier that stands last in the hand's stack and adds what the contact's key could not bring to the surface.

Its offsets are those of every evaluated vertex, held by the vertices of a mesh that no scene shows, while the evaluated
hand has as many vertices as when they were found. Else, as in a render at another level of Subdivision, they are an
attribute of the hand's own vertices, which Blender carries to all others.
"""

from collections.abc import Iterable
from contextlib import ExitStack

import bpy
import numpy as np
from bpy.types import Modifier, NodeSocket, NodeTree, Object

from .. import names
from ..ownership import own
from . import attributes
from .units import Floats


def attach(hand: Object, offsets: Floats, undo: ExitStack) -> Modifier:
    """Have the modifier move the evaluated vertices by `offsets` (m, 3), local, Blender units. Returns it.

    The hand's own vertices come first. `undo` (an `ExitStack`) gets what takes it back. A modifier that is there is
    used again, so that the hand is evaluated once less.
    """
    count = len(hand.data.vertices)
    attributes.write(hand.data, names.SHOWN_OFFSET, "FLOAT_VECTOR", offsets[:count])
    modifier = next(iter(own.shown_modifiers(hand)), None)
    if modifier is None or modifier.node_group is None:
        modifier = hand.modifiers.new(names.SHOWN_MODIFIER, "NODES")
        modifier.node_group, modifier.show_expanded = _tree(), False
        undo.callback(detach, hand, modifier)
    if modifier.node_group.users > 1:  # the hand was duplicated
        modifier.node_group = modifier.node_group.copy()
    socket = modifier.node_group.nodes["Carrier"].inputs["Object"]
    undo.callback(tidy)
    undo.callback(setattr, socket, "default_value", socket.default_value)
    socket.default_value = _carrier(offsets) if len(offsets) > count else None
    modifier.show_viewport = True
    hand.modifiers.move(hand.modifiers.find(modifier.name), len(hand.modifiers) - 1)
    return modifier


def detach(hand: Object, modifier: Modifier) -> None:
    """Take one such modifier off the hand, and what only it used."""
    tree = modifier.node_group
    hand.modifiers.remove(modifier)
    if tree is not None and not tree.users:
        bpy.data.node_groups.remove(tree)
    tidy()


def tidy() -> None:
    """Remove meshes of offsets that no modifier uses any more."""
    for mesh in [mesh for mesh in bpy.data.meshes if mesh.name.startswith(names.SHOWN_MODIFIER)]:
        carriers = [obj for obj in bpy.data.objects if obj.data == mesh] if mesh.users else []
        if all(not carrier.users for carrier in carriers):
            for carrier in carriers:
                bpy.data.objects.remove(carrier)
            bpy.data.meshes.remove(mesh)


def remove(hand: Object) -> None:
    """Take every such modifier and its attribute off the hand."""
    for modifier in own.shown_modifiers(hand):
        detach(hand, modifier)
    if hand.type == "MESH" and hand.data.is_editable and hand.mode != "EDIT":
        attributes.remove(hand.data, [names.SHOWN_OFFSET])


def give_up(hand: Object) -> None:
    """Leave the modifier on the hand as its own: a contact that was applied keeps its shape."""
    for modifier in own.shown_modifiers(hand):
        modifier.name = names.APPLIED_MODIFIER
        if modifier.node_group is not None:
            kept = f"{names.SHOWN_OFFSET}_applied"
            modifier.node_group.nodes["Offset"].inputs["Name"].default_value = kept
            values = attributes.read(hand.data, names.SHOWN_OFFSET)
            if values is not None:
                attributes.write(hand.data, kept, "FLOAT_VECTOR", values)
    attributes.remove(hand.data, [names.SHOWN_OFFSET])


def _tree() -> NodeTree:
    tree = bpy.data.node_groups.new(names.SHOWN_MODIFIER, "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    new, link = tree.nodes.new, tree.links.new
    hand = new("NodeGroupInput").outputs[0]
    offset = new("GeometryNodeInputNamedAttribute")
    offset.name, offset.data_type = "Offset", "FLOAT_VECTOR"
    offset.inputs["Name"].default_value = names.SHOWN_OFFSET
    carrier = new("GeometryNodeObjectInfo")
    carrier.name = "Carrier"
    sample = new("GeometryNodeSampleIndex")
    sample.data_type, sample.domain = "FLOAT_VECTOR", "POINT"
    link(carrier.outputs["Geometry"], sample.inputs["Geometry"])
    link(new("GeometryNodeInputPosition").outputs[0], _enabled(sample.inputs, "Value"))
    link(new("GeometryNodeInputIndex").outputs[0], sample.inputs["Index"])
    same = new("FunctionNodeCompare")
    same.data_type, same.operation = "INT", "EQUAL"
    link(_points(tree, hand), _enabled(same.inputs, "A"))
    link(_points(tree, carrier.outputs["Geometry"]), _enabled(same.inputs, "B"))
    choose = new("GeometryNodeSwitch")
    choose.input_type = "VECTOR"
    link(same.outputs[0], _enabled(choose.inputs, "Switch"))
    link(_enabled(sample.outputs, "Value"), _enabled(choose.inputs, "True"))
    link(_enabled(offset.outputs, "Attribute"), _enabled(choose.inputs, "False"))
    move = new("GeometryNodeSetPosition")
    link(hand, move.inputs["Geometry"])
    link(_enabled(choose.outputs, "Output"), move.inputs["Offset"])
    link(move.outputs[0], new("NodeGroupOutput").inputs[0])
    return tree


def _carrier(offsets: Floats) -> Object:
    mesh = bpy.data.meshes.new(names.SHOWN_MODIFIER)
    mesh.vertices.add(len(offsets))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(offsets, np.float32).ravel())
    return bpy.data.objects.new(names.SHOWN_MODIFIER, mesh)


def _points(tree: NodeTree, geometry: NodeSocket) -> NodeSocket:
    size = tree.nodes.new("GeometryNodeAttributeDomainSize")
    tree.links.new(geometry, size.inputs[0])
    return size.outputs["Point Count"]


def _enabled(sockets: Iterable[NodeSocket], name: str) -> NodeSocket:
    return next(socket for socket in sockets if socket.name == name and socket.enabled)
