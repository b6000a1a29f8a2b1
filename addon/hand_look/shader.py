"""Small language for shader node trees, and the skin material written in it."""

import bpy

from . import look

SKIN_MATERIAL = "Thenar Skin"


class Tree:
    """Builds a material's nodes: every method returns the socket that carries its value."""

    def __init__(self, name):
        self.material = bpy.data.materials.new(name)
        if self.material.node_tree is None:  # before Blender 5.0; later ones have nodes from the start
            self.material.use_nodes = True
        self.nodes = self.material.node_tree.nodes
        self.links = self.material.node_tree.links
        self.nodes.clear()

    def node(self, kind, inputs=(), **settings):
        """A node with `settings` as attributes and `inputs` by name or index; returns the node."""
        node = self.nodes.new(kind)
        node.location = (200 * (len(self.nodes) % 12), -180 * (len(self.nodes) // 12))
        for name, value in settings.items():
            setattr(node, name, value)
        for key, value in dict(inputs).items():
            self.put(node.inputs[key], value)
        return node

    def put(self, socket, value):
        """Link a socket to a value's socket, or set its default."""
        if isinstance(value, bpy.types.NodeSocket):
            self.links.new(value, socket)
        else:
            socket.default_value = value

    def math(self, operation, *values):
        """Scalar arithmetic."""
        return self.node("ShaderNodeMath", dict(enumerate(values)), operation=operation).outputs[0]

    def attribute(self, name):
        """The three components of a point attribute and the vector itself."""
        vector = self.node("ShaderNodeAttribute", attribute_name=name).outputs["Vector"]
        split = self.node("ShaderNodeSeparateXYZ", {0: vector})
        return (*split.outputs[:3], vector)

    def named(self, name, kind):
        """The value of the node of that name, which is made where there is none: what is set from outside."""
        node = self.nodes.get(name) or self.node(kind)
        node.name = node.label = name
        return node.outputs[0]

    def gain(self, value, slope):
        """1 + slope * value."""
        return self.math("ADD", 1.0, self.math("MULTIPLY", value, slope))

    def step(self, value, start, end):
        """0 before `start` and 1 behind `end`, smooth between."""
        inputs = {"Value": value, "From Min": start, "From Max": end}
        return self.node("ShaderNodeMapRange", inputs, interpolation_type="SMOOTHSTEP").outputs[0]

    def mix(self, factor, first, second, blend="MIX"):
        """Colors mixed by a factor."""
        node = self.node("ShaderNodeMix", data_type="RGBA", blend_type=blend)
        for name, value in (("Factor_Float", factor), ("A_Color", first), ("B_Color", second)):
            self.put(next(socket for socket in node.inputs if socket.identifier == name), value)
        return next(socket for socket in node.outputs if socket.identifier == "Result_Color")

    def bell(self, value, width):
        """exp(-(value / width)^2): one at zero, gone two widths away."""
        ratio = self.math("DIVIDE", value, width)
        return self.math("EXPONENT", self.math("MULTIPLY", self.math("MULTIPLY", ratio, ratio), -1.0))

    def noise(self, vector, scale, detail=2.0):
        """Noise between 0 and 1 at `scale` cells per mm."""
        node = self.node("ShaderNodeTexNoise", {"Vector": vector, "Scale": scale, "Detail": detail})
        return node.outputs[0]

    def finish(self, surface):
        """Connect the surface and return the material."""
        self.links.new(surface, self.node("ShaderNodeOutputMaterial").inputs["Surface"])
        return self.material


BACK, PALM = "Thenar Melanin Back", "Thenar Melanin Palm"
AGE = "Thenar Age"
NAILS, POLISH, POLISH_SHARE = "Thenar Nails", "Thenar Polish", "Thenar Polish Share"
"""Names of the nodes that hold a skin's look; `hand_shape/skin_look.py` sets them, and so may a user."""
WRIST_MM = (-14.0, 10.0)
"""Along the hand from its wrist crease: where the palm's lighter skin begins, mm."""
NAIL_EDGE = 0.035
"""Width of a nail's drawn edge, half widths: about 0.2 mm."""


def skin_material(mm_per_unit):
    """A new skin material; lengths of light and relief follow the scene's unit."""
    tree = Tree(SKIN_MATERIAL)
    unit = 1.0 / mm_per_unit
    palmar, blush, _, _ = tree.attribute(look.TONE)
    _, _, _, rest = tree.attribute(look.REST)
    age = tree.named(AGE, "ShaderNodeValue")
    nail, nail_color = _nail(tree)
    creases = tree.math("MULTIPLY", _creases(tree, rest, age), tree.gain(age, 0.9))
    patchy = tree.noise(rest, 0.06, 3.0)
    fine = tree.noise(rest, 0.5, 2.0)
    color = _color(tree, (palmar, blush, age), (patchy, fine), creases)
    color = tree.mix(nail, color, nail_color)
    bare = tree.math("SUBTRACT", 1.0, nail)
    bump = tree.node(
        "ShaderNodeBump", {"Strength": 0.7, "Distance": unit, "Height": _height(tree, rest, fine, creases)}
    )
    tree.put(bump.inputs["Strength"], tree.math("MULTIPLY", bare, 0.7))
    rough = tree.math("ADD", 0.40, tree.math("MULTIPLY", fine, 0.16))
    rough = tree.math("ADD", rough, tree.math("MULTIPLY", age, 0.08))
    rough = tree.math("SUBTRACT", rough, tree.math("MULTIPLY", nail, 0.22))
    surface = tree.node(
        "ShaderNodeBsdfPrincipled",
        {
            "Base Color": color,
            "Roughness": rough,
            "Normal": bump.outputs[0],
            "Subsurface Weight": tree.math("SUBTRACT", 0.35, tree.math("MULTIPLY", nail, 0.2)),
            "Subsurface Radius": (1.0, 0.35, 0.18),
            "Subsurface Scale": 2.2 * unit,
            "Specular IOR Level": 0.42,
            "IOR": 1.4,
        },
    )
    material = tree.finish(surface.outputs[0])
    material.diffuse_color = (0.80, 0.56, 0.46, 1.0)
    material.roughness = 0.5
    return material


def _height(tree, rest, fine, creases):
    """Relief of the skin, mm."""
    grain = tree.node("ShaderNodeTexVoronoi", {"Vector": rest, "Scale": 0.85}, feature="DISTANCE_TO_EDGE").outputs[
        "Distance"
    ]
    height = tree.math("MULTIPLY", tree.math("MINIMUM", grain, 0.18), 0.28)
    height = tree.math("ADD", height, tree.math("MULTIPLY", fine, 0.10))
    return tree.math("SUBTRACT", height, tree.math("MULTIPLY", creases, 0.55))


def _nail(tree):
    """Share of nail (0 or 1 but for a narrow edge) and its color: pink bed, pale moon and free edge, or polish."""
    across, along, height, _ = tree.attribute(look.NAIL)
    outline = _rounded_box(tree, across, along)
    inside = tree.step(outline, NAIL_EDGE, -NAIL_EDGE)
    inside = tree.math("MULTIPLY", inside, tree.math("LESS_THAN", height, 0.0))
    inside = tree.math("MULTIPLY", inside, tree.named(NAILS, "ShaderNodeValue"))
    bed = tree.mix(1.0, (0.76, 0.47, 0.41, 1.0), tree.named(PALM, "ShaderNodeRGB"), "MULTIPLY")
    free = tree.math("ADD", along, tree.math("MULTIPLY", tree.math("MULTIPLY", across, across), 0.10))
    bed = tree.mix(tree.math("MULTIPLY", tree.step(free, 0.80, 0.86), 0.55), bed, (0.80, 0.72, 0.62, 1.0))
    moon = tree.math("ADD", tree.math("MULTIPLY", tree.math("MULTIPLY", across, across), 2.2), along)
    bed = tree.mix(tree.math("MULTIPLY", tree.step(moon, -0.58, -0.72), 0.30), bed, (0.82, 0.68, 0.62, 1.0))
    share = tree.named(POLISH_SHARE, "ShaderNodeValue")
    return inside, tree.mix(share, bed, tree.named(POLISH, "ShaderNodeRGB"))


def _rounded_box(tree, across, along):
    """`look.nail_outline` as nodes."""
    x = tree.math("SUBTRACT", tree.math("ABSOLUTE", across), 1.0 - look.NAIL_CORNER)
    y = tree.math("MULTIPLY", tree.math("ABSOLUTE", along), look.NAIL_LENGTH)
    y = tree.math("SUBTRACT", y, look.NAIL_LENGTH - look.NAIL_CORNER)
    corner = [tree.math("POWER", tree.math("MAXIMUM", value, 0.0), 2.0) for value in (x, y)]
    outside = tree.math("SQRT", tree.math("ADD", *corner))
    inside = tree.math("MINIMUM", tree.math("MAXIMUM", x, y), 0.0)
    return tree.math("SUBTRACT", tree.math("ADD", outside, inside), look.NAIL_CORNER)


def _color(tree, tone, noise, creases):
    """The skin's color: blood and blotches below, melanin over them."""
    palmar, blush, age = tone
    patchy, fine = noise
    base = tree.mix(palmar, (0.56, 0.315, 0.215, 1.0), (0.72, 0.415, 0.315, 1.0))
    mottled = tree.math("MULTIPLY", tree.math("SUBTRACT", patchy, 0.35), 0.9)
    mottled = tree.math("MULTIPLY", mottled, tree.gain(age, 0.8))
    base = tree.mix(tree.math("MAXIMUM", mottled, 0.0), base, (0.64, 0.30, 0.235, 1.0))
    red = tree.math("MULTIPLY", blush, tree.math("ADD", 0.30, tree.math("MULTIPLY", patchy, 0.4)))
    base = tree.mix(red, base, (0.66, 0.235, 0.19, 1.0))
    speckle = tree.math("MULTIPLY", tree.math("SUBTRACT", fine, 0.5), 0.35)
    base = tree.mix(tree.math("MAXIMUM", speckle, 0.0), base, (0.80, 0.50, 0.40, 1.0))
    base = tree.mix(tree.math("MULTIPLY", creases, 0.5), base, (0.36, 0.125, 0.09, 1.0))
    base = tree.mix(_spots(tree, palmar, age), base, (0.26, 0.115, 0.065, 1.0))
    back, palm = tree.named(BACK, "ShaderNodeRGB"), tree.named(PALM, "ShaderNodeRGB")
    light = tree.math("MULTIPLY", palmar, tree.step(tree.attribute(look.REST)[1], *WRIST_MM))
    return tree.mix(1.0, base, tree.mix(light, back, palm), "MULTIPLY")


def _spots(tree, palmar, age):
    """Share of the brown spots that come with age on the back of the hand."""
    rest = tree.attribute(look.REST)[3]
    spots = tree.step(tree.noise(rest, 0.13, 1.5), 0.62, 0.70)
    spots = tree.math("MULTIPLY", spots, tree.math("SUBTRACT", 1.0, palmar))
    return tree.math("MULTIPLY", spots, tree.math("MULTIPLY", tree.math("MAXIMUM", age, 0.0), 0.45))


def _creases(tree, rest, age):
    """Depth of all creases, 0 to about 1: joints of the fingers, wrinkles on their back, lines of the palm."""
    place, front, back, _ = tree.attribute(look.FINGER)
    wander = tree.math("MULTIPLY", tree.math("SUBTRACT", tree.noise(rest, 0.22, 2.0), 0.5), 0.09)
    place = tree.math("ADD", place, wander)
    nearest = tree.math("SUBTRACT", place, tree.math("ROUND", place))
    inside = tree.math("MULTIPLY", tree.math("GREATER_THAN", place, 0.6), tree.math("LESS_THAN", place, 3.4))
    line = tree.bell(nearest, 0.022)
    second = tree.math("MULTIPLY", tree.bell(tree.math("ADD", nearest, 0.10), 0.016), 0.45)
    folds = tree.math("MULTIPLY", tree.math("MULTIPLY", tree.math("MAXIMUM", line, second), front), inside)
    wave = tree.math("POWER", tree.math("ABSOLUTE", tree.math("SINE", tree.math("MULTIPLY", place, 34.0))), 6.0)
    wave = tree.math("MULTIPLY", wave, tree.bell(tree.math("SUBTRACT", nearest, 0.10), 0.14))
    wave = tree.math("MULTIPLY", tree.math("MULTIPLY", wave, back), tree.math("MULTIPLY", inside, 0.35))
    wave = tree.math("MULTIPLY", wave, tree.gain(age, 0.8))
    total = tree.math("ADD", folds, wave)
    distances = tree.attribute(look.LINES)[:3]
    fades = tree.attribute(look.LINES_FADE)[:3]
    sway = tree.math("MULTIPLY", tree.math("SUBTRACT", tree.noise(rest, 0.15, 2.0), 0.5), 4.0)
    for distance, fade in zip(distances, fades, strict=True):
        line = tree.bell(tree.math("ADD", distance, sway), 0.75)
        total = tree.math("ADD", total, tree.math("MULTIPLY", tree.math("MULTIPLY", line, fade), 0.85))
    return total
