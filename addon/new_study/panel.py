"""The panel of a new study: what was found, what is asked, and the button that writes. Layout only."""

import bpy

from .. import tabs
from ..languages import iface
from ..panels import start, text
from ..panels.main import Tab
from . import drafting, settings, writing

_ROLES = {"time": "Time", "depth": "Depth", "force": "Force"}


class THENAR_PT_new_study(Tab, bpy.types.Panel):
    """A study that is being made from files."""

    bl_label = "New Study"
    bl_parent_id = "THENAR_PT_main"
    bl_order = 5

    @classmethod
    def poll(cls, context):
        return context.scene.thenar_new_study.is_open and tabs.shows(context, tabs.RECORD)

    def draw(self, context):
        layout, state = self.layout, context.scene.thenar_new_study
        layout.use_property_decorate = False
        layout.prop(state, "title")
        layout.label(text=iface("{count} recordings; repeats share a number", count=len(state.files)))
        _draw_files(layout.box().column(align=True), state)
        for head in state.columns:
            _draw_columns(layout.box().column(align=True), context, state, head)
        layout.use_property_split = True
        used = sorted({item.protocol for item in state.files})
        for number in used[: settings.MOST_PROTOCOLS]:
            _draw_protocol(layout.box().column(align=True), number, state.protocols[number - 1])
        _draw_skin(layout.column(align=True), context, state)
        _draw_write(layout, context, state)


def _draw_files(column, state):
    """Each recording with the number of its protocol."""
    for number, item in enumerate(state.files):
        row = column.row(align=True)
        split = row.split(factor=0.8, align=True)
        split.label(text=item.name, icon="ERROR" if item.problem else "CHECKMARK")
        split.prop(item, "protocol", text="")
        row.operator("thenar.leave_out_file", text="", icon="X").number = number


def _draw_columns(column, context, state, head):
    files = [item.name for item in state.files if item.head == head.name]
    words = "Columns of {file} and {more} more" if len(files) > 1 else "Columns of {file}"
    column.label(text=iface(words, file=files[0], more=len(files) - 1), icon="QUESTION")
    for role in head.asks.split():
        split = column.split(factor=0.66, align=True)
        split.prop_search(head, role, head, "headers", text=_ROLES[role])
        split.prop(head, f"{role}_unit", text="")
    if "depth" in head.asks:
        column.prop(head, "depth_zero", text="Depth 0")
        column.prop(head, "depth_reversed")
    if "force" in head.asks:
        column.prop(head, "force_reversed")


def _draw_protocol(column, number, protocol):
    column.label(text=f"{number}: {protocol.name}", icon="IPO_LINEAR")
    column.prop(protocol, "shape")
    if protocol.shape != "PLANE":
        row = column.row()
        row.alert = protocol.diameter_mm <= 0.0
        row.prop(protocol, "diameter_mm")
    if protocol.shape == "CYLINDER":
        column.prop(protocol, "turn_deg")


def _draw_skin(column, context, state):
    column.prop(state, "skin")
    if state.skin == settings.FLAT:
        column.prop(state, "thickness_mm")
        if state.thickness_mm == 0.0:
            text.faint(column, context, "0: very thick")
        return
    hand = context.scene.thenar.hand
    if hand is None:
        column.operator("thenar.make_hand", text="Make Hand", icon="VIEW_PAN")
        return
    is_picked = state.site_vertex >= 0
    words = iface("Site: vertex {vertex} (pick another)", vertex=state.site_vertex) if is_picked else "Pick Site"
    column.operator("thenar.pick_site", text=words, icon="CHECKMARK" if is_picked else "EYEDROPPER")
    if not is_picked and len(hand.thenar.materials):
        column.prop_search(state, "site_region", hand.thenar, "materials", text="or Region")


def _draw_write(layout, context, state):
    there = writing.in_the_way(state.folder, state.skin == settings.HAND)
    if there:
        box = layout.box().column(align=True)
        text.alert(box, context, iface("The folder holds {files} already", files=", ".join(there)))
        box.use_property_split = False
        box.prop(state, "replaces")
    problem = drafting.problem(context)
    if problem:
        text.paragraph(layout, context, problem, "INFO")
    row = layout.row(align=True)
    row.scale_y = start.BIG
    row.operator("thenar.write_study", icon="FILE_TICK")
    row.operator("thenar.discard_study", text="", icon="X")


CLASSES = (THENAR_PT_new_study,)
