"""The panel of materials by region."""

import bpy

from .. import maps
from ..presets import kinds, menus
from ..properties import material_settings
from . import text
from .main import OfHand


class THENAR_PT_materials(OfHand, bpy.types.Panel):
    """Materials of the skin by region."""

    bl_label = "Materials"
    bl_order = 3

    def draw(self, context):
        layout = self.layout
        state = context.scene.thenar.hand.thenar
        if state.materials:
            row = layout.row()
            row.template_list("THENAR_UL_materials", "", state, "materials", state, "material_index", rows=5)
            side = row.column(align=True)
            side.operator("thenar.region_add", text="", icon="ADD")
            side.operator("thenar.region_remove", text="", icon="REMOVE")
            layout.operator("thenar.region_preset", icon="PRESET")
            material = state.materials[min(state.material_index, len(state.materials) - 1)]
        else:
            layout.label(text="The whole mesh is one region", icon="MESH_DATA")
            material = state.default_material
            layout.operator("thenar.regions_from_bones", icon="ARMATURE_DATA")
        layout.operator("thenar.assign_regions", icon="GROUP_VERTEX")
        layout.operator("thenar.show_map", text="Show Thickness", icon="SHADING_RENDERED").kind = maps.THICKNESS
        _draw_material(layout, material, context)


def _draw_material(layout, material, context):
    layout.use_property_split = True
    layout.use_property_decorate = False
    menus.draw_row(layout, kinds.SKIN)
    layout.prop(material, "preset")
    text.faint(layout, context, material.bl_rna.properties["preset"].enum_items[material.preset].description)
    column = layout.column(align=True)
    for name in ("g0_kpa", "g_lim_kpa", "d_lim_mm", "poisson_ratio"):
        column.prop(material, name)
    if context.scene.thenar.model == "LAYER":
        for name in ("stiffening", *material_settings.ANATOMY):
            column.prop(material, name)
    else:
        column.prop(material, "zone_mm")
        for name in ("swelling_height_mm_per_n", "swelling_radius_mm", "swelling_width_mm"):
            column.prop(material, name)


CLASSES = (THENAR_PT_materials,)
