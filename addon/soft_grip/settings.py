"""Soft grips: what a part of the product is covered with, and its numbers for the library."""

from typing import TypeAlias

from bpy.props import EnumProperty, FloatProperty, StringProperty
from bpy.types import Object, PropertyGroup

from .. import native
from ..scene import regions

Numbers: TypeAlias = tuple[float, float, float]
"""Thickness (mm), Young's modulus (MPa) and Poisson's ratio."""

LEAST_WEIGHT = 0.5
"""A vertex belongs to the grip's group from this weight on."""
RIGID, SHORE_A, CUSTOM = "RIGID", "SHORE_A", "CUSTOM"
_RUBBER_POISSON = 0.49


def _presets() -> dict[str, dict]:
    """The library's presets by name, empty where the library is missing."""
    maker = getattr(native.module, "Elastomer", None)
    return {} if maker is None else {row["name"]: row for row in maker.presets()}


PRESETS = _presets()


_NUMBERS = {"cork": 10, "tpe": 11, "rubber": 12, "eva_foam": 13, "silicone": 14}
"""What files hold of a preset; never changed."""


def _items() -> tuple[tuple[str, str, str, str, int], ...]:
    known = []
    for name, number in _NUMBERS.items():
        row = PRESETS.get(name)
        known.append((name.upper(), row["title"] if row else name, _told(row) if row else "", "NONE", number))
    return (
        (RIGID, "Rigid", "The product does not yield", "NONE", 0),
        *known,
        (SHORE_A, "Shore A Hardness", "A rubber by its hardness; E by Gent (1958), 1.5 times more or less", "NONE", 1),
        (CUSTOM, "Custom", "A linear elastic material by Young's modulus and Poisson's ratio", "NONE", 2),
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
    grip = part.thenar.grip
    if grip.material == RIGID:
        return ()
    weights: object = None
    if grip.group and part.type == "MESH" and grip.group in part.vertex_groups:
        weights = regions.painted_weights(part, grip.group) >= LEAST_WEIGHT
    values = (grip.thickness_mm, grip.hardness, grip.youngs_mpa, grip.poisson_ratio)
    return (grip.material, *values, grip.group, weights)


CLASSES = (ThenarGrip,)
