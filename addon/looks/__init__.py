"""View buttons: hand opened, palm, product, apart. Only what is looked at changes, never hand, product or result."""

import bpy

from .. import status
from . import operators, putting


def register():
    """Register the operators; a look follows the map that is shown."""
    for cls in operators.CLASSES:
        bpy.utils.register_class(cls)
    status.map_changed.append(putting.renew)


def unregister():
    """Unregister them again."""
    status.map_changed.remove(putting.renew)
    for cls in reversed(operators.CLASSES):
        bpy.utils.unregister_class(cls)
