"""The first steps of a new user that no other room owns: take a hand that is there, menus, help."""

import bpy

from . import picking

_MODULES = (picking,)


def register():
    """Register the operators."""
    for module in _MODULES:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)


def unregister():
    """Unregister them again."""
    for module in reversed(_MODULES):
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)
