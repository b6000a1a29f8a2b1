"""Drives a Blender window from an empty scene to the map on a rigged hand of one's own, by clicks alone.

Not a test of pytest: a window is needed. `drive(bpy, ui)` is a generator that yields seconds to wait; `ui` clicks at
pixels of a window of 1600 x 1000 and takes pictures. Only the files are no clicks: they lie in the home folder, where
Blender's file browser opens. The hand is the GLB that `THENAR_RIG` names, as the generic hand of WebXR, or a .blend
with a body, as `public_rigs.py` makes them; without it, a hand exported with the names of OpenXR, without
regions and with bones that hang on nothing. The product is a handle in metres. Prints the seconds from the first click
to the map.
"""

import json
import math
import os
import shutil
import struct
import time

LIMIT_S = 120.0
HAND, FILE, ACCEPT = (1165, 433), (484, 100), (1135, 614)
ADD, JOIN, GRASP, SOLVE = (1165, 258), (1165, 403), (1165, 335), (1165, 335)
AFTER_CONTROLS = 72
"""Pixels that Solve is farther down where constraints were muted, for the way back to the controls stands above it."""
OPENED, PALM, PRODUCT, APART = (1096, 304), (1215, 304), (1096, 326), (1215, 326)
"""Where the buttons are in Blender 5.2's sidebar and file browser at their default sizes."""
RIG = os.environ.get("THENAR_RIG", "")
IS_BLEND = RIG.endswith(".blend")
NAMES = {"proximal": "phalanx-proximal", "middle": "phalanx-intermediate", "distal": "phalanx-distal"}


def write_hand(bpy, path):
    """A hand as trackers export it: bones by OpenXR's names, none on another, no group but theirs."""
    if RIG:
        shutil.copy(RIG, path)
        return
    bpy.ops.thenar.make_hand()
    hand = bpy.context.scene.thenar.hand
    rig = next(modifier.object for modifier in hand.modifiers if modifier.type == "ARMATURE")
    for bone in rig.data.bones:
        digit, _, part = bone.name.partition("_")
        bone.name = f"{digit}-{NAMES.get(part, part)}" if part else "wrist" if digit == "carpus" else digit
    for group in [group for group in hand.vertex_groups if group.name not in rig.data.bones]:
        hand.vertex_groups.remove(group)
    hand.thenar.materials.clear()
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for bone in rig.data.edit_bones:
        bone.parent = None
    bpy.ops.object.mode_set(mode="OBJECT")
    for obj in bpy.data.objects:
        obj.select_set(obj in (hand, rig))
    bpy.ops.export_scene.gltf(filepath=path, use_selection=True, export_animations=False)
    bpy.ops.wm.read_homefile()
    bpy.context.preferences.view.show_splash = False


def write_handle(path, around=48):
    """A turned handle, 34 mm thick and 120 mm long, as a GLB in metres."""
    profile = ((0, -60), (13, -60), (16, -56), (17, -40), (16, 0), (17, 40), (16, 56), (13, 60), (0, 60))
    rings = range(around)
    points = [
        (r * math.cos(2 * math.pi * k / around) / 1e3, z / 1e3, r * math.sin(2 * math.pi * k / around) / 1e3)
        for r, z in profile
        for k in rings
    ]
    faces = []
    for row in range(len(profile) - 1):
        for k in rings:
            a, b = around * row + k, around * row + (k + 1) % around
            faces += [a, a + around, b] if profile[row][0] else []
            faces += [b, a + around, b + around] if profile[row + 1][0] else []
    places = b"".join(struct.pack("<3f", *point) for point in points)
    held = places + struct.pack(f"<{len(faces)}I", *faces)
    spans = [[each[axis] for each in points] for axis in range(3)]
    about = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "Handle"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(held)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(places)},
            {"buffer": 0, "byteOffset": len(places), "byteLength": 4 * len(faces)},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3",
             "min": [min(span) for span in spans], "max": [max(span) for span in spans]},
            {"bufferView": 1, "componentType": 5125, "count": len(faces), "type": "SCALAR"},
        ],
    }  # fmt: skip
    text = json.dumps(about).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(held)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, size) + struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(held), b"BIN\0") + held)


def drive(bpy, ui):
    """Add the hand and the product, join loose bones, grasp, solve; a picture of each step."""
    home = os.environ["HOME"]
    write_hand(bpy, os.path.join(home, "a_hand.blend" if IS_BLEND else "a_hand.glb"))
    yield 1.0
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    write_handle(os.path.join(home, "b_handle.glb"))
    for _ in range(2):
        ui.sidebar("Thenar")
        yield 2
    ui.shot("d0_start")
    began = time.monotonic()
    state, marks = bpy.context.scene.thenar, []

    def mark(name):
        marks.append(f"{name} {time.monotonic() - began:.1f} s")
        ui.shot(f"d{len(marks)}_{name}")

    yield from choose(ui, HAND, FILE)
    yield from until(lambda: state.hand is not None and len(state.hand.thenar.materials) > 0)
    yield 1.5
    mark("hand")
    # Files of Blender are hands only: the handle stands first in the list of products then.
    yield from choose(ui, ADD, FILE if IS_BLEND else (FILE[0], FILE[1] + 19))
    yield from until(lambda: state.product is not None)
    yield 1.5
    mark("product")
    if not IS_BLEND:
        yield from press(ui, JOIN)
        yield 1.5
        mark("joined")
    yield from press(ui, GRASP)
    yield 4.0
    ui.shot("d4_searching")
    yield from until(lambda: len(bpy.context.scene.thenar_grasps.found) > 0)
    yield 2.0
    mark("grasp")
    is_muted = any(obj.thenar_bones.muted for obj in bpy.data.objects)
    yield from press(ui, (SOLVE[0], SOLVE[1] + AFTER_CONTROLS * is_muted))
    yield from until(lambda: state.hand.thenar.shows_pressure)
    took = time.monotonic() - began
    yield 1.0
    mark("map")
    print(f"FORCE {state.result.force_n:.1f} N solved, {bpy.context.scene.thenar_grasps.found[0].total_n:.1f} N found")
    print(f"STOPWATCH {', '.join(marks)}; map {took:.1f} s of {LIMIT_S:g} s")
    yield 2.0
    for name, place in (("opened", OPENED), ("palm", PALM), ("product", PRODUCT), ("apart", APART)):
        yield from press(ui, place)
        yield 3.0
        ui.shot(f"d9_{name}")


def choose(ui, button, file):
    """Press a button that asks for a file, click the file, and accept it."""
    yield from press(ui, button)
    yield 2.5
    yield from press(ui, file)
    yield 1.0
    ui.shot("d_file")
    yield from press(ui, ACCEPT)


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
