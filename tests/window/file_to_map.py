"""Drives a Blender window from an empty scene to the map on an STL of a handle in mm, by clicks alone.

Not a test of pytest: a window is needed. `drive(bpy, ui)` is a generator that yields seconds to wait; `ui` clicks at
pixels of a window of 1600 x 1000 and takes pictures. The only thing that is not a click is the file itself, which is
written into the home folder, where Blender's file browser opens. Prints the seconds from the first click to the map.
"""

import math
import os
import struct
import time

LIMIT_S = 120.0
ADD, FILE, ACCEPT = (1165, 302), (484, 100), (1135, 614)
SCALE, HAND, GRASP, SOLVE = (1165, 366), (1165, 346), (1165, 335), (1165, 335)
OPENED, APART = (1096, 304), (1215, 326)
"""Where the buttons are in Blender 5.2's sidebar and file browser at their default sizes."""
PROFILE = (
    (8, -62), (14, -60), (17, -56), (18.5, -48), (18.5, -20), (16.5, 0), (18, 20), (19, 38), (17, 46), (13, 50),
    (11, 55), (14, 60), (14, 62), (5, 63),
)  # fmt: skip
"""Radius and height of the handle, mm."""


def write_handle(path, around=40):
    """A turned handle, flattened to 82 %, as a binary STL in mm."""
    turns = [2.0 * math.pi * step / around for step in range(around)]
    rings = [[(r * math.cos(a), 0.82 * r * math.sin(a), z) for a in turns] for r, z in PROFILE]
    low, high = (0.0, 0.0, PROFILE[0][1]), (0.0, 0.0, PROFILE[-1][1])
    faces = []
    for here, there in ((k, (k + 1) % around) for k in range(around)):
        for a, b in zip(rings[:-1], rings[1:], strict=True):
            faces += [(a[here], a[there], b[there]), (a[here], b[there], b[here])]
        faces += [(low, rings[0][there], rings[0][here]), (high, rings[-1][here], rings[-1][there])]
    rows = b"".join(struct.pack("<12fH", 0, 0, 0, *[v for point in face for v in point], 0) for face in faces)
    with open(path, "wb") as file:
        file.write(bytes(80) + struct.pack("<I", len(faces)) + rows)


def drive(bpy, ui):
    """Add the product, mend its unit, make a hand, grasp, solve; a picture of each step."""
    write_handle(os.path.join(os.environ["HOME"], "handle.stl"))
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    for _ in range(2):
        ui.sidebar("Thenar")
        yield 2
    began = time.monotonic()
    state, marks = bpy.context.scene.thenar, []

    def mark(name):
        marks.append(f"{name} {time.monotonic() - began:.1f} s")
        ui.shot(f"b{len(marks)}_{name}")

    yield from press(ui, ADD)
    yield 2.5
    yield from press(ui, FILE)
    yield 1.0
    yield from press(ui, ACCEPT)
    yield from until(lambda: state.product is not None)
    yield 1.0
    mark("added")
    for _ in range(3):  # the first click after the file browser may only close its warning
        if state.product.dimensions.z > 1.0:
            yield from press(ui, SCALE)
            yield 2.0
    yield from until(lambda: state.product.dimensions.z < 1.0)
    yield 1.0
    mark("scaled")
    yield from press(ui, HAND)
    yield from until(lambda: state.hand is not None)
    yield 1.0
    mark("hand")
    yield from press(ui, GRASP)
    yield 4.0
    ui.shot("b4_searching")
    yield from until(lambda: len(bpy.context.scene.thenar_grasps.found) > 0)
    yield 1.0
    mark("grasp")
    yield from press(ui, SOLVE)
    yield from until(lambda: state.hand.thenar.shows_pressure)
    took = time.monotonic() - began
    yield 1.0
    mark("map")
    print(f"STOPWATCH {', '.join(marks)}; map {took:.1f} s of {LIMIT_S:g} s")
    for name, place in (("opened", OPENED), ("apart", APART)):
        yield from press(ui, place)
        yield 2.0
        ui.shot(f"b9_{name}")


def press(ui, place):
    """Move onto a button, wait until the window has seen it, and click, as a hand does."""
    ui.move(place[0] - 4, place[1])
    yield 0.3
    ui.move(*place)
    yield 0.3
    ui.click(*place)


def until(holds, limit_s=90.0):
    """Wait until `holds()`; `AssertionError` after `limit_s`."""
    began = time.monotonic()
    while not holds():
        assert time.monotonic() - began < limit_s, "the window did not get there"
        yield 0.1
