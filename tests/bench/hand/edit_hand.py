"""Seconds of an edit of a made hand's shape: the whole edit, and what the library's making takes of it.

Run: target/venv/bin/python tests/bench/hand/edit_hand.py
"""

import statistics
import time

import bpy
import thenar_blender
from thenar_blender import native

REPEATS = 4


def edits(repeat):
    """Edits one after the other; their shapes are other ones in every repeat, as shapes made before are remembered."""
    yield {"percentile": 20.0 + repeat}
    yield {"sex": "female"}
    yield {"side": "left"}
    yield {"length_mm": 181.0 + repeat}
    yield {"breadth_mm": 80.0}


def add_work(hand):
    """A painted group, an attribute and a shape key, which have to be carried."""
    hand.vertex_groups.new(name="Mine").add(list(range(500)), 0.5, "REPLACE")
    hand.data.attributes.new("mine", "FLOAT", "POINT").data[7].value = 1.0
    hand.shape_key_add(name="Basis")
    hand.shape_key_add(name="Mine").data[3].co.x += 0.001


def timed(has_work, repeat):
    """(seconds of the edit, seconds of making) by edit."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.thenar.make_hand()
    hand = bpy.context.scene.thenar.hand
    bpy.ops.thenar.apply_pose(name="power_48")
    if has_work:
        add_work(hand)
    out = []
    for edit in edits(repeat):
        start = time.perf_counter()
        for name, value in edit.items():
            setattr(hand.thenar_hand, name, value)
        whole = time.perf_counter() - start
        assert not hand.thenar_hand.problem, hand.thenar_hand.problem
        start = time.perf_counter()
        native.module.hand(**hand.thenar_hand.wanted())
        out.append((whole, time.perf_counter() - start))
    return out


def main():
    """Print a line for a bare hand and one for a hand with the user's work."""
    thenar_blender.register()
    for title, has_work in (("bare hand", False), ("hand with group, attribute, shape key", True)):
        rows = [row for repeat in range(REPEATS) for row in timed(has_work, repeat + 10 * has_work)]
        whole, making = ([row[column] for row in rows] for column in (0, 1))
        print(
            f"{title}: edit {statistics.median(whole):.2f} s median, {max(whole):.2f} s most; "
            f"making the shape alone {statistics.median(making):.2f} s"
        )
    thenar_blender.unregister()


if __name__ == "__main__":
    main()
