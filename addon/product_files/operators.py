"""Operators that read a product's file: from a file browser, or dropped on the 3D view."""

import bpy
from bpy_extras.io_utils import ImportHelper

from .. import tabs
from ..hand_shape import framing
from ..languages import report
from ..operators import polling, running, selecting
from ..scene import sizes
from . import formats, reading

_EXTENSIONS = tuple(formats.FORMATS)


class THENAR_OT_add_product(bpy.types.Operator, ImportHelper):
    """Read the product from a file (STL, OBJ, PLY, GLB, USD, FBX), choose it, and show its size in mm"""

    bl_idname = "thenar.add_product"
    bl_label = "Add Product"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: bpy.props.StringProperty(default=";".join(f"*{each}" for each in _EXTENSIONS), options={"HIDDEN"})
    filepath: bpy.props.StringProperty(
        name="File", description="The product's file: STL, OBJ, PLY, GLB, USD or FBX", subtype="FILE_PATH"
    )

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.wrong_mode(context), polling.busy(), polling.live(context))

    def invoke(self, context, event):
        """Ask for the file; one that was dropped is read at once."""
        if self.properties.is_property_set("filepath") and self.filepath:
            return self.execute(context)
        return ImportHelper.invoke(self, context, event)

    def execute(self, context):
        selecting.to_object_mode(context)
        added = running.attempt(self, reading.add_product, context, bpy.path.abspath(self.filepath))
        if added is None:
            return {"CANCELLED"}
        hand = context.scene.thenar.hand
        framing.frame(context, *added.parts, *([] if hand is None else [hand]))
        tabs.open_tab(context, tabs.SETUP)  # where its unit is asked
        self.report(*_told(added))
        running.redraw(context)
        return {"FINISHED"}


def _told(added):
    """Level and text of what was added, with the question about its unit where its size is unusual."""
    size, count = added.sizes, len(added.parts)
    long = sizes.length(size.product_mm)
    words = "Added '{name}', {long} long" if count == 1 else "Added a product of {count} parts, {long} long"
    text = report(words, name=added.parts[0].name, count=count, long=long)
    if not size.factors:
        return {"INFO"}, text
    right = sizes.length(size.factors[0] * size.product_mm)
    words = "{added}: {long} or {other}? Choose in the Thenar panel"
    return {"WARNING"}, report(words, added=text, long=long, other=right)


class THENAR_FH_product(bpy.types.FileHandler):
    """A product's file dropped on the 3D view."""

    bl_idname = "THENAR_FH_product"
    bl_label = "Product for Thenar"
    bl_import_operator = "thenar.add_product"
    bl_file_extensions = ";".join(_EXTENSIONS)

    @classmethod
    def poll_drop(cls, context):
        return context.area is not None and context.area.type == "VIEW_3D"


CLASSES = (THENAR_OT_add_product, THENAR_FH_product)
