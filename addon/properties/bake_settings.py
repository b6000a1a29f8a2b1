"""Blender properties of a bake: what it found over its frames. The fields stand in the files beside the scene."""

import bpy
from bpy.props import BoolProperty, CollectionProperty, FloatProperty, IntProperty, PointerProperty


class ThenarBakedPart(bpy.types.PropertyGroup):
    """`name`: a part's key in the files of a bake, which its object keeps when it is renamed."""

    object: PointerProperty(type=bpy.types.Object)


class ThenarBake(bpy.types.PropertyGroup):
    """`hand.thenar.bake`: sums of the bake that the hand plays."""

    parts: CollectionProperty(type=ThenarBakedPart)
    force_n: FloatProperty(
        name="Force", description="Normal force of the frame that plays, in newtons; keyed in every baked frame"
    )
    area_mm2: FloatProperty(
        name="Area", description="Contact area of the frame that plays, in mm2; keyed in every baked frame"
    )
    frame_peak_kpa: FloatProperty(
        name="Peak", description="Peak pressure of the frame that plays, in kPa; keyed in every baked frame"
    )
    frame_start: IntProperty()
    frame_end: IntProperty()
    follows: BoolProperty()
    """Whether frames remember those before them; else each is a press of its own."""
    peak_kpa: FloatProperty()
    peak_force_n: FloatProperty()
    peak_shear_n: FloatProperty()
    work_mj: FloatProperty()
    slip_loss_mj: FloatProperty()
    cycles: IntProperty()
    cycle_loss_mj: FloatProperty()
    """Mean of what the cycles lost, mJ."""
    cycle_loss_share: FloatProperty()
    """The same over the work that was done on the skin."""


CLASSES = (ThenarBakedPart, ThenarBake)
