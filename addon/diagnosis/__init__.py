"""The diagnosis in a scene: asked for, read as a letter, shown on the skin, switched on. Registration only."""

import bpy

from . import curves, freshness, operators, panel, settings

CLASSES = (*settings.CLASSES, *operators.CLASSES, *panel.CLASSES)


def register():
    """Register properties, operators and panels; the tab they stand in must be registered."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    settings.register_properties()


def unregister():
    """Unregister them again."""
    freshness.forget()
    curves.forget()
    settings.unregister_properties()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
