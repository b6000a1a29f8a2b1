"""The extension's preferences: what is loaded, or why it is not."""

import bpy

from .. import names, status
from . import text


class ThenarPreferences(bpy.types.AddonPreferences):
    """State of the native module, for support."""

    bl_idname = __package__.rpartition(".")[0]

    def draw(self, context):
        draw_state(self.layout, context)


def draw_state(layout, context):
    """Version and platform; the reason where the native module cannot be used."""
    problem = status.native_problem
    if problem:
        text.alert(layout.box(), context, problem)
    column = layout.column(align=True)
    column.label(text=f"Thenar {names.VERSION}", icon="ERROR" if problem else "CHECKMARK")
    column.label(text=status.where(), icon="BLANK1")


CLASSES = (ThenarPreferences,)
