"""Rigs of other makers in Blender: recognised digits drawn and corrected by clicks. Registration only."""

import bpy

from . import operators, overlay, regions

CLASSES = (*operators.CLASSES, *regions.CLASSES)


def register():
    """Register the operators and the drawing of recognised digits; the hand's module must be registered."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    overlay.register()


def unregister():
    """Unregister them again."""
    overlay.unregister()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
