"""Soft grips on the samples: force, area and peak by material and thickness, and what a press takes over a rigid one.

target/venv/bin/python tests/proof/soft_grips/samples.py [FILE.blend ...]
"""

import sys
import time
from pathlib import Path

import bpy
import thenar_blender
from thenar_blender import workflow

SAMPLES = Path(__file__).parents[3] / "blend-samples"
GRIPS = (
    ("RIGID", 0.0, 3.0),
    ("TPE", 0.0, 3.0),
    ("SILICONE", 0.0, 3.0),
    ("EVA_FOAM", 0.0, 3.0),
    ("EVA_FOAM", 0.0, 8.0),
    ("CUSTOM", 0.3, 3.0),
    ("CUSTOM", 0.3, 6.0),
    ("CUSTOM", 0.2, 10.0),
)
"""Material, Young's modulus (MPa) of a custom one, thickness (mm)."""


def main(paths):
    """Solves every file with every grip and prints a line each."""
    thenar_blender.register()
    for path in paths or sorted(map(str, SAMPLES.glob("*.blend"))):
        bpy.ops.wm.open_mainfile(filepath=path)
        lines, rigid_s = [], None
        for grip in GRIPS:
            started = time.perf_counter()
            line = _one(*grip)
            seconds = time.perf_counter() - started
            rigid_s = rigid_s or seconds
            lines.append(f"{line}; {seconds / rigid_s:.1f} times the rigid solve")
        print("\n".join(["", Path(path).stem, *lines]), flush=True)


def _one(material, youngs_mpa, thickness_mm):
    for part in workflow.product_parts(bpy.context.scene.thenar):
        grip = part.thenar.grip
        grip.material, grip.thickness_mm = material, thickness_mm
        if youngs_mpa:
            grip.youngs_mpa, grip.poisson_ratio = youngs_mpa, 0.3
    name = material.lower() if not youngs_mpa else f"E {youngs_mpa} MPa"
    try:
        bpy.ops.thenar.solve()
    except RuntimeError as error:
        return f"{name:10s} {thickness_mm:4.1f} mm  refused: {' '.join(str(error).split())[:160]}"
    found = bpy.context.scene.thenar.result
    return (
        f"{name:10s} {thickness_mm:4.1f} mm  {found.force_n:6.1f} N, {found.area_mm2 / 100:5.1f} cm2, "
        f"peak {found.peak_kpa:4.0f} kPa, over 24 mm2 {found.patch_peak_kpa:4.0f} kPa; "
        f"grip yields {found.grip_mm:.2f} mm ({found.grip_share:.0%}); {found.grade}"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
