"""The panel of recordings: list, placing, compare, what it found."""

import bpy

from .. import status, tabs
from ..curves import panel as over_time
from ..curves import tables
from ..languages import iface
from ..panels import start, text
from ..panels.main import Tab, has_hand
from ..product_objects.parts import product_parts
from . import settings

SHARE, PLACE_SHARE = 0.5, 0.45
"""Of a row's width, what the name of a measure, and of a worst place, takes."""


_ICONS = {settings.STUDY: "FILE_FOLDER", settings.PRINT: "VIEW_PAN"}


class THENAR_UL_recordings(bpy.types.UIList):
    """What was loaded."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_name):  # noqa: PLR0913 - Blender's
        layout.label(text=item.name, icon=_ICONS.get(item.kind, "MESH_GRID"))


class THENAR_PT_no_recordings(Tab, bpy.types.Panel):
    """Where recordings are loaded, until there is one."""

    bl_label = "Recordings"
    bl_parent_id = "THENAR_PT_main"
    bl_order = 6

    @classmethod
    def poll(cls, context):
        is_empty = has_hand(context) and not context.scene.thenar_recordings.items
        return is_empty and tabs.shows(context, tabs.RECORD)

    def draw(self, context):
        if not text.progress(self.layout):
            start.draw_studies(self.layout.column())


class THENAR_PT_recordings(Tab, bpy.types.Panel):
    """Recordings and the simulation, once there is one."""

    bl_label = "Recordings"
    bl_parent_id = "THENAR_PT_main"
    bl_order = 0

    @classmethod
    def poll(cls, context):
        is_loaded = not status.native_problem and bool(context.scene.thenar_recordings.items)
        return is_loaded and tabs.shows(context, tabs.RECORD)

    def draw(self, context):
        layout, state = self.layout, context.scene.thenar_recordings
        row = layout.row()
        row.template_list("THENAR_UL_recordings", "", state, "items", state, "index", rows=2)
        side = row.column(align=True)
        side.operator("thenar.load_recording", text="", icon="ADD")
        side.operator("thenar.new_study", text="", icon="FILE_NEW")
        side.operator("thenar.remove_recording", text="", icon="REMOVE")
        item = settings.chosen(context)
        text.faint(layout, context, item.about)
        if item.kind != settings.STUDY and not (has_hand(context) and product_parts(context.scene.thenar)):
            text.faint(layout, context, "Set hand and product first; then the mat is placed on the product here")
            return
        if item.kind != settings.STUDY:
            _draw_placing(layout, context, item)
        if text.progress(layout):
            return
        row = layout.row()
        row.scale_y = 1.3
        row.operator("thenar.compare", icon="MOD_DATA_TRANSFER")


def _draw_placing(layout, context, item):
    compared = context.scene.thenar_recordings.comparison
    layout.use_property_split = True
    layout.use_property_decorate = False
    placing, column = item.placing, layout.column(align=True)
    column.prop(placing, "on")
    column.prop(placing, "axis")
    if placing.on == "CYLINDER":
        column.prop(placing, "diameter_mm")
        column.prop(placing, "turn_deg")
        column.prop(placing, "shift_mm", index=0, text="Shift (mm)")
    else:
        column.prop(placing, "turn_deg", text="Turn (°)")
        column.prop(placing, "shift_mm")
    column.prop(placing, "is_mirrored")
    column = layout.column(align=True)
    if item.kind == settings.PRINT:
        for name in ("dpi", "cell_mm", "ink", "ink_kpa", "is_mirrored"):
            column.prop(item.print, name)
    else:
        column.prop(item, "frame_rule")
        if item.frames > 1:
            row = column.row(align=True)
            row.prop(item, "position", slider=True)
            row.prop(item, "follows_timeline", text="", icon="TIME")
        row = column.row()
        row.enabled = item.frame_rule == "NUMBER"
        row.prop(item, "frame", text=iface("of {count}", count=item.frames))
    layout.use_property_split = False
    over_time.draw(layout, context, tables.RECORDING)
    row = layout.row(align=True)
    row.operator("thenar.show_recording", text="Recording", icon="IMAGE_DATA")
    row.operator("thenar.show_residual", text="Residual")
    row.operator("thenar.outline_mat", text="", icon="MOD_WIREFRAME")
    if compared.is_valid and compared.recording == item.name and compared.frame not in (0, item.frame):
        words = "Compared was frame {old}; press Compare for frame {new}"
        text.faint(layout, context, iface(words, old=compared.frame, new=item.frame))


class THENAR_PT_comparison(Tab, bpy.types.Panel):
    """What the last comparison found."""

    bl_label = "Comparison"
    bl_parent_id = "THENAR_PT_recordings"

    @classmethod
    def poll(cls, context):
        return context.scene.thenar_recordings.comparison.is_valid

    def draw(self, context):
        layout, state = self.layout, context.scene.thenar_recordings.comparison
        text.paragraph(layout, context, state.sentence)
        _draw_measures(layout, context, state)
        if len(state.worst):
            layout.label(text="Largest residuals: click to select")
        column, group = layout.column(align=True), ""
        for number, place in enumerate(state.worst):
            if place.group != group:
                group = place.group
                text.paragraph(column, context, group)
            split = column.split(factor=PLACE_SHARE, align=True)
            split.operator("thenar.select_place", text=place.name).index = number
            split.label(text=place.residual)
        layout.operator("thenar.report", icon="TEXT").kind = "COMPARISON"


def _draw_measures(layout, context, state):
    column, group = layout.box().column(align=True), None
    for row in state.measures:
        if row.group != group:
            group = row.group
            text.paragraph(column, context, group)
            split = column.split(factor=SHARE)
            split.label(text="")
            _numbers(split, ("read", "simulated"))
        split = column.split(factor=SHARE)
        split.label(text=text.spoken(row.name) + (f" ({row.unit})" if row.unit else ""))
        _numbers(split, (row.measured, row.simulated))


def _numbers(split, texts):
    row = split.row()
    for entry in texts:
        cell = row.row()
        cell.alignment = "RIGHT"
        cell.label(text=iface(entry))


class THENAR_PT_comparison_notes(Tab, bpy.types.Panel):
    """What a reader should know."""

    bl_label = "Notes"
    bl_parent_id = "THENAR_PT_comparison"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return len(context.scene.thenar_recordings.comparison.notes) > 0

    def draw(self, context):
        for note in context.scene.thenar_recordings.comparison.notes:
            text.paragraph(self.layout, context, note.name, "DOT")


CLASSES = (
    THENAR_UL_recordings,
    THENAR_PT_no_recordings,
    THENAR_PT_recordings,
    THENAR_PT_comparison,
    THENAR_PT_comparison_notes,
)
