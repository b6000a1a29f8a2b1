"""Drives a Blender window from an empty scene and a mat's export to its comparison on the product, by clicks alone.

Not a test of pytest: a window is needed. `drive(bpy, ui)` is a generator that yields seconds to wait; `ui` clicks at
pixels of a window of 1600 x 1000 and takes pictures. Only the export is made without clicks: a grip of known pressures
on a cylinder of 48 mm, as a Tekscan file, in the home folder, where Blender's file browser opens. Prints the seconds
from the first click to the recording next to the simulation, and to the residual on the hand.
"""

import math
import os
import time

LIMIT_S = 120.0
LOAD, FILE, ACCEPT = (1165, 582), (484, 100), (1135, 614)
SAMPLES, CYLINDER, SOLVE, RECORD = (1165, 259), (1117, 375), (1165, 335), (1184, 128)
SHOW, RESIDUAL, COMPARE, FOLLOW = (1100, 735), (1198, 735), (1165, 764), (1264, 457)
LATE, ON_CURVE = (128, 948), (1240, 675)
"""Where the buttons are in Blender 5.2's sidebar, file browser and timeline at their default sizes."""
ROWS, COLUMNS, PITCH_MM, DIAMETER_MM, FRAMES = 24, 30, 5.026548, 48.0, 40
PADS = (
    (0.30, 40.0, 9.0, 150.0), (0.30, 63.0, 9.0, 170.0), (0.30, 86.0, 9.0, 140.0), (0.31, 108.0, 8.0, 100.0),
    (0.72, 52.0, 14.0, 60.0), (0.70, 86.0, 16.0, 70.0),
)  # fmt: skip
"""Turn, height (mm), radius (mm) and peak (kPa) of each patch."""


def write_export(path):
    """The patches, each a half-ellipsoid of pressure, rising to their peaks and falling again.

    Returns force (N) and peak (kPa) of each frame.
    """
    known = []
    head = (
        "DATA_TYPE MOVIE\nVERSION Tekscan Pressure Measurement System 6.33\nSENSOR_TYPE KNOWN\n"
        f"ROWS {ROWS}\nCOLS {COLUMNS}\nROW_SPACING {PITCH_MM} mm\nCOL_SPACING {PITCH_MM} mm\n"
        f"SENSEL_AREA {PITCH_MM**2:.4f} mm2\nNOISE_THRESHOLD 0\nSECONDS_PER_FRAME 0.05\n"
        f"START_FRAME 1\nEND_FRAME {FRAMES}\nUNITS KPa\nMIRROR_ROW 0\nMIRROR_COL 0\nASCII_DATA @@\n"
    )
    around = math.pi * DIAMETER_MM
    with open(path, "w", encoding="utf-8") as file:
        file.write(head)
        for number in range(1, FRAMES + 1):
            share = math.sin(math.pi * number / (FRAMES + 1))
            file.write(f"\nFrame {number}\n")
            read = []
            for row in range(ROWS):
                cells = []
                for column in range(COLUMNS):
                    kpa = 0.0
                    for turn, height, radius, peak in PADS:
                        across = ((column + 0.5) / COLUMNS - turn + 0.5) % 1.0 - 0.5
                        apart = math.hypot(across * around, (row + 0.5) * PITCH_MM - height)
                        kpa += peak * share * math.sqrt(max(1.0 - (apart / radius) ** 2, 0.0))
                    cells.append(f"{kpa:.2f}")
                read += map(float, cells)
                file.write(",".join(cells) + "\n")
            known.append((sum(read) * PITCH_MM**2 / 1e3, max(read)))
    return known


def drive(bpy, ui):
    """Load the export, add the sample, solve, show, compare, scrub, click the curve, show the residual; pictures."""
    known = write_export(os.path.join(os.environ["HOME"], "grip.asf"))
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    for _ in range(2):
        ui.sidebar("Thenar")
        yield 2
    ui.shot("e0_start")
    began = time.monotonic()
    marks = []

    def mark(name):
        marks.append(f"{name} {time.monotonic() - began:.1f} s")
        ui.shot(f"e{len(marks)}_{name}")

    yield from press(ui, LOAD)
    yield 2.5
    yield from press(ui, FILE)
    yield 1.0
    ui.shot("e_file")
    yield from press(ui, ACCEPT)
    yield from until(lambda: len(bpy.context.scene.thenar_recordings.items) == 1)
    yield 1.0
    mark("loaded")
    yield from press(ui, SAMPLES)
    yield 1.0
    ui.shot("e_samples")
    yield from press(ui, CYLINDER)
    state, kept = bpy.context.scene.thenar, bpy.context.scene.thenar_recordings
    yield from until(lambda: state.hand is not None)
    yield 1.0
    mark("sample")
    yield from press(ui, SOLVE)
    yield from until(lambda: state.hand.thenar.shows_pressure)
    yield 1.0
    mark("solved")
    yield from press(ui, RECORD)
    yield from until(lambda: bpy.context.window_manager.thenar_tabs.tab == "RECORD")
    ui.move(RECORD[0], RECORD[1] + 60)
    yield 4.0
    ui.shot("e_record")
    yield from press(ui, SHOW)
    yield from until(lambda: bpy.data.objects.get("Thenar Mat Recorded") is not None)
    yield 1.0
    mark("shown")
    yield from press(ui, COMPARE)
    yield from until(lambda: kept.comparison.is_valid)
    yield from until(lambda: bpy.data.objects.get("Thenar Mat Simulated") is not None)
    compared = time.monotonic() - began
    yield 1.0
    mark("compared")
    yield from press(ui, FOLLOW)
    yield 1.0
    yield from press(ui, LATE)
    yield from until(lambda: kept.items[0].frame > 12)
    yield 1.0
    mark("frame")
    yield from press(ui, ON_CURVE)
    yield from until(lambda: kept.items[0].frame > 28 and bpy.context.scene.frame_current == kept.items[0].frame)
    yield 1.0
    mark("curve")
    yield from press(ui, RESIDUAL)
    yield from until(lambda: state.maps.shown == "RESIDUAL")
    took = time.monotonic() - began
    yield 1.5
    mark("residual")
    print(f"STOPWATCH {', '.join(marks)}; compared {compared:.1f} s, residual {took:.1f} s of {LIMIT_S:g} s")
    force, peak = min(known, key=lambda each: abs(each[0] - sum(row[0] for row in known) / FRAMES))
    measured = {row.name: float(row.measured) for row in kept.comparison.measures if row.name in ("Force", "Peak")}
    assert abs(measured["Force"] / force - 1.0) < 2e-3 and abs(measured["Peak"] / peak - 1.0) < 2e-3, (force, peak)
    for row in kept.comparison.measures:
        print(f"MEASURE {row.group}: {row.name} {row.measured} | {row.simulated} {row.unit}")


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
