"""Which objects together are the product."""

from bpy.types import Object, PropertyGroup

from ..scene.checks import PRODUCT_TYPES


def product_parts(settings: PropertyGroup) -> list[Object]:
    """The objects that together are the product, in a fixed order, hand and Thenar's own copies left out."""
    parts = [settings.product] if settings.product is not None else []
    if settings.product_collection is not None:
        found = sorted(settings.product_collection.all_objects, key=lambda part: part.name)
        parts += [part for part in found if _is_part(part, settings) and part not in parts]
    return parts


def _is_part(part: Object, settings: PropertyGroup) -> bool:
    drawn = part.type in PRODUCT_TYPES or part.instance_type != "NONE"
    return drawn and part != settings.hand and not part.thenar.copy_of
