"""A study made from recordings in the window: looked at, asked about, written as study.toml. Registration only."""

import bpy

from . import drafting, operators, panel, settings

CLASSES = (*settings.CLASSES, *operators.CLASSES, *panel.CLASSES)


def register():
    """Register properties, operators and the panel; the tab they stand in must be registered."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    settings.register_properties()
    settings.changed.append(drafting.refresh)


def unregister():
    """Unregister them again."""
    settings.changed.remove(drafting.refresh)
    settings.unregister_properties()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
