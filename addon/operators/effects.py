"""Operators that fill the list of effects."""

import bpy

from .. import languages, tissue
from ..properties import effect_settings
from . import polling, running

_ITEMS = []
"""The menu's items: Blender needs the texts of a dynamic list kept."""


def _kinds(_self, _context):
    _ITEMS[:] = [
        (name, effect_settings.title(name), f"{row['meaning'].capitalize()}. {row['source']}", number)
        for number, (name, row) in enumerate(effect_settings.offered().items())
    ]
    return _ITEMS


class THENAR_OT_effect_add(bpy.types.Operator):
    """Add an effect: physics beyond the base model"""

    bl_idname = "thenar.effect_add"
    bl_label = "Add Effect"
    bl_options = {"REGISTER", "UNDO"}

    kind: bpy.props.EnumProperty(name="Effect", description="Which effect to add", items=_kinds)

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_module(), polling.no_hand(context))

    def execute(self, context):
        state = context.scene.thenar.hand.thenar
        effect_settings.fill(state.effects.add(), effect_settings.offered()[self.kind])
        state.effect_index = len(state.effects) - 1
        return {"FINISHED"}


class THENAR_OT_effect_remove(bpy.types.Operator):
    """Remove the effect from the list"""

    bl_idname = "thenar.effect_remove"
    bl_label = "Remove Effect"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_effects(context))

    def execute(self, context):
        state = context.scene.thenar.hand.thenar
        state.effects.remove(min(state.effect_index, len(state.effects) - 1))
        state.effect_index = max(0, min(state.effect_index, len(state.effects) - 1))
        return {"FINISHED"}


class THENAR_OT_paint_thickness(bpy.types.Operator):
    """Paint the thickness over bone: make a vertex group from the current thickness, and enter Weight Paint"""

    bl_idname = "thenar.paint_thickness"
    bl_label = "Paint Thickness"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_module(), polling.no_effects(context), _cannot_be_painted(context))

    def execute(self, context):
        hand = context.scene.thenar.hand
        effect = _selected(hand)
        group = hand.vertex_groups.get(effect.painted)
        if group is None:
            group = running.attempt(self, tissue.paint, context, effect)
        if group is None:
            return {"CANCELLED"}
        hand.vertex_groups.active_index = group.index
        context.view_layer.objects.active = hand
        if hand.mode != "WEIGHT_PAINT":
            bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
        words = "Weight 1 of '{group}' is {mm:g} mm, weight 0.5 half of it"
        self.report({"INFO"}, languages.report(words, group=group.name, mm=effect.painted_full))
        return {"FINISHED"}


def _selected(hand):
    return hand.thenar.effects[min(hand.thenar.effect_index, len(hand.thenar.effects) - 1)]


def _cannot_be_painted(context):
    effect = _selected(context.scene.thenar.hand)
    painted = effect_settings.can_be_painted(effect.name)
    if painted:
        return ""
    name = languages.inside(effect_settings.title(effect.name))
    return languages.tip("{effect} has no field to paint; select bone", effect=name)


CLASSES = (THENAR_OT_effect_add, THENAR_OT_effect_remove, THENAR_OT_paint_thickness)
