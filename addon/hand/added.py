"""Takes back what a computation added to the file, if it ends before it is whole."""

from contextlib import contextmanager

import bpy

_KINDS = ("scenes", "collections", "objects", "meshes", "armatures", "cameras", "lights", "materials", "node_groups")
_KINDS += ("worlds", "images", "textures", "curves", "actions", "texts")
"""Where in `bpy.data` things are added, what uses others first."""
_UNITS = ("system", "length_unit", "scale_length", "system_rotation", "mass_unit", "time_unit", "temperature_unit")


@contextmanager
def taken_back_unless_whole(context):
    """What is added within stays if the block ends well; else the file has only what it had, its scene's units and its
    active object too.

    Values of the scene that are set at the end of the block are not looked after.
    """
    before = {kind: set(getattr(bpy.data, kind)) for kind in _KINDS}
    scene, window = context.scene, context.window
    active = context.view_layer.objects.active
    units = {name: getattr(scene.unit_settings, name) for name in _UNITS}
    try:
        yield
    except BaseException:
        if window is not None:
            window.scene = scene
        added = [each for kind in _KINDS for each in set(getattr(bpy.data, kind)) - before[kind]]
        bpy.data.batch_remove(added)
        for name, value in units.items():
            setattr(scene.unit_settings, name, value)
        scene.view_layers[0].objects.active = active
        scene.view_layers[0].update()
        raise
