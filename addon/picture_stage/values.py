"""The pass that holds a map's values, its colors laid over a picture, and the plain materials of the stage."""

import bpy
import numpy as np

from .. import colormap, maps
from ..hand_look.shader import Tree
from ..skin_display import contact_border


def material(look):
    """Emits red: value's share of the range times cover; green: cover; blue: the line along the edge."""
    tree = Tree("Thenar Picture Values")
    view = maps.MAPS[maps.PRESSURE]
    scale = maps.scale(view, look)
    inside = tree.step(_field(tree, maps.covering(view)), *scale.edge)
    away = tree.math("ABSOLUTE", _field(tree, maps.covering(view)))
    line = tree.step(away, 0.75 * maps.LINE_MM, 0.25 * maps.LINE_MM) if maps.has_line(view, look) else 0.0
    bare = tree.math("SUBTRACT", 1.0, line)
    cover = tree.math("MULTIPLY", inside, bare)
    share = tree.node(
        "ShaderNodeMapRange", {"Value": _field(tree, view.attribute), "From Min": scale.low, "From Max": scale.high}
    ).outputs[0]
    held = tree.node("ShaderNodeCombineXYZ", {0: tree.math("MULTIPLY", share, cover), 1: cover, 2: line}).outputs[0]
    return tree.finish(tree.node("ShaderNodeEmission", {"Color": held}).outputs[0])


def laid_over(light, held, look):
    """Scene-linear (height, width, 3) of a picture `light` with the map's colors where `held` says so."""
    scale = maps.scale(maps.MAPS[maps.PRESSURE], look)
    cover, line = np.clip(held[..., 1], 0.0, 1.0), np.clip(held[..., 2], 0.0, 1.0)
    share = np.divide(held[..., 0], cover, out=np.zeros_like(cover), where=cover > 1e-4)
    shown = light * (1.0 - np.minimum(cover + line, 1.0))[..., None]
    seen = (cover + line) > 1e-4
    colors = colormap.to_linear(colormap.srgb(scale.palette, share[seen]))
    shown[seen] += cover[seen, None] * colors + line[seen, None] * np.array(contact_border.COLOR[:3])
    return shown


def nothing():
    """Emits nothing, and hides what is behind."""
    tree = Tree("Thenar Picture Nothing")
    return tree.finish(tree.node("ShaderNodeEmission", {"Strength": 0.0}).outputs[0])


def matte(color):
    """Reflects light as paper does; `color` (3,), scene-linear."""
    tree = Tree("Thenar Picture Sheet")
    return tree.finish(tree.node("ShaderNodeBsdfDiffuse", {"Color": (*color, 1.0)}).outputs[0])


def sky(color):
    """A world of one color."""
    world = bpy.data.worlds.new("Thenar Picture Sky")
    if world.node_tree is None:
        world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*color, 1.0)
    return world


def dark():
    """A world without light."""
    return sky((0.0, 0.0, 0.0))


def _field(tree, name):
    return tree.node("ShaderNodeAttribute", attribute_name=name).outputs["Fac"]
