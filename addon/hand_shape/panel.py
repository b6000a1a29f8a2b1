"""Layout of a made hand's shape and look in the sidebar tab."""

import bpy

from .. import status
from ..panels import text
from ..panels.main import Tab
from . import skin_look


class THENAR_PT_hand_shape(Tab, bpy.types.Panel):
    """Size, side, skin and nails of the hand, editable after it was made."""

    bl_label = "Hand Shape"
    bl_parent_id = "THENAR_PT_hand"

    @classmethod
    def poll(cls, context):
        hand = context.scene.thenar.hand
        return not status.native_problem and hand is not None and hand.thenar_hand.is_made

    def draw(self, context):
        hand = context.scene.thenar.hand
        shape, layout = hand.thenar_hand, self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        if shape.problem:
            text.alert(layout, context, shape.problem)
        column = layout.column(align=True)
        column.row(align=True).prop(shape, "side", expand=True)
        column.row(align=True).prop(shape, "size", expand=True)
        _draw_size(layout.column(align=True), shape)
        _draw_look(layout.column(), shape, skin_look.has_skin(hand))


def _draw_size(column, shape):
    is_percentile = shape.size == "PERCENTILE"
    if is_percentile:
        column.row(align=True).prop(shape, "sex", expand=True)
        column.prop(shape, "percentile")
    measures = column.column(align=True)
    measures.enabled = not is_percentile
    measures.prop(shape, "length_mm")
    measures.prop(shape, "breadth_mm")


def _draw_look(column, shape, has_skin):
    """Fields of the look, faint on a hand that wears a material of the user's own."""
    column.enabled = has_skin
    column.prop(shape, "tone", slider=True)
    column.prop(shape, "age")
    column.prop(shape, "nails")
    if shape.nails == "POLISH":
        column.prop(shape, "polish")
