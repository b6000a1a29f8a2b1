"""The modifier that stands last in the hand's stack and adds what the contact's key could not bring to the surface.

Two parts: an attribute of the hand's own vertices, which Blender carries through Subdivision at any level, and offsets
of every evaluated vertex, held by the vertices of a mesh that no scene shows; these act only while the evaluated hand
has as many vertices as it had when they were found, so that a render at another level is not torn.
"""

import bpy
import numpy as np

from .. import names
from . import attributes, own


def attach(hand, offsets):
    """Hang a new modifier on the hand; `offsets` (n, 3) of its own vertices, local, Blender units. Returns it."""
    attributes.write(hand.data, names.SHOWN_OFFSET, "FLOAT_VECTOR", offsets)
    modifier = hand.modifiers.new(names.SHOWN_MODIFIER, "NODES")
    modifier.node_group = _tree()
    modifier.show_expanded = False
    hand.modifiers.move(hand.modifiers.find(modifier.name), len(hand.modifiers) - 1)
    return modifier


def refine(modifier, offsets):
    """Add `offsets` (m, 3) of the evaluated vertices, local, Blender units, to what the modifier does."""
    tree = modifier.node_group
    info = tree.nodes["Carrier"]
    carrier = info.inputs["Object"].default_value
    if carrier is not None:
        raise ValueError("the modifier already carries offsets of evaluated vertices")
    mesh = bpy.data.meshes.new(names.SHOWN_MODIFIER)
    mesh.vertices.add(len(offsets))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(offsets, np.float32).ravel())
    info.inputs["Object"].default_value = bpy.data.objects.new(names.SHOWN_MODIFIER, mesh)


def detach(hand, modifier):
    """Take one such modifier off the hand, and what only it used."""
    tree = modifier.node_group
    hand.modifiers.remove(modifier)
    if tree is None or tree.users:
        return
    info = tree.nodes.get("Carrier")
    carrier = info.inputs["Object"].default_value if info is not None else None
    bpy.data.node_groups.remove(tree)
    if carrier is not None and not carrier.users:
        mesh = carrier.data
        bpy.data.objects.remove(carrier)
        if mesh is not None and not mesh.users:
            bpy.data.meshes.remove(mesh)


def remove(hand):
    """Take every such modifier and its attribute off the hand."""
    for modifier in own.shown_modifiers(hand):
        detach(hand, modifier)
    if hand.type == "MESH" and hand.data.is_editable and hand.mode != "EDIT":
        attributes.remove(hand.data, [names.SHOWN_OFFSET])


def give_up(hand):
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


def _tree():
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
    total = new("ShaderNodeVectorMath")
    link(_enabled(offset.outputs, "Attribute"), total.inputs[0])
    link(_enabled(choose.outputs, "Output"), total.inputs[1])
    move = new("GeometryNodeSetPosition")
    link(hand, move.inputs["Geometry"])
    link(total.outputs[0], move.inputs["Offset"])
    link(move.outputs[0], new("NodeGroupOutput").inputs[0])
    return tree


def _points(tree, geometry):
    size = tree.nodes.new("GeometryNodeAttributeDomainSize")
    tree.links.new(geometry, size.inputs[0])
    return size.outputs["Point Count"]


def _enabled(sockets, name):
    return next(socket for socket in sockets if socket.name == name and socket.enabled)
