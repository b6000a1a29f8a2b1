"""Where a scene keeps the compositor's node trees: `node_tree` until 4.5, a group until 5.2, a row of effects since."""

import bpy

from .. import names


def trees(scene):
    """Every node tree of the scene's compositor, in the order in which they change the picture."""
    if _has_effects(scene):
        return [effect.node_group for effect in scene.compositor_effects if effect.node_group is not None]
    tree = scene.compositing_node_group if _has_group(scene) else scene.node_tree if scene.use_nodes else None
    return [] if tree is None else [tree]


def for_legend(scene):
    """The tree that hands on the finished picture, made where there is none; with effects, a last one of its own."""
    if _has_effects(scene):
        return _own_effect(scene)
    if trees(scene):
        return trees(scene)[0]
    if not _has_group(scene):
        scene.use_nodes = True
        return scene.node_tree
    tree = _group("Thenar Compositing")
    leave = tree.nodes.new("NodeGroupOutput")
    tree.links.new(render_layers(tree, scene).outputs["Image"], leave.inputs["Image"])
    scene.compositing_node_group = tree
    return tree


def drop_own(scene):
    """Remove the effect that `for_legend` added; the active effect stays active."""
    if not _has_effects(scene):
        return
    effects = scene.compositor_effects
    for effect in [each for each in effects if each.node_group is not None and names.LEGEND_TREE in each.node_group]:
        tree = effect.node_group
        effects.remove(effect)
        if tree.users == 0:
            bpy.data.node_groups.remove(tree)


def picture_input(tree):
    """The socket that takes the tree's finished picture, made where there is none."""
    kinds = ("NodeGroupOutput", "CompositorNodeComposite")
    for node in tree.nodes:
        colors = [socket for socket in node.inputs if socket.type == "RGBA"]
        if node.bl_idname in kinds and colors:
            return colors[0]
    if tree.is_embedded_data:  # the scene's own tree, until 4.5
        return tree.nodes.new("CompositorNodeComposite").inputs["Image"]
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    return tree.nodes.new("NodeGroupOutput").inputs["Image"]


def render_layers(tree, scene):
    """The node of the tree that gives the render, made where there is none."""
    for node in tree.nodes:
        if node.bl_idname == "CompositorNodeRLayers":
            return node
    node = tree.nodes.new("CompositorNodeRLayers")
    node.scene = scene
    return node


def _own_effect(scene):
    effects = scene.compositor_effects
    before = effects.active
    tree = _group("Thenar Legend")
    tree[names.LEGEND_TREE] = True
    tree.interface.new_socket("Image", in_out="INPUT", socket_type="NodeSocketColor")
    enter, leave = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(enter.outputs["Image"], leave.inputs["Image"])
    effects.new("Thenar Legend").node_group = tree
    if before is not None:
        effects.active = before
    return tree


def _group(name):
    tree = bpy.data.node_groups.new(name, "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    return tree


def _has_effects(scene):
    return "compositor_effects" in scene.bl_rna.properties


def _has_group(scene):
    """Asked of the type: the property of 5.0 to 5.2 warns where it is read in 5.3."""
    return "compositing_node_group" in scene.bl_rna.properties
