"""Layout of the grasp's part of the sidebar tab."""

import bpy

from .. import status
from ..grasp_choices import panel as choices
from ..grasp_targets import panel as targets
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
            choices.draw(layout, context)
        box = layout.column()
        box.use_property_split = True
        box.use_property_decorate = False
        box.prop(stored, "moves")
        box.prop(context.scene.thenar_targets, "kind")
        if context.scene.thenar_targets.kind != "TOTAL":
            targets.draw(box, context)
            return
        for name in ("weight_n", "total_n", "friction"):
            box.prop(stored, name)
        box.operator("thenar.settle_grasp", icon="CON_FLOOR")


CLASSES = (THENAR_PT_grasp,)
