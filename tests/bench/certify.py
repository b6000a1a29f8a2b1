"""Time and numbers of *Certify*: `target/venv/bin/python tests/bench/certify.py [FILE.blend ...]`; without, samples."""

import sys
import time
from contextlib import ExitStack
from pathlib import Path

import bpy
import numpy as np
import thenar
import thenar_blender
from thenar_blender.reference import certify

SAMPLES = Path(__file__).parents[2] / "blend-samples"


def main(paths):
    """Solves and certifies every file, then prints one line each."""
    thenar_blender.register()
    lines = [_one(path) for path in paths or sorted(map(str, SAMPLES.glob("*.blend")))]
    print("\n".join(["", *lines]))


def _one(path):
    bpy.ops.wm.open_mainfile(filepath=path)
    bpy.ops.thenar.solve()
    least, most = _bone_mm()
    started, used = time.perf_counter(), time.process_time()
    bpy.ops.thenar.certify()
    seconds, cpu_s = time.perf_counter() - started, time.process_time() - used
    result = bpy.context.scene.thenar.result
    reference, fast_n = result.reference, sum(row.force_n for row in result.regions)
    print(f"{Path(path).stem}: {reference.note}")
    for row in result.regions:
        print(f"{row.name:22s} {row.depth_mm:4.1f} mm deep  {row.force_n:6.1f} {row.reference_n:6.1f} N")
    return (
        f"{Path(path).stem:20s} {seconds:4.0f} s, CPU of all threads {cpu_s:.1f} s; "
        f"fast over reference: force {fast_n / reference.force_n:.2f} "
        f"({fast_n:.1f}, {reference.force_n:.1f} N), area {result.area_mm2 / reference.area_mm2:.2f}, "
        f"over 24 mm2 {result.patch_peak_kpa / reference.patch_peak_kpa:.2f}; "
        f"bone {least:.1f} to {most:.1f} mm under the skin that is pressed deepest"
    )


def _bone_mm():
    """Least and greatest way to the bone, mm, of the deeper half of the skin in the product."""
    with ExitStack() as taken:
        tissue = certify.read(bpy.context, taken)
    product = thenar.Product(tissue.product_mm, tissue.job.reading.product.triangles)
    gap = np.where(tissue.can_touch, np.asarray(product.gap_mm(tissue.posed_mm)["gap_mm"]), 0.0)
    ways = np.linalg.norm(tissue.bone_mm - tissue.posed_mm, axis=1)[gap < min(0.0, 0.5 * gap.min())]
    return ways.min(), ways.max()


if __name__ == "__main__":
    main(sys.argv[1:])
