"""Layout of the pictures' part of the sidebar tab."""

import bpy

from .. import status, tabs
from ..panels import text
from ..panels.main import Tab
from . import operators, order

_ICONS = {
    order.GRIP: "IMAGE_DATA",
    order.CARD: "FILE_TEXT",
    order.TURN: "FILE_MOVIE",
    order.UNROLLED: "UV",
    order.GLASS: "VIEW_PAN",
    order.LIVE: "PLAY",
}


class THENAR_PT_pictures(Tab, bpy.types.Panel):
    """Pictures of the result, each by one button."""

    bl_label = "Pictures"
    bl_parent_id = "THENAR_PT_main"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 3

    @classmethod
    def poll(cls, context):
        is_solved = not status.native_problem and context.scene.thenar.result.is_valid
        return is_solved and tabs.shows(context, tabs.RESULT)

    def draw(self, context):
        layout, chosen = self.layout, context.scene.thenar_pictures
        column = layout.column(align=True)
        for kind, title, _ in order.KINDS:
            column.operator("thenar.picture", text=title, icon=_ICONS[kind]).kind = kind
        column = layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        column.prop(chosen, "folder")
        if not operators.has_folder(chosen):
            text.paragraph(column, context, "Save the file first, or choose a folder", "INFO")
        column.prop(chosen, "height")
        column.prop(chosen, "with_percentiles")
        column.prop(chosen, "film_frames")
        if operators.last_made():
            layout.operator("thenar.open_picture", icon="HIDE_OFF")


CLASSES = (THENAR_PT_pictures,)
