"""The hand's own mesh made finer where a product is finer than its skin. Registration only."""

import bpy

from . import operators


def register():
    """Register the operator."""
    for cls in operators.CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    """Unregister it again."""
    for cls in reversed(operators.CLASSES):
        bpy.utils.unregister_class(cls)
