"""Layout of the grasp's part of the sidebar tab."""

import bpy

from .. import status
from ..languages import iface
from ..panels.main import Tab


class THENAR_PT_grasp(Tab, bpy.types.Panel):
    """How the hand holds the product."""

    bl_label = "Grasp"
    bl_parent_id = "THENAR_PT_hand"

    @classmethod
    def poll(cls, context):
        return not status.native_problem

    def draw(self, context):
        layout, stored = self.layout, context.scene.thenar_grasps
        row = layout.row(align=True)
        row.scale_y = 1.2
        row.operator("thenar.fit_grasp", text="Grasp", icon="CON_ARMATURE").place = "LAY"
        row = layout.row(align=True)
        for text, strength in (("Light (current pose)", "LIGHT"), ("Firm (current pose)", "FIRM")):
            button = row.operator("thenar.fit_grasp", text=text)
            button.place, button.strength = "KEEP", strength
        if stored.found:
            _draw_found(layout, stored)
        box = layout.column()
        box.use_property_split = True
        box.use_property_decorate = False
        for name in ("weight_n", "total_n", "friction"):
            box.prop(stored, name)
        box.operator("thenar.settle_grasp", icon="CON_FLOOR")


def _draw_found(layout, stored):
    """A row for each grasp found: which is shown, what it carries, and whether it holds."""
    column = layout.column(align=True)
    for index, row in enumerate(stored.found):
        icon = "CHECKMARK" if row.friction <= stored.friction else "ERROR"
        slips = row.friction > stored.friction
        words = "{force_n:.0f} N, {net_n:.0f} N left over, friction {friction:.2f}"
        words = "{force_n:.0f} N, {net_n:.0f} N left over, slips" if slips else words
        kind = f"{iface(row.kind.capitalize())}, " if row.kind else ""
        numbers = iface(words, force_n=row.total_n, net_n=row.net_n, friction=row.friction)
        text = f"{index + 1}: {kind}{numbers}"
        column.operator("thenar.use_grasp", text=text, icon=icon, depress=stored.shown == index).index = index


CLASSES = (THENAR_PT_grasp,)
