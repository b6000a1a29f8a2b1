"""Plain round bars through Make Hand, *Grasp* as it comes, Solve: which are held by the whole hand, and how well.

    BLENDER_USER_RESOURCES=target/test-blender/venv target/venv/bin/python tests/bench/hand/ordinary_bars.py
        [--diameters 25 48] [--lengths 140 180]

People close the palm and all fingers around such bars; *Grasp* aims at 200 N then, and at 30 N in a pinch.
"""

import argparse
import os
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parents[2]
DIAMETERS_MM, LENGTHS_MM = (25.0, 32.0, 40.0, 48.0, 60.0, 70.0), (110.0, 140.0, 180.0, 250.0)
WHOLE_N = 100.0
"""What is held with more than this is held by the whole hand."""


def held(diameter_mm, length_mm):
    """Force of the solved grasp, N, or None where it is refused."""
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
    return bpy.context.scene.thenar.result.force_n


def main():
    """Prints a row for each bar, and the sum. Returns the exit code: 1 where one is refused."""
    import thenar_blender

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--diameters", nargs="+", type=float, default=DIAMETERS_MM)
    parser.add_argument("--lengths", nargs="+", type=float, default=LENGTHS_MM)
    asked = parser.parse_args()
    thenar_blender.register()
    forces = {(d, long): held(d, long) for d in asked.diameters for long in asked.lengths}
    for (diameter, length), force in forces.items():
        print(f"{diameter:g} x {length:g} mm: " + ("refused" if force is None else f"{force:.1f} N"))
    whole = [force for force in forces.values() if force and force > WHOLE_N]
    refused = sum(force is None for force in forces.values())
    print(
        f"{len(whole)} of {len(forces)} by the whole hand, {min(whole, default=0.0):.0f} to "
        f"{max(whole, default=0.0):.0f} N; refused {refused}"
    )
    return int(refused > 0)


if __name__ == "__main__":
    sys.path[0] = str(TESTS)
    code = main()
    sys.stdout.flush()
    os._exit(code)
