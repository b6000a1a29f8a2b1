"""Soft grips: what a part of the product is covered with, and its numbers for the library."""

from typing import TypeAlias

from bpy.props import EnumProperty, FloatProperty, StringProperty
from bpy.types import Object, PropertyGroup

from .. import native

Numbers: TypeAlias = tuple[float, float, float]
"""Thickness (mm), Young's modulus (MPa) and Poisson's ratio."""

RIGID, SHORE_A, CUSTOM = "RIGID", "SHORE_A", "CUSTOM"
_RUBBER_POISSON = 0.49


def _presets() -> dict[str, dict]:
    """The library's presets by name, empty where the library is missing."""
    maker = getattr(native.module, "Elastomer", None)
    return {} if maker is None else {row["name"]: row for row in maker.presets()}


PRESETS = _presets()


def _items() -> tuple[tuple[str, str, str], ...]:
    known = ((name.upper(), row["title"], _told(row)) for name, row in PRESETS.items())
    return (
        (RIGID, "Rigid", "The product does not yield"),
        *known,
        (SHORE_A, "Shore A Hardness", "A rubber by its hardness; E by Gent (1958), 1.5 times more or less by compound"),
        (CUSTOM, "Custom", "A linear elastic material by Young's modulus and Poisson's ratio"),
    )


def _told(row: dict) -> str:
    return f"E {row['youngs_mpa']:.3g} MPa, Poisson's ratio {row['poisson_ratio']:g}: {row['source']}"


class ThenarGrip(PropertyGroup):
    """`object.thenar.grip`: the soft layer on a part of the product."""

    material: EnumProperty(name="Grip", description="What covers the product, bonded to a rigid core", items=_items())
    thickness_mm: FloatProperty(
        name="Thickness (mm)",
        description="Of the soft layer, inward from the product's surface to its rigid core",
        default=3.0,
        min=0.1,
        soft_max=20.0,
        max=1000.0,
        precision=2,
    )
    hardness: FloatProperty(name="Shore A", description="Hardness of the rubber", default=40.0, min=20.0, max=80.0)
    youngs_mpa: FloatProperty(
        name="E (MPa)",
        description="Young's modulus of the soft layer at small strain",
        default=1.0,
        min=0.001,
        max=1e5,
        precision=3,
    )
    poisson_ratio: FloatProperty(
        name="Poisson Ratio",
        description="Near 0.49 for rubbers, near 0 for foams and cork",
        default=0.3,
        min=0.0,
        max=0.5,
    )
    group: StringProperty(
        name="Group", description="Vertex group that the grip covers, from weight 0.5 on; empty: the whole part"
    )


def numbers(part: Object) -> Numbers | None:
    """The grip of a part, or None where it is rigid."""
    grip = part.thenar.grip
    if grip.material == RIGID:
        return None
    if grip.material == CUSTOM:
        return grip.thickness_mm, grip.youngs_mpa, grip.poisson_ratio
    if grip.material == SHORE_A:
        made = native.module.Elastomer.of_shore_a(grip.hardness, grip.thickness_mm, _RUBBER_POISSON)
        return made.thickness_mm, made.youngs_mpa, made.poisson_ratio
    row = PRESETS[grip.material.lower()]
    return grip.thickness_mm, row["youngs_mpa"], row["poisson_ratio"]


def shown(part: Object) -> tuple[object, ...]:
    """What a change of makes a result out of date."""
    found = numbers(part)
    return () if found is None else (*found, part.thenar.grip.group)


CLASSES = (ThenarGrip,)
