"""Where a computation in steps works, and what it adds to the file: taken back if it ends before it is whole."""

from contextlib import contextmanager
from functools import partial

import bpy

from ..scene.checks import Refusal

_KINDS = ("scenes", "collections", "objects", "meshes", "armatures", "cameras", "lights", "materials", "node_groups")
_KINDS += ("worlds", "images", "textures", "curves", "actions", "texts")
"""Where in `bpy.data` things are added, what uses others first."""
_UNITS = ("system", "length_unit", "scale_length", "system_rotation", "mass_unit", "time_unit", "temperature_unit")


@contextmanager
def taken_back_unless_whole(context):
    """An `Own` for the block, which does its work in turns of it. If the block does not end well, what these added is
    removed and the scene has its units and its active object again; what others added meanwhile stays.

    Values of the scene that are set at the end of the block are not looked after.
    """
    own = Own(context)
    try:
        yield own
    except BaseException:
        own.take_back()
        raise


class Own:
    """The scene and the view layer that the window shows now, and what is added to the file in turns.

    Every turn works in this `scene`, whatever the window shows by then.
    """

    def __init__(self, context):
        self._context = context
        self.scene, self._layer = context.scene, context.view_layer
        self._active = self._layer.objects.active
        self._units = {name: getattr(self.scene.unit_settings, name) for name in _UNITS}
        self._first = self.scene, self._layer
        self._added = {kind: set() for kind in _KINDS}

    def in_turns(self, run):
        """The steps `run`, each of them a turn. Returns their outcome."""
        go = partial(next, run)
        while True:
            with self.turn():
                try:
                    work = go()
                except StopIteration as end:
                    return end.value
            try:
                go = partial(run.send, (yield work))
            except BaseException as error:
                go = partial(run.throw, error)

    @contextmanager
    def turn(self):
        """The block works in the scene, and what it adds counts as added. Raises `Refusal` if the scene is gone."""
        if self.scene not in bpy.data.scenes.values():
            raise Refusal("the scene was removed while Thenar added to it; start again")
        with self._noted(), self._context.temp_override(scene=self.scene, view_layer=_alive(self.scene, self._layer)):
            yield

    def move_to_new_scene(self, name):
        """Go on in a scene of its own, which the window shows."""
        with self._noted():
            self.scene = bpy.data.scenes.new(name)
        self._layer = self.scene.view_layers[0]
        self._context.window.scene = self.scene

    def is_shown(self):
        """Whether the window shows the scene."""
        return self._context.scene == self.scene

    def take_back(self):
        """Remove what was added, as far as it is still there."""
        scene, layer = self._first
        added = [each for kind in _KINDS for each in self._added[kind] & set(getattr(bpy.data, kind))]
        if scene not in bpy.data.scenes.values():
            bpy.data.batch_remove([each for each in added if not isinstance(each, bpy.types.Scene)])
            return
        layer = _alive(scene, layer)
        manager = self._context.window_manager
        for window in manager.windows if manager is not None else ():
            if window.scene in added:
                window.scene, window.view_layer = scene, layer
        is_active = layer.objects.active in added
        bpy.data.batch_remove(added)
        for name, value in self._units.items():
            setattr(scene.unit_settings, name, value)
        if is_active and self._active in layer.objects.values():
            layer.objects.active = self._active
        layer.update()

    @contextmanager
    def _noted(self):
        before = {kind: set(getattr(bpy.data, kind)) for kind in _KINDS}
        try:
            yield
        finally:
            for kind in _KINDS:
                self._added[kind] |= set(getattr(bpy.data, kind)) - before[kind]


def _alive(scene, layer):
    """The view layer, or the scene's first one where it was removed."""
    layers = scene.view_layers.values()
    return layer if layer in layers else layers[0]
