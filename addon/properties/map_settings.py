"""Blender properties of the maps: which one is shown, and the ranges that are kept between solves."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty

from .. import maps, status


def _look_changed(_self, context):
    for refresh in status.look_changed:
        refresh(context)


def _range(name, meaning, default):
    return FloatProperty(
        name=name,
        description=f"{meaning} at the top of the color range",
        min=0.0,
        default=default,
        update=_look_changed,
    )


KINDS = tuple((row.kind, row.title, row.meaning, place) for place, row in enumerate(maps.MAPS.values()))


class ThenarMaps(bpy.types.PropertyGroup):
    """`scene.thenar.maps`: the map on the skin, and the tops of the ranges of all maps but the pressure's."""

    shown: EnumProperty(name="Map", description="Quantity that the colors on the skin show", items=KINDS)
    contour: BoolProperty(
        name="Contour",
        description="Draw a thin line where contact ends, in Material Preview, renders and bakes",
        default=True,
        update=_look_changed,
    )
    shear_kpa: _range("Range (kPa)", "Shear, kPa,", 50)
    depth_mm: _range("Range (mm)", "Depth, mm,", 5)
    reference_difference_kpa: _range("Range (kPa)", "Reference minus fast pressure, kPa,", 50)
    residual_kpa: _range("Range (kPa)", "Measured minus simulated pressure, kPa,", 50)
    thickness_mm: _range("Range (mm)", "Thickness, mm,", 20)


CLASSES = (ThenarMaps,)
