"""The row of presets in a panel: a menu to choose, a button to save, and a menu with the rest."""

import bpy

from . import kinds


class _Rest:
    """What is done with the files of one kind."""

    def draw(self, context):
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator("thenar.preset_import", icon="IMPORT")
        for name, icon in (("thenar.preset_export", "EXPORT"), ("thenar.preset_remove", "REMOVE")):
            layout.operator_menu_enum(name, "name", icon=icon).kind = self.kind


class THENAR_MT_skin_material_presets(_Rest, bpy.types.Menu):
    """Import, export and remove presets of skin materials"""

    bl_label = "Skin Material Presets"
    kind = kinds.SKIN


class THENAR_MT_soft_grip_presets(_Rest, bpy.types.Menu):
    """Import, export and remove presets of soft grips"""

    bl_label = "Soft Grip Presets"
    kind = kinds.GRIP


class THENAR_MT_map_look_presets(_Rest, bpy.types.Menu):
    """Import, export and remove presets of map looks"""

    bl_label = "Map Look Presets"
    kind = kinds.LOOK


class THENAR_MT_effects_presets(_Rest, bpy.types.Menu):
    """Import, export and remove presets of effects"""

    bl_label = "Effect Presets"
    kind = kinds.EFFECTS


def draw_row(layout, kind, part=""):
    """Menu, save and rest for presets of a kind; `part` of the product, where it is one's."""
    row = layout.row(align=True)
    row.use_property_split = False
    button = row.operator_menu_enum("thenar.preset_apply", "name", text="Presets", icon="PRESET")
    button.kind, button.part = kind, part
    button = row.operator("thenar.preset_save", text="", icon="ADD")
    button.kind, button.part = kind, part
    row.menu(f"THENAR_MT_{kind.lower()}_presets", text="", icon="DOWNARROW_HLT")


CLASSES = (
    THENAR_MT_skin_material_presets,
    THENAR_MT_soft_grip_presets,
    THENAR_MT_map_look_presets,
    THENAR_MT_effects_presets,
)
