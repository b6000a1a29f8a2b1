"""First steps that no other room owns: take a hand that is there, entries in Blender's menus, debug info."""

import bpy

from . import debug_info, menus, picking

_MODULES = (picking, debug_info, menus)


def register():
    """Register the operators, and add the menus' entries."""
    for module in _MODULES:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)
    menus.add()


def unregister():
    """Take all of it out again."""
    menus.remove()
    for module in reversed(_MODULES):
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)
