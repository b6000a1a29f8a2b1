"""What a Subdivision level costs a solve: CPU by step, cold and in another pose, against the same hand without one.

Run: target/venv/bin/python tests/bench/hand/subdivided.py [SAMPLE ...]    # names of files in blend-samples

Cold: nothing prepared by Thenar; Blender has shown the hand before (its tables of the level are made, which takes it
seconds, and is printed). Of several runs the cheapest counts, since other work only adds. CPU is of all threads.
"""

import os
import sys
import time
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests"))

import bpy  # noqa: E402
import results  # noqa: E402
import thenar_blender  # noqa: E402
from thenar_blender import cache, workflow  # noqa: E402
from thenar_blender.operators import display  # noqa: E402
from thenar_blender.results import certificate  # noqa: E402
from thenar_blender.scene import read  # noqa: E402
from thenar_blender.skin_display import shown  # noqa: E402

WANTED, WANTED_S = 3.0, 0.2
REPEATS = 3
TURN = 0.06
"""Flexion of the index finger from one pose to the next, radians."""
PARTS = ((read, "read_hand"), (shown, "_computed"), (shown, "_read"), (certificate, "measure"))
COMMAND = "target/venv/bin/python tests/bench/hand/subdivided.py"


class Split:
    """CPU by step of one solve, its total, wall time, and the longest step in this thread, seconds."""

    def __init__(self):
        self.parts, self.longest, self.wall, self.cpu = defaultdict(float), 0.0, 0.0, 0.0

    def add(self, name, began):
        """Count what was spent since `began`."""
        self.parts[name] += time.process_time() - began


def watched(split):
    """Wrap the functions of `PARTS`, so that `split` knows what they take. Returns what puts them back."""
    plain = [(where, name, getattr(where, name)) for where, name in PARTS]

    def wrap(name, function):
        def timed(*arguments, **options):
            began = time.process_time()
            try:
                return function(*arguments, **options)
            finally:
                split.add(name.strip("_"), began)

        return timed

    for where, name, function in plain:
        setattr(where, name, wrap(name, function))
    return lambda: [setattr(*each) for each in plain]


def solve():
    """One solve by its steps, then the map, then what is left to the redraw. Returns a `Split`."""
    split, value = Split(), None
    restore = watched(split)
    wall, cpu = time.perf_counter(), time.process_time()
    steps = workflow.steps(bpy.context)
    try:
        while True:
            began = time.thread_time()
            try:
                work = steps.send(value)
            except StopIteration:
                break
            finally:
                split.longest = max(split.longest, time.thread_time() - began)
            value = None if work is None else work(None, None)
    finally:
        restore()
    split.cpu, split.wall = time.process_time() - cpu, time.perf_counter() - wall
    result = bpy.context.scene.thenar.result
    split.parts |= {stage.name: stage.seconds for stage in result.stages if stage.name in ("prepare", "press")}
    began = time.process_time()
    display.show(bpy.context)
    split.add("map", began)
    began = time.process_time()
    bpy.context.view_layer.update()
    split.add("redraw", began)
    return split


def pose(turn):
    """Flex the index finger by so much more."""
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    bone = next(bone for bone in rig.pose.bones if "index" in bone.name.lower())
    bone.rotation_mode = "XYZ"
    bone.rotation_euler.x += turn
    bpy.context.view_layer.update()


def run(sample, quality):
    """Cold and warm solves of a sample, with a Subdivision level of that quality, or without where it is 0."""
    bpy.ops.wm.open_mainfile(filepath=str(ROOT / "blend-samples" / f"{sample}.blend"))
    hand = bpy.context.scene.thenar.hand
    cache.clear()
    if quality:
        modifier = hand.modifiers.new("Level", "SUBSURF")
        modifier.levels, modifier.render_levels, modifier.quality = 1, 1, quality
    began = time.process_time()
    bpy.context.view_layer.update()
    evaluated = hand.evaluated_get(bpy.context.evaluated_depsgraph_get())
    count = len(evaluated.to_mesh().vertices)
    evaluated.to_mesh_clear()
    first = time.process_time() - began
    cold = solve()
    pose(TURN)
    return count, first, cold, solve()


def best(sample, quality):
    """Vertices, Blender's first evaluation (s), and the cheapest cold and warm `Split` of `REPEATS` runs."""
    runs = [run(sample, quality) for _ in range(REPEATS)]
    cold, warm = (min((each[column] for each in runs), key=lambda split: split.cpu) for column in (2, 3))
    return runs[0][0], min(each[1] for each in runs), cold, warm


def tell(title, split, base):
    """Print a line with the split."""
    parts = ", ".join(f"{name} {seconds:.3f}" for name, seconds in split.parts.items() if seconds >= 5e-4)
    print(
        f"  {title}: CPU {split.cpu:.3f} s ({split.cpu / base.cpu:.1f} times the base mesh), wall {split.wall:.2f} s, "
        f"longest step of the window {split.longest:.3f} s; {parts}"
    )


def main():
    """Print every sample, and keep the ratios."""
    thenar_blender.register()
    figures = []
    for sample in sys.argv[1:] or ["cylinder_48", "palm_on_plate"]:
        count, _, *bare = best(sample, 0)
        print(f"{sample}, {count:,} vertices")
        for title, split in zip(("cold", "warm"), bare, strict=True):
            tell(title, split, split)
        for quality in (3, 1):
            many, first, *both = best(sample, quality)
            print(f"  Subdivision level 1, quality {quality}, {many:,} vertices; shown first in {first:.2f} s")
            for title, split, base in zip(("cold", "warm"), both, bare, strict=True):
                tell(title, split, base)
                ratio = split.cpu / base.cpu
                what = f"Subdivision level 1, quality {quality}, {sample}, {title}: CPU of a solve over the base mesh's"
                figures.append(results.Figure(what, f"{WANTED:g}x", f"{ratio:.1f}x", ratio <= WANTED))
            longest = max(split.longest for split in both)
            what = f"the same: longest step in the window's thread, quality {quality}, {sample}"
            figures.append(results.Figure(what, f"{WANTED_S:g} s", f"{longest:.2f} s", longest <= WANTED_S))
    results.record("bench", COMMAND, figures)
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
