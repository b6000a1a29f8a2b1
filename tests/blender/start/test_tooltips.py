"""Every operator and every property with a title says in its tooltip what it is; numbers say their unit."""

import inspect
import re
from types import SimpleNamespace

import bpy

UNITS = r"mm|mm/N|mm2|mm²|N|kPa|MPa|%|percent|degrees|°|seconds|s|newtons|years|Years|dpi|fps|px|pixels|frames?"
"""Units as words of a name or a tooltip."""
WITHOUT_UNIT = {
    "THENAR_OT_make_hand.percentile": "of adults",
    "ThenarHandShape.percentile": "of adults",
    "THENAR_OT_scale_product.factor": "ratio of sizes",
    "ThenarEffectNumber.value": "its row shows the parameter's own unit",
    "ThenarEffect.amplitude": "that of the law, whose parameters are named next to it",
    "ThenarMaterial.stiffening": "exponent of a strain",
    "ThenarGrip.hardness": "Shore A is a scale",
    "ThenarGrip.poisson_ratio": "ratio of strains",
    "ThenarScene.direction": "unit vector",
    "ThenarGrasps.friction": "ratio of forces",
}
"""Ratios, directions and scales: what a number without unit is."""


def below(base, package="thenar_blender"):
    """Registered classes of a package below a class of Blender."""
    for cls in base.__subclasses__():
        yield from below(cls, package)
        if cls.__module__.startswith(package) and getattr(cls, "is_registered", False):
            yield cls


def titled(package="thenar_blender"):
    """(`Class.property`, RNA property) of all that a user can meet: those with a title of their own."""
    for base in (bpy.types.Operator, bpy.types.PropertyGroup, bpy.types.AddonPreferences):
        for cls in below(base, package):
            own = {name for each in cls.__mro__ if each.__module__.startswith(package)
                   for name in inspect.get_annotations(each)}  # fmt: skip
            for prop in rna_of(cls).properties:
                if prop.identifier in own and not prop.is_hidden and prop.name != prop.identifier:
                    yield f"{cls.__name__}.{prop.identifier}", prop


def rna_of(cls):
    if not issubclass(cls, bpy.types.Operator):
        return cls.bl_rna
    area, _, verb = cls.bl_idname.partition(".")
    return getattr(getattr(bpy.ops, area), verb).get_rna_type()


def lacks(prop):
    """What a property does not say: `tooltip`, `unit`, or nothing."""
    if not prop.description.strip():
        return "tooltip"
    if prop.type != "FLOAT" or prop.unit != "NONE" or prop.subtype in {"FACTOR", "PERCENTAGE", "COLOR", "ANGLE"}:
        return ""
    words = f"{prop.name} {prop.description}"
    return "" if re.search(rf"(?<!\w)(?:{UNITS})(?!\w)", words) else "unit"


def test_every_property_has_a_tooltip_and_its_unit(scene):
    rows = dict(titled())
    assert len(rows) > 150
    found = {name: lacks(prop) for name, prop in rows.items() if lacks(prop)}
    missing = {name: what for name, what in found.items() if what == "tooltip" or name not in WITHOUT_UNIT}
    assert not missing, "\n".join(f"{name}: no {what}" for name, what in missing.items())
    assert WITHOUT_UNIT.keys() <= found.keys(), "these have a unit, or are no more"


def test_planted_properties_without_tooltip_or_unit_are_found():
    number = {"type": "FLOAT", "unit": "NONE", "subtype": "NONE"}
    assert lacks(SimpleNamespace(name="Length", description="", **number)) == "tooltip"
    assert lacks(SimpleNamespace(name="Length", description="Of the hand", **number)) == "unit"
    assert lacks(SimpleNamespace(name="Length (mm)", description="Of the hand", **number)) == ""
    assert lacks(SimpleNamespace(name="Length", description="Of the hand", **{**number, "unit": "LENGTH"})) == ""


class PlantedGroup(bpy.types.PropertyGroup):
    """A group of another package, whose number lacks a unit."""

    __module__ = "planted_package.settings"
    __annotations__ = {"length": bpy.props.FloatProperty(name="Length", description="Of the hand")}


def test_a_planted_group_of_the_add_on_is_walked(scene):
    """A walk that misses a class would pass by mistake."""
    bpy.utils.register_class(PlantedGroup)
    try:
        assert lacks(dict(titled("planted_package"))["PlantedGroup.length"]) == "unit"
    finally:
        bpy.utils.unregister_class(PlantedGroup)


def test_every_operator_of_the_add_on_is_in_the_manual_s_list(scene):
    """The manual and the tooltips of operators are checked for `bpy.ops.thenar`: no operator is elsewhere."""
    own = list(below(bpy.types.Operator))
    assert len(own) > 60
    assert not [cls.bl_idname for cls in own if not cls.bl_idname.startswith("thenar.")]
    assert {cls.bl_idname.partition(".")[2] for cls in own} <= set(dir(bpy.ops.thenar))
    assert all(rna_of(cls).description.strip() for cls in own)
