"""Plain round bars through Make Hand, *Grasp* as it comes, Solve: which are held by the whole hand, and where.

    BLENDER_USER_RESOURCES=target/test-blender/venv target/venv/bin/python tests/bench/hand/ordinary_bars.py
        [--diameters 25 48] [--lengths 140 180]

People close the palm and all fingers around such bars; *Grasp* aims at 200 N then, and at 30 N in a pinch.
"""

import argparse
import os
import sys
from pathlib import Path

import numpy as np

TESTS = Path(__file__).resolve().parents[2]
DIAMETERS_MM, LENGTHS_MM = (25.0, 32.0, 40.0, 48.0, 60.0, 70.0), (110.0, 140.0, 180.0, 250.0)
WHOLE_N = 100.0
"""What is held with more than this is held by the whole hand."""


EDGE_MM = 1.0
"""Skin that is pressed this near to a bar's end, or past it, is hooked over its edge."""


def held(diameter_mm, length_mm):
    """Force of the solved grasp, N, and how many pressed vertices lie at the bar's ends; None where it is refused."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    size = {"radius": 0.5e-3 * diameter_mm, "depth": 1e-3 * length_mm}
    bpy.ops.mesh.primitive_cylinder_add(vertices=64, location=(0.3, 0.0, 0.0), **size)
    bar = bpy.context.object
    try:
        bpy.ops.thenar.make_hand()
        bpy.context.scene.thenar.product = bar
        bpy.ops.thenar.fit_grasp()
        bpy.ops.thenar.solve()
    except RuntimeError:
        return None
    return bpy.context.scene.thenar.result.force_n, _at_ends(bpy.context.scene.thenar.hand, bar, length_mm)


def _at_ends(hand, bar, length_mm):
    """Pressed vertices of the shown hand within `EDGE_MM` of the ends of a bar along its own z, or past them."""
    from handles import grasping
    from thenar_blender import names

    pressure = np.array([each.value for each in hand.data.attributes[names.PRESSURE_KPA].data])
    points = grasping.seen(hand)[0][pressure > 0.0]
    world = np.array(bar.matrix_world)
    along = (points - 1000.0 * world[:3, 3]) @ (world[:3, 2] / np.linalg.norm(world[:3, 2]))
    return int((np.abs(along) > 0.5 * length_mm - EDGE_MM).sum())


def main():
    """Prints a row for each bar, and the sum. Returns the exit code: 1 where one is refused."""
    import thenar_blender

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--diameters", nargs="+", type=float, default=DIAMETERS_MM)
    parser.add_argument("--lengths", nargs="+", type=float, default=LENGTHS_MM)
    asked = parser.parse_args()
    thenar_blender.register()
    rows = {(d, long): held(d, long) for d in asked.diameters for long in asked.lengths}
    for (diameter, length), row in rows.items():
        said = "refused" if row is None else f"{row[0]:.1f} N, {row[1]} pressed vertices at its ends"
        print(f"{diameter:g} x {length:g} mm: {said}")
    whole = [row for row in rows.values() if row and row[0] > WHOLE_N]
    forces, hooked = [force for force, _ in whole], sum(count > 0 for _, count in whole)
    refused = list(rows.values()).count(None)
    print(
        f"{len(whole)} of {len(rows)} by the whole hand, {min(forces, default=0.0):.0f} to "
        f"{max(forces, default=0.0):.0f} N, {hooked} of them hooked over an end; refused {refused}"
    )
    return int(refused > 0)


if __name__ == "__main__":
    sys.path[0] = str(TESTS)
    code = main()
    sys.stdout.flush()
    os._exit(code)
