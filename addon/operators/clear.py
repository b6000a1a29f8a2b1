"""Operators that take a contact away again, or make it part of the mesh."""

import bpy

from .. import workflow
from . import display, polling, running


class THENAR_OT_clear(bpy.types.Operator):
    """Remove shape key, attributes, colors and bake of Thenar, and move the product back"""

    bl_idname = "thenar.clear"
    bl_label = "Clear Contact"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_output(context), polling.live(context))

    def execute(self, context):
        display.hide(context)
        if running.attempt(self, workflow.clear, context) is None:
            return {"CANCELLED"}
        running.redraw(context)
        return {"FINISHED"}


class THENAR_OT_apply(bpy.types.Operator):
    """Apply the contact to the mesh's own shape and remove its shape key; pressure and result stay"""

    bl_idname = "thenar.apply"
    bl_label = "Apply Contact"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_output(context), polling.live(context))

    def execute(self, context):
        if running.attempt(self, workflow.apply, context) is None:
            return {"CANCELLED"}
        return {"FINISHED"}


CLASSES = (THENAR_OT_clear, THENAR_OT_apply)
