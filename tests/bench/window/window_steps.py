"""How long the window waits for a solve: every step of one in its thread, on hands of 41,000 and 164,000 vertices.

usage: target/venv/bin/python tests/bench/window/window_steps.py
"""

import os
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "blender"))

import bpy  # noqa: E402
import results  # noqa: E402
import stage  # noqa: E402
import thenar_blender  # noqa: E402
from thenar_blender import workflow  # noqa: E402

WANTED_S = 0.2


def steps_of(subdivisions):
    """Seconds of each step in this thread, for a ball of so many subdivisions on a plate."""
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions, radius=8 * stage.MM)
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = bpy.context.object, stage.plate(top=-7.9)
    spent, steps, value = [], workflow.steps(bpy.context), None
    while True:
        began = time.thread_time()
        try:
            work = steps.send(value)
        except StopIteration:
            return len(settings.hand.data.vertices), [*spent, time.thread_time() - began]
        spent.append(time.thread_time() - began)
        value = None if work is None else work(None, None)


if __name__ == "__main__":
    thenar_blender.register()
    figures = []
    for subdivisions in (7, 8):
        count, spent = steps_of(subdivisions)
        verdict = "met" if max(spent) <= WANTED_S else "NOT MET"
        print(f"{count:,} vertices: {len(spent)} steps, longest {max(spent):.2f} s ({WANTED_S} wanted: {verdict})")
        what = f"longest step of a solve in the window's thread, {count:,} vertices"
        figures.append(results.Figure(what, f"{WANTED_S:g} s", f"{max(spent):.2f} s", max(spent) <= WANTED_S))
    results.record("bench", "target/venv/bin/python tests/bench/window/window_steps.py", figures)
    sys.stdout.flush()
    os._exit(0)
