"""Grasp data sets: poses of MANO and SMPL-X read, contacts written in their layout. Registration only."""

import bpy

from . import operators


def register():
    """Register the operators."""
    for cls in operators.CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    """Unregister them again."""
    for cls in reversed(operators.CLASSES):
        bpy.utils.unregister_class(cls)
