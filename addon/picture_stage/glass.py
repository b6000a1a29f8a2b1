"""Skin behind glass: blood pressed out of the skin where it is pressed, the glass itself, and a window mirrored in it.

Changes materials of the open file: it is called in a file that is thrown away afterwards.
"""

import numpy as np

from .. import names
from ..hand_look.shader import PALM, Tree

BLOODLESS_KPA = 48.0
"""Pressure at which the color shows no blood; in between it falls linearly. Blood flow in the skin of the hand fell by
50 % at 15 to 33 kPa and by 85 % at 30 to 52 kPa (Johansson, Hägg & Fischer 2002, Eur J Appl Physiol 86:394): the line
passes the middle of both ranges, 24 and 41 kPa. That the color follows the flow is an assumption."""
DENSITY = (0.10, 0.64, 0.50)
"""Optical density of the blood in red, green and blue, by eye: hemoglobin absorbs green most; skin without it is
yellower."""
FLUSH, FLUSH_MM = 0.6, 4.0
"""Blood that is displaced to the rim: share more just outside the contact, gone so far away. By eye."""
PALE = (0.72, 0.415, 0.315)
"""Palmar skin of the material in `hand/shader.py`, scene-linear, for the legend and where a hand has no material."""
_EDGE_MM = 0.12
"""Half the width over which skin that touches goes over into skin that does not."""
_WET = 0.3
"""Share of the blanching at a light touch: skin that touches glass loses its gloss and looks lighter."""
_TINT, _RIM = (0.975, 0.992, 0.985, 1.0), (0.34, 0.62, 0.52, 1.0)
"""Color of the glass seen through its face, and along its edges."""


def blood_left(pressure_kpa):
    """Share of the skin's blood under a pressure, kPa: 1 without, 0 from `BLOODLESS_KPA` on."""
    return np.clip(1.0 - np.asarray(pressure_kpa, float) / BLOODLESS_KPA, 0.0, 1.0)


def color_under(pressure_kpa, own):
    """Scene-linear color (k, 3) of skin of the color `own` (3,) that touches glass with pressures (k,), kPa."""
    gone = _WET + (1.0 - _WET) * (1.0 - blood_left(pressure_kpa))
    return np.asarray(own, float) * np.exp(np.multiply.outer(gone, DENSITY))


def own_color(materials):
    """Scene-linear palmar color (3,) of the first skin among materials, else `PALE`."""
    for material in materials:
        node = material.node_tree.nodes.get(PALM) if material is not None and material.node_tree else None
        if node is not None:
            return np.array(PALE) * np.array(node.outputs[0].default_value[:3])
    return np.array(PALE)


def dress(mesh):
    """Exchange the materials of a hand's mesh for such whose color answers to its pressure."""
    for slot, material in enumerate(list(mesh.materials)):
        mesh.materials[slot] = blanching(material)
    if not mesh.materials:
        mesh.materials.append(blanching(None))


def blanching(material):
    """A copy of a material of skin that blanches under pressure; a plain skin where it has no Principled BSDF."""
    copy = material.copy() if material is not None and material.node_tree is not None else None
    shader = _shader(copy)
    if shader is None:
        tree = Tree("Thenar Picture Skin")
        node = tree.node("ShaderNodeBsdfPrincipled", {"Base Color": (*PALE, 1.0), "Roughness": 0.5})
        copy, shader = tree.finish(node.outputs[0]), node
    tree = _tree_of(copy)
    socket = shader.inputs["Base Color"]
    own = socket.links[0].from_socket if socket.is_linked else tuple(socket.default_value)
    touch, gone = _gone(tree)
    color = tree.mix(1.0, own, _gain(tree, gone), "MULTIPLY")
    tree.put(socket, color)
    pressed = tree.node("ShaderNodeBsdfPrincipled", {"Base Color": color, "Roughness": 0.7, "Specular IOR Level": 0.0})
    for name in ("Subsurface Weight", "Subsurface Radius", "Subsurface Scale"):
        value = shader.inputs[name]
        tree.put(pressed.inputs[name], value.links[0].from_socket if value.is_linked else value.default_value)
    targets = [link.to_socket for link in shader.outputs[0].links]
    both = tree.node("ShaderNodeMixShader", {0: touch, 1: shader.outputs[0], 2: pressed.outputs[0]}).outputs[0]
    for target in targets:
        tree.put(target, both)
    return copy


