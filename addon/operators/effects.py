"""Operators that fill the list of effects."""

import bpy

from .. import effect_settings
from . import polling

_ITEMS = []
"""The menu's items: Blender needs the texts of a dynamic list kept."""


def _kinds(_self, _context):
    _ITEMS[:] = [
        (name, effect_settings.title(name), f"{row['meaning'].capitalize()}. {row['source']}", number)
        for number, (name, row) in enumerate(effect_settings.offered().items())
    ]
    return _ITEMS


class THENAR_OT_effect_add(bpy.types.Operator):
    """Switch an effect on: physics beyond the base model"""

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
    """Take the effect off the list"""

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


CLASSES = (THENAR_OT_effect_add, THENAR_OT_effect_remove)
