"""The panel of soft grips."""

import bpy

from .. import tabs
from ..languages import iface
from ..presets import kinds, menus
from ..product_objects.parts import product_parts
from ..soft_grip import settings as grip_settings
from . import text
from .main import Tab, has_hand


class THENAR_PT_grip(Tab, bpy.types.Panel):
    """What the product is covered with."""

    bl_label = "Soft Grip"
    bl_parent_id = "THENAR_PT_main"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 4

    @classmethod
    def poll(cls, context):
        is_set = has_hand(context) and bool(product_parts(context.scene.thenar))
        return is_set and tabs.shows(context, tabs.SETUP)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        parts = product_parts(context.scene.thenar)
        for part in parts:
            column = layout.column(align=True)
            if len(parts) > 1:
                column.label(text=part.name, icon="OBJECT_DATA")
            _draw_grip(column, part, context)


def _draw_grip(column, part, context):
    grip = part.thenar.grip
    menus.draw_row(column, kinds.GRIP, part.name)
    column.prop(grip, "material")
    if grip.material == grip_settings.RIGID:
        return
    column.prop(grip, "thickness_mm")
    if grip.material == grip_settings.SHORE_A:
        column.prop(grip, "hardness")
    elif grip.material == grip_settings.CUSTOM:
        column.prop(grip, "youngs_mpa")
        column.prop(grip, "poisson_ratio")
    if part.type == "MESH":
        column.prop_search(grip, "group", part, "vertex_groups")
    _thickness, youngs_mpa, poisson_ratio = grip_settings.numbers(part)
    words = iface("E {youngs_mpa:.3g} MPa, Poisson's ratio {nu:g}, linear", youngs_mpa=youngs_mpa, nu=poisson_ratio)
    text.faint(column, context, words)


CLASSES = (THENAR_PT_grip,)
