"""Drives a Blender window from an empty scene and three CSV files to the letter of a diagnosis, by clicks and typing.

Not a test of pytest: a window is needed. `drive(bpy, ui)` is a generator that yields seconds to wait; `ui` clicks at
pixels of a window of 1600 x 1000, types and takes pictures. Only the recordings are made without clicks: three presses
of a ball on gel by Hertz, with noise, as a machine writes them whose lengths have no direction. They lie in the home
folder, where Blender's file browser opens. Prints the seconds from the first click to the letter.
"""

import json
import math
import os
import random
import time

LIMIT_S = 180.0
NEW, FILES, ACCEPT = (1165, 559), (700, 300), (1135, 614)
DIAMETER, WRITE, DIAGNOSE = (1205, 509), (1152, 615), (1165, 782)
"""Where buttons and fields are in Blender 5.2's sidebar and file browser at their default sizes."""
RADIUS_MM, SHEAR_MPA = 6.0, 0.012


def write_recordings(folder):
    """Three repeats of a press 0.8 mm deep at 1 mm/s, time in ms, travel in mm from any zero, force in mN."""
    for repeat in (1, 2, 3):
        draw = random.Random(repeat)
        gain = 1.0 + 0.01 * draw.gauss(0.0, 1.0)
        lines = ["Time (ms),Extension (mm),Load (mN)"]
        for number in range(101):
            t = 0.02 * number
            depth = 0.9 * (1.0 - abs(t - 1.0)) - 0.1
            newton = 16.0 / 3.0 * SHEAR_MPA * math.sqrt(RADIUS_MM) * max(depth, 0.0) ** 1.5
            reading = 1e3 * (gain * newton + 0.002 * draw.gauss(0.0, 1.0))
            lines.append(f"{1e3 * t:.0f},{depth + 3.0:.4f},{reading:.3f}")
        with open(os.path.join(folder, f"press_{repeat}.csv"), "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")


def drive(bpy, ui):
    """Choose the files, enter the ball's diameter, write the study, diagnose; a picture of each step."""
    write_recordings(os.environ["HOME"])
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    for _ in range(2):
        ui.sidebar("Thenar")
        yield 2
    ui.shot("c0_start")
    began = time.monotonic()
    scene, marks = bpy.context.scene, []

    def mark(name):
        marks.append(f"{name} {time.monotonic() - began:.1f} s")
        ui.shot(f"c{len(marks)}_{name}")

    yield from press(ui, NEW)
    yield 2.5
    ui.move(*FILES)
    yield 0.3
    ui.key("a")
    yield 1.0
    mark("files")
    yield from press(ui, ACCEPT)
    yield from until(lambda: scene.thenar_new_study.is_open)
    yield 1.5
    mark("asked")
    yield from press(ui, DIAMETER, clicks=2)
    yield 0.5
    ui.key("ctrl+a")
    ui.type(f"{2.0 * RADIUS_MM:g}")
    ui.key("Return")
    yield from until(lambda: scene.thenar_new_study.protocols[0].diameter_mm == 2.0 * RADIUS_MM)
    yield 1.0
    mark("answered")
    yield from press(ui, WRITE)
    yield from until(lambda: len(scene.thenar_recordings.items) == 1)
    yield 1.0
    mark("written")
    yield from press(ui, DIAGNOSE)
    yield 3.0
    ui.shot("c6_diagnosing")
    yield from until(lambda: scene.thenar_diagnosis.is_valid)
    took = time.monotonic() - began
    yield 1.5
    mark("letter")
    print(f"STOPWATCH {', '.join(marks)}; letter {took:.1f} s of {LIMIT_S:g} s")
    print(f"LETTER {json.loads(scene.thenar_diagnosis.findings)['sentence']}")


def press(ui, place, clicks=1):
    """Move onto a button, wait until the window has seen it, and click, as a hand does; twice into a number."""
    ui.move(place[0] - 4, place[1])
    yield 0.3
    ui.move(*place)
    yield 0.3
    for _ in range(clicks):
        ui.click(*place)


def until(holds, limit_s=90.0):
    """Wait until `holds()`; `AssertionError` after `limit_s`."""
    began = time.monotonic()
    while not holds():
        assert time.monotonic() - began < limit_s, "the window did not get there"
        yield 0.1
