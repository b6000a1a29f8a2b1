"""When Live looks at the scene: after changes, in a timer of its own, never within itself, a render or another run.

Handlers only mark a scene; the timer solves. In background, where there are no timers, `follow_now` is called.
"""

import time
from contextlib import contextmanager

import bpy
from bpy.app.handlers import persistent

from .. import native, status, workflow
from ..operators import running
from ..scene.checks import Refusal
from . import nodes, session

_RATE_S = 1.0
_SETTLE_S = 0.5
"""So long after the last motion the contact is solved anew from nothing: it then is what Solve would leave."""
_sessions = {}
"""Scene name -> `session.Session`."""
_marked = set()
_state = {"busy": False, "rendering": False}
_times = {}


def follow_now(context):
    """Bring the contact of the context's scene to what the scene shows. Returns whether it was solved anew.

    Mistakes that the user can mend become the reason that the panel shows; the last contact then stays.
    """
    scene = context.scene
    if not _may_follow(scene):
        return False
    told = status.live.setdefault(scene.name, status.Following())
    began = time.perf_counter()
    with _alone():
        try:
            nodes.sweep(_followed())
            is_new = _follow(context, scene)
            told.problem = ""
        except (Refusal, *native.error_types()) as error:
            told.problem = running.sentence(error)
            return False
    if is_new:
        _count(scene.name, told, time.perf_counter() - began)
    return is_new


def settle_now(context):
    """Solve the resting scene from nothing. Returns whether it was; one that moved meanwhile is followed instead."""
    now = _sessions.get(context.scene.name)
    if follow_now(context) or now is None or not _may_follow(context.scene) or status.live[context.scene.name].problem:
        return False
    with _alone():
        try:
            return session.settle(context, now)
        except (Refusal, *native.error_types()) as error:
            status.live[context.scene.name].problem = running.sentence(error)
            return False


def switched(context):
    """Take up or leave a scene after its Live was switched."""
    scene = context.scene
    if scene.thenar.live:
        follow_now(context)
        return
    _sessions.pop(scene.name, None)
    status.live.pop(scene.name, None)
    with _alone():
        nodes.sweep(_followed())
        _leave(context)


def forget():
    """Drop every session; the next look at a scene begins anew."""
    _sessions.clear()
    _times.clear()
    _marked.clear()
    status.live.clear()


def _may_follow(scene):
    is_free = not (_state["rendering"] or _state["busy"] or status.run.stage)
    return is_free and scene is not None and scene.thenar.live


def _follow(context, scene):
    hand, parts = session.check(context)
    now = _sessions.get(scene.name)
    if now is not None and now.fits(hand, parts):
        if session.follow(context, now, hand, parts):
            return True
        if now.setup == session.setup_of(context, hand):
            return False
    _sessions.pop(scene.name, None)
    now = session.begin(context, hand, parts)
    _sessions[scene.name] = now
    return session.follow(context, now, hand, parts)


def _followed():
    """The hands that Live may keep its modifier on."""
    chosen = [scene.thenar.hand for scene in bpy.data.scenes if scene.thenar.live]
    return [hand for hand in chosen if hand is not None and hand.type == "MESH"]


def _leave(context):
    """Leave the contact as Solve would, where that can be."""
    hand = context.scene.thenar.hand
    if hand is None or hand.type != "MESH" or hand in _followed():
        return
    nodes.detach(hand)  # its offsets, too
    context.view_layer.update()
    try:
        workflow.solve(context)
    except (Refusal, *native.error_types()):
        status.set_stale(context.scene.name, True)


@contextmanager
def _alone():
    _state["busy"] = True
    try:
        yield
    finally:
        _state["busy"] = False


def _count(name, told, seconds):
    now = time.perf_counter()
    times = [moment for moment in _times.get(name, ()) if now - moment < _RATE_S] + [now]
    _times[name] = times
    told.rate = len(times) / _RATE_S
    told.ms = 1e3 * seconds if told.ms == 0.0 else 0.8 * told.ms + 200.0 * seconds


def _tick():
    if _state["rendering"] or _state["busy"] or status.run.stage:
        return 0.1 if _marked else None
    names = set(_marked)
    _marked.clear()
    if any(_in_windows(names, follow_now)):
        if bpy.app.timers.is_registered(_rest):
            bpy.app.timers.unregister(_rest)
        bpy.app.timers.register(_rest, first_interval=_SETTLE_S)
    return 0.0 if _marked else None


def _rest():
    list(_in_windows(set(_sessions), settle_now))


def _in_windows(names, action):
    """What `action(context)` returns in a window of each scene of `names` that a window shows."""
    done = set()
    for window in bpy.context.window_manager.windows:
        name = window.scene.name
        if name in names and name not in done:
            done.add(name)
            with bpy.context.temp_override(window=window):
                yield action(bpy.context)
                running.redraw(bpy.context)


def _mark(scene):
    if _state["busy"] or _state["rendering"] or scene is None or not scene.thenar.live:
        return
    _marked.add(scene.name)
    if not bpy.app.background and not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=0.0, persistent=True)


@persistent
def _changed(scene, depsgraph=None):
    _mark(scene)


@persistent
def _replaced(*_):
    """After undo, redo and loading the meshes may hold an older contact than the one that was written last."""
    _sessions.clear()
    for scene in bpy.data.scenes:
        _mark(scene)


@persistent
def _loaded(*_):
    """A file may have been saved by a process that did not end well, or by one without the extension."""
    with _alone():
        nodes.sweep(_followed())
    _replaced()


@persistent
def _render_began(*_):
    _state["rendering"] = True


@persistent
def _render_ended(scene, *_):
    _state["rendering"] = False
    _mark(scene)


_HANDLERS = (
    ("depsgraph_update_post", _changed),
    ("frame_change_post", _changed),
    ("undo_post", _replaced),
    ("redo_post", _replaced),
    ("load_post", _loaded),
    ("render_init", _render_began),
    ("render_complete", _render_ended),
    ("render_cancel", _render_ended),
)


def register():
    """Hang the handlers in, each once."""
    status.live_switched.append(switched)
    for event, handler in _HANDLERS:
        handlers = getattr(bpy.app.handlers, event)
        if handler not in handlers:
            handlers.append(handler)


def unregister():
    """Take them out, leave no modifier behind, and forget every session."""
    status.live_switched.remove(switched)
    for event, handler in _HANDLERS:
        handlers = getattr(bpy.app.handlers, event)
        if handler in handlers:
            handlers.remove(handler)
    for timer in (_tick, _rest):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    for scene in bpy.data.scenes:
        if scene.thenar.live:
            scene.thenar.result.state_hash = ""  # what it says is out of date from now on
    nodes.sweep()
    forget()
