"""The grasp: searched, fitted, balanced, and chosen among several. Registration only."""

import bpy

from . import operators, panel, settings

CLASSES = (*settings.CLASSES, *operators.CLASSES, *panel.CLASSES)


def register():
    """Register operators and panels; the hand's must be registered."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    settings.register_properties()


def unregister():
    """Unregister them again."""
    settings.unregister_properties()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
