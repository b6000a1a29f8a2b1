"""The line along the border of the contact: its color, and how the shader draws it over a map."""

from bpy.types import Node, NodeTree

from .. import maps

COLOR = (0.10, 0.05, 0.05, 1.0)
"""Scene-linear, in shaders and in pictures. The width is `maps.LINE_MM`."""


def lined(tree: NodeTree, cover: Node, mapped: Node) -> Node:
    """`mapped` under a line where the attribute of `cover` is 0."""
    nodes, links = tree.nodes, tree.links
    distance, line, strength = nodes.new("ShaderNodeMath"), nodes.new("ShaderNodeMapRange"), nodes.new("ShaderNodeMath")
    distance.operation, strength.operation = "ABSOLUTE", "MULTIPLY"
    line.name, strength.name = "Line", "Line Shown"
    half, soft = 0.5 * maps.LINE_MM, 0.25 * maps.LINE_MM
    for name, value in (("From Min", half - soft), ("From Max", half + soft), ("To Min", 1.0), ("To Max", 0.0)):
        line.inputs[name].default_value = value
    ink, mix = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeMixShader")
    ink.inputs["Color"].default_value = COLOR
    links.new(cover.outputs["Fac"], distance.inputs[0])
    links.new(distance.outputs[0], line.inputs["Value"])
    links.new(line.outputs["Result"], strength.inputs[0])
    links.new(strength.outputs[0], mix.inputs[0])
    links.new(mapped.outputs["Shader"], mix.inputs[1])
    links.new(ink.outputs["Emission"], mix.inputs[2])
    return mix
