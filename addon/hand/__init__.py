"""The hand: made, posed, fitted to a product, and staged in sample scenes. Registration only."""

import bpy

from ..hand_bones import bonemap
from . import operators, panel

CLASSES = (bonemap.ThenarBoneMap, *operators.CLASSES, *panel.CLASSES)


def register():
    """Register operators, panels and the bone map on objects; the tab they stand in must be registered."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bonemap.register_properties()


def unregister():
    """Unregister them again."""
    bonemap.unregister_properties()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
