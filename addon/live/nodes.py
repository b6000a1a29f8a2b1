"""The modifier that shows the live contact on the hand, and gives back what the skin was before it.

It stands last in the stack, keeps the positions it receives as an attribute, and moves them by the contact's offsets.
So the pose without contact is read from the very evaluation that shows the contact, and no second one is needed.
"""

import bpy
import numpy as np

from .. import names
from ..ownership import own
from ..scene import attributes, mesh
from ..scene.checks import Refusal


def attach(hand):
    """Hang the modifier on the hand where it is missing."""
    modifier = own.live_modifier(hand)
    if modifier is None:
        modifier = hand.modifiers.new(names.LIVE_MODIFIER, "NODES")
        modifier.show_expanded = False
    modifier.node_group = bpy.data.node_groups.get(names.LIVE_MODIFIER) or _tree()
    modifier.show_viewport, modifier.show_render = True, False
    hand.modifiers.move(hand.modifiers.find(modifier.name), len(hand.modifiers) - 1)


def detach(hand):
    """Take modifier and offsets off the hand again."""
    _take_off(hand)
    if hand.type == "MESH" and hand.data.is_editable and hand.mode != "EDIT":
        attributes.remove(hand.data, [names.LIVE_OFFSET])
        hand.data.update()
    _drop_unused_tree()


def sweep(kept=()):
    """Take the modifier off every object but the hands that are `kept`: duplicates, former hands, files cut short.

    Looks at objects only where the node group says that there are more users than those.
    """
    tree = bpy.data.node_groups.get(names.LIVE_MODIFIER)
    if tree is None or tree.users <= sum(own.live_modifier(hand) is not None for hand in kept):
        return
    meshes = {hand.data for hand in kept}
    for obj in bpy.data.objects:
        if obj in kept or not obj.is_editable or not _live_modifiers(obj):
            continue
        if obj.data in meshes:  # the offsets in it are still needed
            _take_off(obj)
        else:
            detach(obj)
    _drop_unused_tree()


def base_positions(hand, depsgraph):
    """Evaluated positions (n, 3) float32 of the hand's vertices without the live contact, local, Blender units.

    Raises `Refusal` where the modifier does not act.
    """
    count = len(hand.data.vertices)
    with mesh.evaluated_mesh(hand, depsgraph) as surface:
        values = attributes.read(surface, names.LIVE_BASE)
    if values is None or len(values) < count:
        raise Refusal(
            f"the modifier '{names.LIVE_MODIFIER}' on '{hand.name}' does not act; switch it on in the viewport, "
            "or switch Live off and on"
        )
    return np.ascontiguousarray(values[:count])


def _live_modifiers(obj):
    """All that show a live contact; a copy of the modifier has another name and the same nodes."""
    tree = bpy.data.node_groups.get(names.LIVE_MODIFIER)
    nodes = [modifier for modifier in obj.modifiers if modifier.type == "NODES"]
    return [one for one in nodes if one.name == names.LIVE_MODIFIER or (tree is not None and one.node_group == tree)]


def _take_off(obj):
    for modifier in _live_modifiers(obj):
        obj.modifiers.remove(modifier)


def _drop_unused_tree():
    tree = bpy.data.node_groups.get(names.LIVE_MODIFIER)
    if tree is not None and tree.users == 0:
        bpy.data.node_groups.remove(tree)


def _tree():
    tree = bpy.data.node_groups.new(names.LIVE_MODIFIER, "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    store = tree.nodes.new("GeometryNodeStoreNamedAttribute")
    store.data_type, store.domain = "FLOAT_VECTOR", "POINT"
    store.inputs["Name"].default_value = names.LIVE_BASE
    read = tree.nodes.new("GeometryNodeInputNamedAttribute")
    read.data_type = "FLOAT_VECTOR"
    read.inputs["Name"].default_value = names.LIVE_OFFSET
    move = tree.nodes.new("GeometryNodeSetPosition")
    position = tree.nodes.new("GeometryNodeInputPosition")
    link = tree.links.new
    link(tree.nodes.new("NodeGroupInput").outputs[0], store.inputs["Geometry"])
    link(position.outputs[0], _enabled(store.inputs, "Value"))
    link(store.outputs[0], move.inputs["Geometry"])
    link(_enabled(read.outputs, "Attribute"), move.inputs["Offset"])
    link(move.outputs[0], tree.nodes.new("NodeGroupOutput").inputs[0])
    return tree


def _enabled(sockets, name):
    return next(socket for socket in sockets if socket.name == name and socket.enabled)
