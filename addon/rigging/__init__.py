"""Rigs of other makers in Blender: recognised digits drawn and corrected by clicks. Registration only."""

import bpy

from . import controls, joining, next_step, operators, overlay, region_map, regions

CLASSES = (*operators.CLASSES, *joining.CLASSES, *controls.CLASSES, *regions.CLASSES, *region_map.CLASSES)


def register():
    """Register the operators and the drawing of recognised digits; the hand's module must be registered."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    overlay.register()
    region_map.register()
    next_step.register()


def unregister():
    """Unregister them again."""
    next_step.unregister()
    region_map.unregister()
    overlay.unregister()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
