"""Products from files: which formats are read, how a file is checked and brought into the scene, and its operators."""

import bpy

from . import operators


def register():
    """Register the operators, and the drop of files on the 3D view."""
    for cls in operators.CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    """Unregister them again."""
    for cls in reversed(operators.CLASSES):
        bpy.utils.unregister_class(cls)
