"""Blender properties of the tissue of a region: presets, numbers, and what older files lack.

Numbers of the tissue are not written here: presets come from the native module's published materials.
"""

import re
from math import isfinite

import bpy
from bpy.props import EnumProperty, FloatProperty

from .. import native
from ..scene.units import KPA_PER_MPA

PRESETS = (
    ("FINGER_LAYER", "Fingertip", "Finger pad as a soft layer on bone; for the layer model", 0),
    ("PALM_LAYER", "Palm", "Palm as a soft layer on bone; for the layer model", 1),
    ("FINGER", "Finger (Xie)", "Fingertip of Xie, Kanai & Date, section 4.1 and Table 2; for the paper model", 2),
    ("PALM", "Palm (Xie)", "Palm of Xie, Kanai & Date, section 4.1 and Table 2; for the paper model", 3),
    ("PHALANX_LAYER", "Phalanx", "Pad of a finger's middle or base over a long bone; for the layer model", 5),
    ("CUSTOM", "Own values", "Values entered by hand", 4),
)


def fill_from_preset(material, preset):
    """Set a region's numbers to a preset; the sets of values stand in the native module."""
    numbers = native.published(preset.lower())
    if numbers is None:
        return
    _filling.append(preset)
    for name, (prop, factor) in MATERIAL_NUMBERS.items():
        setattr(material, prop, _shown(numbers[name], factor))
    _filling.clear()


def preset_of(region_name, model="LAYER"):
    """Preset of a region by its name: palm, phalanx (layer model only) or fingertip."""
    words = region_name.lower()
    if "palm" in words or "thenar" in words:
        return "PALM_LAYER" if model == "LAYER" else "PALM"
    if model != "LAYER":
        return "FINGER"
    return "PHALANX_LAYER" if _PHALANX.search(words) and "distal" not in words else "FINGER_LAYER"


_PHALANX = re.compile(r"proximal|intermediate|phalan|(thumb|index|middle|ring|little|pinky)[ _.-]*middle")
FORMAT = 1
"""Version of the numbers that a hand's file holds: 0 had no stiffening and no bones."""
_IN_FORMAT_0 = {
    "g0_kpa": 9.8,
    "g_lim_kpa": 29.0,
    "stiffening": 0.0,
    "bone_half_width_mm": 0.0,
    "bone_half_length_mm": 0.0,
}
"""What a material of one's own means there by the numbers that it does not hold."""


def mark(hand):
    """Note, as the file is saved, that the hand's materials hold the numbers of today."""
    if hand.library is None and any(_is_filled(material) for material in _materials(hand)):
        hand.thenar.format = FORMAT


def bring_up_to_date(hand):
    """Give a hand that an older version saved today's numbers of its presets; own values keep their meaning."""
    if hand.thenar.format >= FORMAT:
        return
    for material in filter(_is_filled, _materials(hand)):
        if material.preset == "CUSTOM":
            for prop, value in _IN_FORMAT_0.items():
                if not material.is_property_set(prop):
                    setattr(material, prop, value)
            continue
        thickness = material.thickness_mm
        material.preset = preset_of(material.name) if material.preset == "FINGER_LAYER" else material.preset
        material.thickness_mm = thickness
    mark(hand)


def _materials(hand):
    return (*hand.thenar.materials, hand.thenar.default_material)


def _is_filled(material):
    return any(material.is_property_set(prop) for prop, _ in MATERIAL_NUMBERS.values())


MATERIAL_NUMBERS = {
    "g0_mpa": ("g0_kpa", KPA_PER_MPA),
    "g_lim_mpa": ("g_lim_kpa", KPA_PER_MPA),
    "d_lim_mm": ("d_lim_mm", 1),
    "thickness_mm": ("thickness_mm", 1),
    "poisson_ratio": ("poisson_ratio", 1),
    "stiffening": ("stiffening", 1),
    "bone_half_width_mm": ("bone_half_width_mm", 1),
    "bone_half_length_mm": ("bone_half_length_mm", 1),
    "zone_mm": ("zone_mm", 1),
    "swelling_height_mm_per_n": ("swelling_height_mm_per_n", 1),
    "swelling_radius_mm": ("swelling_radius_mm", 1),
    "swelling_width_mm": ("swelling_width_mm", 1),
}
"""Parameter of the library -> property here, and what its value is multiplied with. Infinite lengths show as 0."""

ANATOMY = ("thickness_mm", "bone_half_width_mm", "bone_half_length_mm")
"""Lengths of the hand, infinite where 0; to change them does not make a preset one's own."""

_LABELS = {
    "g0_kpa": "G0 (kPa)",
    "g_lim_kpa": "G Limit (kPa)",
    "d_lim_mm": "d Limit (mm)",
    "thickness_mm": "Thickness (mm)",
    "poisson_ratio": "Poisson Ratio",
    "stiffening": "Stiffening",
    "bone_half_width_mm": "Bone ½W (mm)",
    "bone_half_length_mm": "Bone ½L (mm)",
    "zone_mm": "Zone (mm)",
    "swelling_height_mm_per_n": "Swell (mm/N)",
    "swelling_radius_mm": "Radius (mm)",
    "swelling_width_mm": "Width (mm)",
}
_DEFAULT_PRESET = "FINGER_LAYER"
_filling = []
"""Not empty while a preset writes its numbers, which are then not the user's own."""


def _shown(value, factor):
    return value * factor if isfinite(value) else 0.0


def _preset_changed(self, _context):
    if self.preset != "CUSTOM":
        fill_from_preset(self, self.preset)


def _value_changed(self, _context):
    if not _filling and self.preset != "CUSTOM":
        self.preset = "CUSTOM"


def _number_properties():
    """A float property for every parameter of the library's table; plain ones where that table is missing."""
    table, defaults = native.parameters(), native.published(_DEFAULT_PRESET.lower()) or {}
    properties = {}
    for name, (prop, factor) in MATERIAL_NUMBERS.items():
        row = table.get(name, {})
        properties[prop] = FloatProperty(
            name=_LABELS[prop],
            description=_sentence(row, prop),
            default=_shown(defaults.get(name, 1.0), factor),
            min=0.0 if prop in ANATOMY else row.get("low", 0.0) * factor,
            max=min(row.get("high", 1e6) * factor, 1e6),
            precision=3,
            update=None if prop in ANATOMY else _value_changed,
        )
    return properties


def _sentence(row, prop):
    if not row:
        return _LABELS[prop]
    zero = {"thickness_mm": "; 0: no bone below"}.get(prop, "; 0: without end") if prop in ANATOMY else ""
    return f"{row['meaning'].capitalize()}{zero}. {row['source']}"


class ThenarMaterial(bpy.types.PropertyGroup):
    """Material of one region; `name` is the vertex group. Its numbers come from the library's table."""

    __annotations__ = {
        "preset": EnumProperty(
            name="Preset",
            description="Published values for this kind of skin",
            items=PRESETS,
            default=_DEFAULT_PRESET,
            update=_preset_changed,
        ),
        **_number_properties(),
    }
