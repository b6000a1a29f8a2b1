"""Force, area and peak over the frames of a bake or a recording: a picture, and clicks that show a frame."""

from . import operators, pictures


def register():
    """Register the operator."""
    operators.register()


def unregister():
    """Unregister it, and drop the pictures."""
    operators.unregister()
    pictures.forget()
