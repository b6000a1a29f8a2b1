"""The render: settings that keep colours true, and the legend laid over the picture; both can be taken back."""

import json

import bpy
import numpy as np

from .. import names
from . import compositor_trees, legend

_SETTINGS = (
    ("view_settings", "view_transform", "Standard"),
    ("view_settings", "look", "None"),
    ("view_settings", "exposure", 0.0),
    ("view_settings", "gamma", 1.0),
    ("cycles", "use_denoising", False),
    ("render", "use_lock_interface", True),
    ("render", "dither_intensity", 0.0),
)


def apply_preset(scene):
    """Set Standard view, no denoiser and the legend; what was set before is kept in the scene."""
    if not scene.thenar.preset_before:
        before = {f"{owner}.{name}": getattr(getattr(scene, owner), name) for owner, name, _ in _present(scene)}
        scene.thenar.preset_before = json.dumps(before)
    for owner, name, value in _present(scene):
        setattr(getattr(scene, owner), name, value)
    add_legend(scene)


def restore_preset(scene):
    """Give back what `apply_preset` changed."""
    if scene.thenar.preset_before:
        for path, value in json.loads(scene.thenar.preset_before).items():
            owner, name = path.split(".")
            setattr(getattr(scene, owner), name, value)
        scene.thenar.preset_before = ""
    remove_legend(scene)


def add_legend(scene):
    """Lay the legend over the render by the compositor, after whatever else it does to the picture."""
    remove_legend(scene)
    tree = compositor_trees.for_legend(scene)
    image_name, over_name = names.LEGEND_NODES
    target = compositor_trees.picture_input(tree)
    image = tree.nodes.new("CompositorNodeImage")
    image.name, image.image = image_name, _legend_image(scene)
    over = tree.nodes.new("CompositorNodeAlphaOver")
    over.name = over_name
    image.location = (target.node.location.x - 400, target.node.location.y - 250)
    over.location = (target.node.location.x - 200, target.node.location.y)
    background, foreground = [socket for socket in over.inputs if socket.type == "RGBA"]
    is_linked = target.is_linked
    source = target.links[0].from_socket if is_linked else compositor_trees.render_layers(tree, scene).outputs["Image"]
    tree.links.new(source, background)
    tree.links.new(image.outputs["Image"], foreground)
    tree.links.new(over.outputs[0], target)


def remove_legend(scene):
    """Take the legend's nodes out of every tree that has them, join what they parted, and drop a tree made for them."""
    for tree in _with_legend(scene):
        _take_out(tree)
    compositor_trees.drop_own(scene)


def _take_out(tree):
    image_name, over_name = names.LEGEND_NODES
    over = tree.nodes[over_name]
    background = next(socket for socket in over.inputs if socket.type == "RGBA")
    targets = [link.to_socket for link in over.outputs[0].links]
    source = background.links[0].from_socket if background.is_linked else None
    for target in targets if source is not None else ():
        tree.links.new(source, target)
    tree.nodes.remove(over)
    image = tree.nodes.get(image_name)
    if image is not None:
        tree.nodes.remove(image)


def has_legend(scene):
    """Whether renders of the scene carry the legend."""
    return bool(_with_legend(scene))


def update_legend(scene):
    """Paint the legend anew after range, colours, result or picture size changed."""
    for tree in _with_legend(scene):
        tree.nodes[names.LEGEND_NODES[0]].image = _legend_image(scene)


def _with_legend(scene):
    return [tree for tree in compositor_trees.trees(scene) if names.LEGEND_NODES[1] in tree.nodes]


def _present(scene):
    return [row for row in _SETTINGS if hasattr(scene, row[0]) and hasattr(getattr(scene, row[0]), row[1])]


def _legend_image(scene):
    width, height = picture_size(scene)
    painted = legend.pixels(scene.thenar, scene.thenar.result, width, height)
    image = bpy.data.images.get(names.LEGEND_IMAGE)
    if image is not None and tuple(image.size) != (width, height):
        bpy.data.images.remove(image)
        image = None
    if image is None:
        image = bpy.data.images.new(names.LEGEND_IMAGE, width, height, alpha=True)
    image.pixels.foreach_set(np.ascontiguousarray(painted, np.float32).ravel())
    image.update()
    image.pack()
    return image


def picture_size(scene):
    """Width and height of the render, pixels."""
    factor = scene.render.resolution_percentage / 100.0
    return int(scene.render.resolution_x * factor), int(scene.render.resolution_y * factor)
