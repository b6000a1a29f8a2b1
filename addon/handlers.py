"""Application handlers: mark results out of date, play bakes, offer the command line."""

import bpy
from bpy.app.handlers import persistent

from . import cache, native, status, workflow
from .hand_shape import thumb_range
from .operators import running
from .properties import effect_settings, material_settings
from .scene import baked
from .terminal import command_line

_DELAY_S = 0.3
_state = {"command": None}


@persistent
def _scene_changed(scene, depsgraph=None):
    result = scene.thenar.result if scene is not None and hasattr(scene, "thenar") else None
    if result is None or not result.is_valid or bpy.app.background or status.run.stage or scene.thenar.live:
        return
    if bpy.app.timers.is_registered(_check):
        bpy.app.timers.unregister(_check)
    bpy.app.timers.register(_check, first_interval=_DELAY_S)


@persistent
def _file_loaded(*_):
    status.forget()
    baked.forget()
    thumb_range.forget()
    _objects_came()
    if bpy.context.scene is not None:
        _scene_changed(bpy.context.scene)


@persistent
def _objects_came(*_):
    for hand in bpy.data.objects:
        material_settings.bring_up_to_date(hand)
        if hand.library is None:
            effect_settings.bring_up_to_date(hand)
        if thumb_range.bring_up_to_date(hand):
            print(f"Thenar: the thumb of '{hand.name}' may now turn inward as far as in a new hand")


@persistent
def _file_is_saved(*_):
    for hand in bpy.data.objects:
        material_settings.mark(hand)


def _check():
    context = bpy.context
    if context.scene is None or status.run.stage:
        return
    screen = context.screen
    if screen is not None and screen.is_animation_playing:
        return
    was = status.is_stale(context.scene.name)
    is_old = workflow.is_out_of_date(context)
    if is_old and bpy.ops.thenar.look_back.poll():
        bpy.ops.thenar.look_back()  # it shows hand and product as they were solved
    if is_old != was:
        running.redraw(context)


@persistent
def _frame_changed(scene, depsgraph=None):
    if hasattr(scene, "thenar"):
        baked.play(scene, workflow.product_parts)


_HANDLERS = (
    ("frame_change_post", _frame_changed),
    ("depsgraph_update_post", _scene_changed),
    ("load_post", _file_loaded),
    ("blend_import_post", _objects_came),
    ("save_pre", _file_is_saved),
    ("undo_post", _scene_changed),
    ("redo_post", _scene_changed),
)


def register():
    """Hang the handlers in, each once, and offer `--command thenar`."""
    status.set_native_problem(native.problem())
    for event, handler in _HANDLERS:
        handlers = getattr(bpy.app.handlers, event, None)  # older versions have no blend_import_post
        if handlers is not None and handler not in handlers:
            handlers.append(handler)
    if not bpy.app.background:
        # An older file may be open already; its data can be read once the extension is in place. In background there
        # is no loop to run a timer, and bpy 4.5 hangs at exit if one was registered.
        bpy.app.timers.register(_objects_came, first_interval=0.0)
    elif hasattr(bpy.data, "objects"):
        _objects_came()
    if hasattr(bpy.utils, "register_cli_command"):
        _state["command"] = bpy.utils.register_cli_command("thenar", command_line.main)


def unregister():
    """Take them out, and drop derived state. Hands are marked: the next `register` takes what is not for older."""
    _file_is_saved()
    if _state["command"] is not None:
        bpy.utils.unregister_cli_command(_state["command"])
        _state["command"] = None
    for event, handler in _HANDLERS:
        handlers = getattr(bpy.app.handlers, event, ())
        if handler in handlers:
            handlers.remove(handler)
    for timer in filter(bpy.app.timers.is_registered, (_check, _objects_came)):
        bpy.app.timers.unregister(timer)
    cache.clear()
    baked.forget()
    status.forget()
