"""How thick must the grip be? One grasp with grips of growing thickness, drawn.

PYTHONPATH=tests target/venv/bin/python tests/proof/charts/grip_sweep.py [FILE.svg]

The posture stays; peak pressure and force are those of the fast result, over the rigid product's.
"""

import sys
from pathlib import Path

import bpy
import numpy as np
import thenar_blender
from proof.charts import line_chart
from thenar_blender import workflow

ROOT = Path(__file__).parents[3]
PICTURE = ROOT / "addon/docs/pictures/grip_sweep.svg"
SAMPLE = ROOT / "blend-samples/cylinder_60.blend"
GRIPS = {"EVA foam": ("EVA_FOAM", 0.0), "foam, E 0.3 MPa": ("CUSTOM", 0.3), "foam, E 0.2 MPa": ("CUSTOM", 0.2)}
"""Preset, and Young's modulus (MPa) of a custom one."""
POISSON = 0.3
THICKNESS_MM = (1.0, 2.0, 4.0, 6.0, 8.0, 10.0)


def main(path):
    """Solve the sample with every grip, print a line each, and draw the peak over 24 mm2 against the thickness."""
    thenar_blender.register()
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLE))
    rigid, curves = _patch_peak_kpa("RIGID", 0.0, 1.0), {}
    for name, grip in GRIPS.items():
        peaks = [rigid, *(_patch_peak_kpa(*grip, thickness) for thickness in THICKNESS_MM)]
        print(name, np.round(peaks, 1), flush=True)
        curves[name] = ((0.0, *THICKNESS_MM), peaks)
    words = ("Grip on the 60 mm handle, posture held", "thickness of the grip, mm", "peak pressure over 24 mm², kPa")
    line_chart.write(path, words, curves)


def _patch_peak_kpa(material, youngs_mpa, thickness_mm):
    """Peak over 24 mm2, kPa; NaN where the solve is refused."""
    for part in workflow.product_parts(bpy.context.scene.thenar):
        grip = part.thenar.grip
        grip.material, grip.thickness_mm = material, thickness_mm
        if youngs_mpa:
            grip.youngs_mpa, grip.poisson_ratio = youngs_mpa, POISSON
    try:
        bpy.ops.thenar.solve()
    except RuntimeError as error:
        print(material, thickness_mm, "mm refused:", " ".join(str(error).split())[:160])
        return np.nan
    result = bpy.context.scene.thenar.result
    measured = f"{result.force_n:.1f} N, {result.patch_peak_kpa:.1f} kPa, {result.grade}"
    print(f"{material} {youngs_mpa} MPa {thickness_mm} mm: {measured}, yields {result.grip_share:.0%}")
    return result.patch_peak_kpa


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else PICTURE)