def _shader(material):
    """The Principled BSDF that a material shows, or None."""
    nodes = material.node_tree.nodes if material is not None else ()
    return next((node for node in nodes if node.type == "BSDF_PRINCIPLED" and node.outputs[0].is_linked), None)


def _tree_of(material):
    """A `Tree` that adds to a material's nodes."""
    tree = Tree.__new__(Tree)
    tree.material, tree.nodes, tree.links = material, material.node_tree.nodes, material.node_tree.links
    return tree


def _gone(tree):
    """Share of skin that touches (0 or 1 but for the edge), and of its blood that is gone (< 0: more than usual)."""
    pressure, edge = (
        tree.node("ShaderNodeAttribute", attribute_name=name).outputs["Fac"]
        for name in (names.PRESSURE_KPA, names.EDGE_MM)
    )
    touch = tree.step(edge, -_EDGE_MM, _EDGE_MM)
    pressed = tree.node("ShaderNodeMapRange", {"Value": pressure, "From Max": BLOODLESS_KPA}).outputs[0]
    pressed = tree.math("MULTIPLY", touch, tree.math("ADD", _WET, tree.math("MULTIPLY", pressed, 1.0 - _WET)))
    near = tree.step(edge, -FLUSH_MM, 0.0)
    rim = tree.math("MULTIPLY", near, tree.math("SUBTRACT", 1.0, touch))
    return touch, tree.math("SUBTRACT", pressed, tree.math("MULTIPLY", rim, FLUSH))


def _gain(tree, gone):
    """Color by which the skin's own is multiplied."""
    parts = [tree.math("EXPONENT", tree.math("MULTIPLY", gone, density)) for density in DENSITY]
    return tree.node("ShaderNodeCombineColor", dict(enumerate(parts))).outputs[0]


def plate():
    """Glass as the eye sees it: clear, a mirror by Fresnel, green along its edges; light passes it as if none was."""
    tree = Tree("Thenar Picture Glass")
    facing = tree.node("ShaderNodeLayerWeight", {"Blend": 0.35}).outputs["Facing"]
    through = tree.node("ShaderNodeBsdfTransparent", {"Color": tree.mix(tree.step(facing, 0.2, 0.6), _TINT, _RIM)})
    mirror = tree.node("ShaderNodeBsdfGlossy", {"Roughness": 0.03})
    share = tree.node("ShaderNodeFresnel", {"IOR": 1.5}).outputs[0]
    seen = tree.node("ShaderNodeMixShader", {0: share, 1: through.outputs[0], 2: mirror.outputs[0]}).outputs[0]
    is_seen = tree.node("ShaderNodeLightPath").outputs["Is Camera Ray"]
    unseen = tree.node("ShaderNodeBsdfTransparent").outputs[0]
    return tree.finish(tree.node("ShaderNodeMixShader", {0: is_seen, 1: unseen, 2: seen}).outputs[0])


def softbox(strength):
    """Light that is seen in mirrors alone."""
    tree = Tree("Thenar Picture Softbox")
    is_mirrored = tree.node("ShaderNodeLightPath").outputs["Is Glossy Ray"]
    light = tree.node("ShaderNodeEmission", {"Strength": strength}).outputs[0]
    clear = tree.node("ShaderNodeBsdfTransparent").outputs[0]
    return tree.finish(tree.node("ShaderNodeMixShader", {0: is_mirrored, 1: clear, 2: light}).outputs[0])
