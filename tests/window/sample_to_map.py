"""Drives a Blender window from an empty scene to the map on a sample, by clicks alone, with a stopwatch.

Not a test of pytest: a window is needed. `drive(bpy, ui)` is a generator that yields seconds to wait; `ui` clicks at
pixels of a window of 1600 x 1000 and takes pictures. Prints the seconds from the first click to the map.
"""

import time

LIMIT_S = 30.0
SAMPLE, SOLVE = (1165, 210), (1165, 335)
"""Where the buttons are in Blender 5.2's sidebar at its default width."""
LOOKS = {"opened": (1096, 304), "palm": (1215, 304), "product": (1096, 326), "apart": (1215, 326)}


def drive(bpy, ui):
    """Click the sample, then Solve; then each view button, with a picture of each step."""
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    for _ in range(2):
        ui.sidebar("Thenar")
        yield 2
    ui.shot("a0_start")
    began = time.monotonic()
    yield from press(ui, SAMPLE)
    yield from until(lambda: bpy.context.scene.thenar.hand is not None)
    yield 0.5
    sampled = time.monotonic() - began
    ui.shot("a1_sample")
    yield from press(ui, SOLVE)
    yield from until(lambda: bpy.context.scene.thenar.hand.thenar.shows_pressure)
    took = time.monotonic() - began
    yield 1.0
    ui.shot("a2_map")
    print(f"STOPWATCH sample {sampled:.1f} s, map {took:.1f} s of {LIMIT_S:g} s")
    for name, place in LOOKS.items():
        yield from press(ui, place)
        yield 2.0
        ui.shot(f"a3_{name}")


def press(ui, place):
    """Move onto a button, wait until the window has seen it, and click, as a hand does."""
    ui.move(place[0] - 4, place[1])
    yield 0.3
    ui.move(*place)
    yield 0.3
    ui.click(*place)


def until(holds, limit_s=120.0):
    """Wait until `holds()`; `AssertionError` after `limit_s`."""
    began = time.monotonic()
    while not holds():
        assert time.monotonic() - began < limit_s, "the window did not get there"
        yield 0.1
