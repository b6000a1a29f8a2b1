"""Time and numbers of *Certify* on a sample: `target/venv/bin/python tests/bench/certify.py [FILE.blend]`."""

import sys
import time
from pathlib import Path

import bpy
import thenar_blender

SAMPLE = Path(__file__).parents[2] / "blend-samples" / "cylinder_48.blend"


def main(arguments):
    """Solves and certifies the file named, or the 48 mm sample."""
    thenar_blender.register()
    bpy.ops.wm.open_mainfile(filepath=arguments[0] if arguments else str(SAMPLE))
    bpy.ops.thenar.solve()
    started = time.perf_counter()
    bpy.ops.thenar.certify()
    seconds = time.perf_counter() - started
    result = bpy.context.scene.thenar.result
    reference = result.reference
    print(f"{seconds:.0f} s; force {result.force_n:.1f} N fast, {reference.force_n:.1f} N reference")
    print(f"area {result.area_mm2 / 100:.1f}, {reference.area_mm2 / 100:.1f} cm2")
    print(f"over 24 mm2 {result.patch_peak_kpa:.0f}, {reference.patch_peak_kpa:.0f} kPa. {reference.note}")
    for row in result.regions:
        print(f"{row.name:22s} {row.depth_mm:4.1f} mm deep  {row.force_n:6.1f} {row.reference_n:6.1f} N")


if __name__ == "__main__":
    main(sys.argv[1:])
