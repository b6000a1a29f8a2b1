"""First steps that no other room owns: take a hand that is there, entries in Blender's menus, debug info."""

import bpy

from ..panels import manual
from . import debug_info, hand_file, menus, picking

_MODULES = (picking, hand_file, debug_info, menus)


def register():
    """Register the operators, add the menus' entries, and lead F1 to the manual."""
    for module in _MODULES:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)
    menus.add()
    bpy.utils.register_manual_map(manual.manual_map)


def unregister():
    """Take all of it out again."""
    bpy.utils.unregister_manual_map(manual.manual_map)
    menus.remove()
    for module in reversed(_MODULES):
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)
