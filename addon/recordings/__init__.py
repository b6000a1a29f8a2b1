"""Recordings in a scene: loaded, placed on the product, compared with the simulation, reported. Registration only."""

import bpy

from . import frames, operators, panel, settings, showing

CLASSES = (*settings.CLASSES, *operators.CLASSES, *panel.CLASSES)


def register():
    """Register properties, operators and panels; the tab they stand in must be registered."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    settings.register_properties()
    frames.register()
    showing.register()


def unregister():
    """Unregister them again."""
    showing.unregister()
    frames.unregister()
    settings.unregister_properties()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
