"""Drives a Blender window through *Make Hand*: ended by Esc, made, undone; with the longest pause of the window.

Not a test of pytest: a window is needed. `drive(bpy, ui)` is a generator that yields seconds to wait; `ui` acts on a
window of 1600 x 1000 and takes pictures. A timer that is due every 20 ms says how long the window's thread worked
without a turn, in seconds of its own, which other programs do not change.
"""

import time

STILL_S = 0.5
"""Longest work of the window's thread in one go."""
FREE = (500, 600)
"""A place in the 3D view, over which keys are pressed."""


class Beat:
    """The longest work of the window's thread between two beats of a timer."""

    def __init__(self, bpy):
        self.longest, self._last = 0.0, time.thread_time()
        bpy.app.timers.register(self, first_interval=0.02)

    def __call__(self):
        now = time.thread_time()
        self.longest, self._last = max(self.longest, now - self._last), now
        return 0.02

    def start(self):
        """Forget what was."""
        self.longest, self._last = 0.0, time.thread_time()


def drive(bpy, ui):
    """Esc on the way, the whole hand, Ctrl+Z; a picture of each."""
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    bpy.ops.ed.undo_push(message="empty")
    for _ in range(2):
        ui.sidebar("Thenar")
        yield 2
    ui.move(*FREE)
    yield 1
    beat = Beat(bpy)
    begin(bpy)
    yield 0.2
    ui.shot("h0_on_the_way")
    ui.key("Escape")
    yield 1.5
    assert not bpy.data.objects, list(bpy.data.objects)
    ui.shot("h1_ended")
    beat.start()
    began = time.monotonic()
    begin(bpy)
    while bpy.context.scene.thenar.hand is None:
        assert time.monotonic() - began < 60.0
        yield 0.05
    took, still = time.monotonic() - began, beat.longest
    yield 1.5
    ui.shot("h2_made")
    print(f"STOPWATCH hand {took:.1f} s, the window's thread worked {still:.2f} s in one go, {STILL_S:g} s allowed")
    assert still < STILL_S
    ui.move(*FREE)
    yield 0.5
    ui.key("ctrl+z")
    yield 2.0
    ui.shot("h3_undone")
    assert not bpy.data.objects and bpy.context.scene.thenar.hand is None, list(bpy.data.objects)
    ui.key("ctrl+shift+z")
    yield 2.0
    assert bpy.context.scene.thenar.hand is not None
    ui.shot("h4_redone")


def begin(bpy):
    """Start *Make Hand* as a button does."""
    window = bpy.context.window_manager.windows[0]
    area = next(each for each in window.screen.areas if each.type == "VIEW_3D")
    region = next(each for each in area.regions if each.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.thenar.make_hand("INVOKE_DEFAULT")
