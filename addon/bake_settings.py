"""Blender properties of a bake: what it found over its frames. The fields stand in the files beside the scene."""

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty


class ThenarBake(bpy.types.PropertyGroup):
    """`hand.thenar.bake`: sums of the bake that the hand plays."""

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


CLASSES = (ThenarBake,)
