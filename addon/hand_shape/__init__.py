"""Shape and look of a made hand, editable after it was made. Registration only."""

import bpy

from . import panel, settings


def register():
    """Register the properties and the panel; the panel it hangs on must be registered."""
    settings.register()
    bpy.utils.register_class(panel.THENAR_PT_hand_shape)


def unregister():
    """Unregister them again."""
    bpy.utils.unregister_class(panel.THENAR_PT_hand_shape)
    settings.unregister()
