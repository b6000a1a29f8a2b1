"""The panel of effects: physics beyond the base model."""

import bpy

from .. import maps, names
from ..languages import iface
from ..presets import kinds, menus
from ..properties import effect_settings
from ..results import sentences
from .main import OfHand

NAME_SHARE = 0.72
"""Of a row's width, what the effect's name takes."""


class THENAR_UL_effects(bpy.types.UIList):
    """Effects of the hand: switch, name, place, amplitude."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_name):  # noqa: PLR0913 - Blender's
        split = layout.split(factor=NAME_SHARE)
        row = split.row(align=True)
        row.prop(item, "is_on", text="")
        words = row.row()
        words.active = item.is_on
        place = f", {iface(sentences.region_title(item.region))}" if item.region else ""
        words.label(text=iface(effect_settings.title(item.name)) + place)
        number = split.row()
        number.active = item.is_on
        number.prop(item, "amplitude", text="", slider=True)


class THENAR_PT_effects(OfHand, bpy.types.Panel):
    """What the skin does beyond the base model."""

    bl_label = "Effects"
    bl_order = 4

    def draw(self, context):
        layout, hand = self.layout, context.scene.thenar.hand
        state = hand.thenar
        row = layout.row()
        row.template_list("THENAR_UL_effects", "", state, "effects", state, "effect_index", rows=3)
        side = row.column(align=True)
        side.operator_menu_enum("thenar.effect_add", "kind", text="", icon="ADD")
        side.operator("thenar.effect_remove", text="", icon="REMOVE")
        menus.draw_row(layout, kinds.EFFECTS)
        if not state.effects:
            return
        layout.use_property_split = True
        layout.use_property_decorate = False
        _draw_effect(layout, state.effects[min(state.effect_index, len(state.effects) - 1)], hand)
        if effect_settings.is_on(hand, names.FRICTION):
            layout.column(align=True).prop(context.scene.thenar, "slide_mm")


def _draw_effect(layout, effect, hand):
    column = layout.column(align=True)
    if effect_settings.acts_over_time(effect.name, effect_settings.chosen(effect)):
        column.label(text="Time-dependent: needs a bake", icon="TIME")
    if hand.thenar.materials:
        column.prop_search(effect, "region", hand.thenar, "materials", icon="GROUP_VERTEX")
    for choice in effect.choices:
        column.prop(choice, "value", text=effect_settings.title(choice.name))
    for number in effect_settings.shown_numbers(effect):
        unit = "" if number.unit == "1" else f" ({number.unit})"
        column.prop(number, "value", text=iface(effect_settings.title(number.name)) + unit)
    if effect_settings.can_be_painted(effect.name):
        row = column.row(align=True)
        row.prop_search(effect, "painted", hand, "vertex_groups", icon="BRUSH_DATA")
        row.operator("thenar.paint_thickness", text="", icon="BRUSHES_ALL")
        if effect.painted:
            column.prop(effect, "painted_full", text="Weight 1 (mm)")
            lines = column.column(align=True)
            lines.active = False
            lines.label(text=iface("Weight 0.5 is {mm:.3g} mm", mm=effect.painted_full / 2))
            lines.label(text="Weight 0 takes the number above")
            row = column.row(align=True)
            row.operator("thenar.show_map", text="Show Thickness", icon="SHADING_RENDERED").kind = maps.THICKNESS


CLASSES = (THENAR_UL_effects, THENAR_PT_effects)
