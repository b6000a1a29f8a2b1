"""Operators that take a contact away again, or make it part of the mesh."""

import bpy

from .. import workflow
from . import display, polling, running


class THENAR_OT_clear(bpy.types.Operator):
    """Remove shape key, attributes, colours and bake of Thenar, and put the product back in its place"""

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
    """Make the contact part of the mesh's own shape; pressure and result stay, the shape key goes"""

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
