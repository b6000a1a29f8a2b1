"""Operators for a product whose file was read in the wrong unit."""

import bpy

from .. import workflow
from ..hand_shape import framing
from ..panels import start
from ..scene import sizes
from . import polling, running


class THENAR_OT_scale_product(bpy.types.Operator):
    """Scale the whole product to correct the unit in which its file was read"""

    bl_idname = "thenar.scale_product"
    bl_label = "Scale Product"
    bl_options = {"REGISTER", "UNDO"}

    factor: bpy.props.FloatProperty(name="Factor", description="Size after over size before", default=1e-3, min=1e-6)

    @classmethod
    def poll(cls, context):
        return _can_scale(cls, context)

    def execute(self, context):
        settings = context.scene.thenar
        parts = workflow.product_parts(settings)
        found = running.attempt(self, sizes.scale_product, context, settings.hand, parts, self.factor)
        if found is None:
            return {"CANCELLED"}
        framing.frame(context, *parts)
        self.report({"INFO"}, start.both(found))
        running.redraw(context)
        return {"FINISHED"}


class THENAR_OT_accept_size(bpy.types.Operator):
    """Keep the size of the product"""

    bl_idname = "thenar.accept_size"
    bl_label = "Accept Size"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return _can_scale(cls, context)

    def execute(self, context):
        settings = context.scene.thenar
        sizes.accept(context.scene, settings.hand, workflow.product_parts(settings))
        return {"FINISHED"}


def _can_scale(cls, context):
    return polling.allows(cls, polling.no_product(context), polling.busy())


CLASSES = (THENAR_OT_scale_product, THENAR_OT_accept_size)
