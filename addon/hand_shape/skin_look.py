"""Tone, age and nails of a made hand, set in its skin material. No geometry changes."""

import math

import bpy

from ..hand_look import shader

FIRST_TONE = 2.0
"""Tone at which the material's own colors hold: the melanin of this tone is counted as none."""
MELANIN = (0.85, 1.0, 1.15)
"""Optical density of melanin in red, green and blue per unit, by eye: measured spectra (Jacques 1998) are steeper, but
hold for one passage of light."""
PER_TONE, PER_LIGHTER_TONE = 0.6, 0.3
"""Density per step of tone above and below `FIRST_TONE`, by eye on rendered hands."""
PALM_SHARE = 0.3
"""Melanin of the palm over that of the back, by eye; it is less there in every skin (Yamaguchi 2004)."""
YOUNG, AGE_SPAN = 30.0, 50.0
"""Years at which the material's creases and blotches are as drawn, and after which they are about twice that."""
SOLID = (0.80, 0.56, 0.46)
"""Color of Solid view at `FIRST_TONE`."""


def apply(hand):
    """Bring the hand's skin materials to its settings; a material that other meshes use is copied first."""
    for slot, material in enumerate(hand.data.materials):
        if is_skin(material) and _is_shared(material):
            hand.data.materials[slot] = material.copy()
    shown = [slot.material for slot in hand.material_slots]
    for material in {*hand.data.materials, *shown}:
        if is_skin(material):
            set_look(material, hand.thenar_hand)


def has_skin(hand):
    """Whether the hand still wears a skin whose look can be set."""
    return any(is_skin(material) for material in hand.data.materials)


def is_skin(material):
    """Whether it is Thenar's skin, or a copy of it."""
    return material is not None and material.node_tree is not None and shader.BACK in material.node_tree.nodes


def set_look(material, settings):
    """Set a skin's nodes to tone, age and nails of `settings`; nodes that the user took out are passed over."""
    step = settings.tone - FIRST_TONE
    density = step * (PER_TONE if step > 0.0 else PER_LIGHTER_TONE)
    _put(material, shader.BACK, (*_transmitted(density), 1.0))
    _put(material, shader.PALM, (*_transmitted(PALM_SHARE * density), 1.0))
    _put(material, shader.AGE, (settings.age - YOUNG) / AGE_SPAN)
    _put(material, shader.NAILS, 0.0 if settings.nails == "NONE" else 1.0)
    _put(material, shader.POLISH, (*settings.polish, 1.0))
    _put(material, shader.POLISH_SHARE, 1.0 if settings.nails == "POLISH" else 0.0)
    material.diffuse_color = (*(own * part for own, part in zip(SOLID, _transmitted(density), strict=True)), 1.0)


def _transmitted(density):
    return [math.exp(-density * part) for part in MELANIN]


def _put(material, name, value):
    node = material.node_tree.nodes.get(name)
    if node is not None:
        node.outputs[0].default_value = value


def _is_shared(material):
    return material.library is not None or sum(material in mesh.materials.values() for mesh in bpy.data.meshes) > 1
