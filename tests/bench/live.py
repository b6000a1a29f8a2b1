"""Live on the 48 mm sample: our share of a frame beside Blender's own evaluation, over one drag of a finger.

Run where Blender and the add-on can be imported: `python tests/bench/live.py [FRAMES [KIND]]`; with the KIND of a map
(PRESSURE) it is shown meanwhile. CPU time, medians, on one core:
on a second one a worker of Blender's waits for work in a loop, and what it takes would be counted with ours.
"""

import os
import statistics
import sys
import time
from pathlib import Path

import bpy
import numpy as np

ONE_THREAD = {name: "1" for name in ("RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
SAMPLE = Path(__file__).parents[2] / "blend-samples/cylinder_48.blend"
WANTED_MS = 8.0
SWING_RAD = 0.1
"""How far the middle finger's base joint swings about its grasp: 6 degrees, lifted off and pressed in."""


def main(frames, kind=""):
    """Drag with Live off and on, the map `kind` shown; print medians and their ratio. Returns 0."""
    import thenar_blender
    from thenar_blender.live import session, watch

    thenar_blender.register()
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLE))
    context = bpy.context
    settings, pressing = context.scene.thenar, []
    session._press = timed(session._press, pressing)
    angles = SWING_RAD * np.sin(2.0 * np.pi * (np.arange(frames) + 1) / 50.0 + 0.01)
    plain = [spent(pose, settings.hand, angle)[1] for angle in angles]
    settings.live = True
    if kind:
        bpy.ops.thenar.show_map(kind=kind)
    del pressing[:]
    with_node, ours, forces = [], [], []
    for angle in angles:
        with_node.append(spent(pose, settings.hand, angle)[1])
        is_new, seconds = spent(watch.follow_now, context)
        assert is_new, "a frame was not followed"
        ours.append(seconds)
        forces.append(settings.result.force_n)
    again = [spent(show, settings.hand)[1] for _ in angles]
    report(plain, ours, (with_node, again, pressing), (forces, kind))
    thenar_blender.unregister()
    return 0


def report(plain, ours, parts, course):
    """Print what was measured, and keep it."""
    import results

    (with_node, again, pressing), (forces, kind) = parts, course
    own, share = 1e3 * statistics.median(plain), 1e3 * statistics.median(ours)
    print(f"{len(plain)} frames, {min(forces):.0f} to {max(forces):.0f} N, ms of CPU a frame, medians")
    print(f"  Blender's evaluation of the pose, Live off   {own:8.2f}")
    print(f"  the same with Live's modifier                {1e3 * statistics.median(with_node):8.2f}")
    print(f"  Live's update                                {share:8.2f}   wanted <= {WANTED_MS:g}")
    print(f"    of it the press                            {1e3 * statistics.median(pressing):8.2f}")
    print(f"    of it Blender's evaluation to show it      {1e3 * statistics.median(again):8.2f}")
    print(f"  ratio of update to Blender's evaluation      {share / own:8.2f}   wanted <= 1")
    press = 1e3 * statistics.median(pressing)
    measured = f"{share:.2f} ms, of it the press {press:.2f} ms"
    figures = (
        results.Figure(
            "Live, a frame of the 48 mm sample, one core" + (f", {kind.lower()} shown" if kind else ""),
            f"{WANTED_MS:g} ms",
            measured,
            share <= WANTED_MS,
        ),
        results.Figure("the same over Blender's own evaluation of the pose", "1x", f"{share / own:.1f}x", share <= own),
    )
    results.record("bench", "target/venv/bin/python tests/bench/live.py", figures)


def pose(hand, angle):
    """Turn the finger to `angle` about where it was and let Blender evaluate the scene."""
    bone = hand.parent.pose.bones["middle_proximal"]
    start = bone.get("start")
    if start is None:
        bone["start"] = start = bone.rotation_euler.x
    bone.rotation_euler.x = start + angle
    bpy.context.view_layer.update()


def show(hand):
    """What Blender does after a contact was written."""
    hand.data.update()
    bpy.context.view_layer.update()


def spent(call, *arguments):
    """What `call` returns and the CPU seconds that it took."""
    began = time.process_time()
    value = call(*arguments)
    return value, time.process_time() - began


def timed(call, seconds):
    """`call`, whose CPU seconds are added to the list `seconds`."""

    def wrapped(*arguments):
        value, took = spent(call, *arguments)
        seconds.append(took)
        return value

    return wrapped


def is_on_one_core():
    """Whether this process runs on one core and one thread; where the system cannot say, its cores are as wanted."""
    cores = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else {0}
    return len(cores) == 1 and all(os.environ.get(name) == value for name, value in ONE_THREAD.items())


if __name__ == "__main__":
    if not is_on_one_core():
        if hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ONE_THREAD})
    sys.path.insert(0, str(Path(__file__).parents[1]))
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 100, *sys.argv[2:3]))
