"""Layout of the hand's part of the sidebar tab."""

import bpy

from .. import tabs
from ..hand_bones import constrained, roles
from ..hand_shape import thumb_range
from ..languages import bone, iface
from ..panels.main import Tab, has_hand
from ..pose_library import panel as library


class THENAR_PT_hand(Tab, bpy.types.Panel):
    """A hand to press with, its pose, and its grasp."""

    bl_label = "Hand & Grasp"
    bl_parent_id = "THENAR_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return has_hand(context) and tabs.shows(context, tabs.SETUP)

    def draw(self, context):
        layout = self.layout
        row = layout.row(align=True)
        row.operator("thenar.make_hand", icon="VIEW_PAN")
        row.operator_menu_enum("thenar.add_sample", "kind", text="Sample", icon="SCENE_DATA")
        row = layout.row(align=True)
        row.operator_menu_enum("thenar.apply_pose", "name", text="Pose", icon="ARMATURE_DATA")
        row.operator("thenar.blend_pose", text="Blend")
        library.draw_button(layout, context)
        layout.operator("thenar.load_hand_pose", icon="IMPORT")
        armature = armature_of(context)
        if armature is not None and thumb_range.is_widened(armature):
            layout.label(text="Older file: the thumb may now turn further inward", icon="INFO")


class THENAR_PT_bones(Tab, bpy.types.Panel):
    """Which bone of the hand's armature is which."""

    bl_label = "Bones"
    bl_parent_id = "THENAR_PT_hand"
    bl_order = 2
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return armature_of(context) is not None

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        armature = armature_of(context)
        layout.operator("thenar.guess_bones", icon="VIEWZOOM")
        layout.operator("thenar.pick_digits", icon="RESTRICT_SELECT_OFF")
        layout.label(text="Selected bones are the")
        selected = layout.grid_flow(row_major=True, columns=3, align=True)
        for digit in ("thumb", *roles.FINGERS):
            selected.operator("thenar.assign_digit", text=digit.capitalize()).digit = digit
        layout.operator("thenar.join_bones", icon="CONSTRAINT_BONE")
        if constrained.is_muted(armature):
            layout.operator("thenar.back_to_controls", icon="LOOP_BACK")
        region_row = layout.row(align=True)
        region_row.operator("thenar.regions_from_bones", icon="GROUP_VERTEX")
        region_row.operator("thenar.show_regions", text="", icon="HIDE_OFF")
        layout.prop(armature.thenar_bones, "show_digits")
        layout.prop(armature.thenar_bones, "side")
        layout.prop(armature.thenar_bones, "axis")
        rows = layout.column()
        rows.use_property_split = False
        for digit in (roles.WRIST, *roles.FINGERS, "thumb"):
            _bones_of(rows, armature, digit)


SHARE = 0.32
"""Of a row's width, what the name of a part takes; the rest shows a bone's name."""


def _bones_of(layout, armature, digit):
    """Which bone is which of a digit's parts; its name stands above them, for beside each it would be cut."""
    column = layout.column(align=True)
    own = [role for role in roles.ROLES if role.partition("_")[0] == digit]
    if len(own) > 1:
        column.label(text=iface(digit.capitalize()))
    for role in own:
        split = column.split(factor=SHARE)
        name = split.row()
        name.alignment = "RIGHT"
        name.label(text=bone(role.rpartition("_")[2].capitalize()))
        split.prop_search(armature.thenar_bones, role, armature.data, "bones", text="")


def armature_of(context):
    """Armature of the scene's hand, or None."""
    hand = getattr(getattr(context.scene, "thenar", None), "hand", None)
    if hand is None:
        return None
    return next((m.object for m in hand.modifiers if m.type == "ARMATURE" and m.object is not None), None)


CLASSES = (THENAR_PT_hand, THENAR_PT_bones)
