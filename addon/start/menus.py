"""Entries in Blender's own menus, so that search (F3) finds the operators: Add > Mesh, File > Import, Object."""

import bpy

from ..languages import iface
from ..looks import operators as looks


class THENAR_MT_object(bpy.types.Menu):
    """What Thenar does with hand and product"""

    bl_idname = "THENAR_MT_object"
    bl_label = "Thenar"
    bl_translation_context = "*"

    def draw(self, context):
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        for group in _GROUPS:
            for name in group:
                layout.operator(f"thenar.{name}")
            layout.separator()
        layout.operator("thenar.show_pressure")
        for kind, title, _, _ in looks.KINDS:
            layout.operator("thenar.look", text=iface("Look At {side}", side=iface(title))).kind = kind
        layout.operator("thenar.look_back")
        layout.separator()
        layout.operator("thenar.copy_debug_info")


_GROUPS = (
    ("add_sample", "add_product", "make_hand", "add_hand", "pick_hand", "pick", "guess_bones", "assign_regions"),
    ("blend_pose", "add_pose_library", "load_hand_pose"),
    ("fit_grasp", "settle_grasp", "solve", "refine_skin", "certify", "clear", "apply"),
    ("bake", "export", "export_contact_map", "export_bake", "load_recording", "new_study", "compare", "diagnose"),
)
"""Operators by what they are for."""


def _draw_add(self, context):
    self.layout.separator()
    self.layout.operator("thenar.make_hand", text="Hand", icon="VIEW_PAN")


def _draw_import(self, context):
    self.layout.operator("thenar.add_product", text="Product for Thenar (.stl, .obj, .ply, .glb, .usd, .fbx)")
    self.layout.operator("thenar.add_hand", text="Rigged Hand for Thenar (.glb, .fbx, .usd, .blend)")
    self.layout.operator("thenar.load_hand_pose", text="Hand Pose of MANO or SMPL-X (.npz, .npy, .json, .pkl)")
    self.layout.operator("thenar.load_recording", text="Pressure Recording or Study (Thenar)")
    self.layout.operator("thenar.new_study", text="New Study from Recordings (Thenar)")


def _draw_object(self, context):
    self.layout.separator()
    self.layout.menu(THENAR_MT_object.bl_idname)


CLASSES = (THENAR_MT_object,)
_PLACES = (
    ("VIEW3D_MT_mesh_add", _draw_add),
    ("TOPBAR_MT_file_import", _draw_import),
    ("VIEW3D_MT_object", _draw_object),
    ("VIEW3D_MT_object_context_menu", _draw_object),
)


def add():
    """Add the entries."""
    for menu, draw in _PLACES:
        getattr(bpy.types, menu).append(draw)


def remove():
    """Take them out again."""
    for menu, draw in _PLACES:
        getattr(bpy.types, menu).remove(draw)
