"""Drives a Blender window from an empty scene over the sample study *Held Handle* to its letter, by clicks alone.

Not a test of pytest: a window is needed. `drive(bpy, ui)` is a generator that yields seconds to wait; `ui` clicks at
pixels of a window of 1600 x 1000 and takes pictures. The study is a whole hand on a cylinder: three holds recorded by a
mat and a force trace. Prints the seconds from the first click to the letter, and the letter's sentence.
"""

import json
import time

LIMIT_S = 180.0
SAMPLES, HELD_HANDLE, DIAGNOSE = (1165, 604), (1120, 675), (1165, 514)
"""Where the buttons are in Blender 5.2's sidebar at its default width."""


def drive(bpy, ui):
    """Choose the sample study from its menu, diagnose, read down the letter; a picture of each step."""
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    for _ in range(2):
        ui.sidebar("Thenar")
        yield 2
    ui.shot("h0_start")
    began = time.monotonic()
    scene, marks = bpy.context.scene, []

    def mark(name):
        marks.append(f"{name} {time.monotonic() - began:.1f} s")
        ui.shot(f"h{len(marks)}_{name}")

    yield from press(ui, SAMPLES)
    yield 1.5
    ui.shot("h0_menu")
    yield from press(ui, HELD_HANDLE)
    yield from until(lambda: len(scene.thenar_recordings.items) == 1)
    yield 1.5
    mark("study")
    yield from press(ui, DIAGNOSE)
    yield 3.0
    ui.shot("h2_diagnosing")
    yield from until(lambda: scene.thenar_diagnosis.is_valid)
    took = time.monotonic() - began
    yield 1.5
    mark("letter")
    print(f"STOPWATCH {', '.join(marks)}; letter {took:.1f} s of {LIMIT_S:g} s")
    print(f"LETTER {json.loads(scene.thenar_diagnosis.findings)['sentence']}")


def press(ui, place):
    """Move onto a button, wait until the window has seen it, and click, as a hand does."""
    ui.move(place[0] - 4, place[1])
    yield 0.3
    ui.move(*place)
    yield 0.3
    ui.click(*place)


def until(holds, limit_s=180.0):
    """Wait until `holds()`; `AssertionError` after `limit_s`."""
    began = time.monotonic()
    while not holds():
        assert time.monotonic() - began < limit_s, "the window did not get there"
        yield 0.1
