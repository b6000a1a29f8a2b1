"""Presets of materials, soft grips, map looks and effects as files that users save and share. Registration only."""

import bpy

from . import menus, operators

CLASSES = (*operators.CLASSES, *menus.CLASSES)


def register():
    """Register operators and menus."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    """Unregister them again."""
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
