"""Layout: sidebar tab and preferences. Knows nothing of the workflow and the native module's insides."""

import bpy

from . import effects, grip, lists, main, materials, preferences, result

_MODULES = (preferences, lists, main, materials, effects, grip, result)


def register():
    """Register every panel."""
    for module in _MODULES:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)
    preferences.apply_threads(bpy.context)


def unregister():
    """Unregister them again."""
    for module in reversed(_MODULES):
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)
