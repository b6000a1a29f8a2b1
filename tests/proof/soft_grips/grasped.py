"""Soft grips on twelve handles grasped by the add-on's buttons: a row each for what is shown, measured apart.

    BLENDER_USER_RESOURCES=target/test-blender/venv target/venv/bin/python tests/proof/soft_grips/grasped.py
        [--starts made tilted ...] [--handles toothbrush ...] [--percentile 50]

How deep the shown skin lies in the shown, pressed grip is measured by `handles.measuring`, which shares nothing with
the library.
"""

import argparse
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

import bpy
import thenar
import thenar_blender
import thenar_blender.workflow
from handles import grasping, measuring, shapes
from thenar_blender.product_objects import copies
from thenar_blender.scene import checks

GRIPS = (("EVA_FOAM", 0.0, 4.0), ("CUSTOM", 0.3, 4.0), ("CUSTOM", 0.1, 8.0))
"""Material, Young's modulus (MPa) of a custom one, thickness (mm)."""


def main():
    """Grasps every handle and solves it with every grip. Exit code 1 if one that is shown is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", nargs="+", default=["made"])
    parser.add_argument("--handles", nargs="+", choices=list(shapes.SHAPES), default=list(shapes.SHAPES))
    parser.add_argument("--percentile", type=int, default=50)
    asked = parser.parse_args()
    thenar_blender.register()
    counts = {"solved": 0, "refused": 0, "wrong": 0}
    for start in asked.starts:
        for name in asked.handles:
            row = grasping.grasp(shapes.SHAPES[name](), asked.percentile, start)
            if "refused" in row:
                print(f"{start}, {name}: refused as rigid", flush=True)
                continue
            rigid = bpy.context.scene.thenar.result.force_n
            for grip in GRIPS:
                kind, line = _one(bpy.context, grip, rigid)
                counts[kind] += 1
                print(f"{start}, {name:14s} {line}", flush=True)
    print(", ".join(f"{count} {kind}" for kind, count in counts.items()), flush=True)
    return int(counts["wrong"] > 0)


def _one(context, grip, rigid_n):
    settings = context.scene.thenar
    cover = settings.product.thenar.grip
    cover.material, cover.thickness_mm = grip[0], grip[2]
    if grip[1]:
        cover.youngs_mpa, cover.poisson_ratio = grip[1], 0.3
    title = f"{grip[0].lower() if not grip[1] else f'E {grip[1]} MPa'} {grip[2]:g} mm"
    try:
        thenar_blender.workflow.solve(context)
    except (checks.Refusal, thenar.ThenarError) as error:
        return "refused", f"{title}: refused: {' '.join(str(error).split())[:150]}"
    found, left = settings.result, left_inside(context)
    is_wrong = found.force_n > rigid_n or left > grasping.LEFT_MM
    line = (
        f"{title}: {found.force_n / rigid_n:.2f} of {rigid_n:.0f} N, peak {found.peak_kpa:.0f} kPa, "
        f"yields {found.grip_mm:.2f} mm ({found.grip_share:.0%}), shown inside {left:.3f} mm; {found.grade}"
    )
    return ("wrong" if is_wrong and found.grade != "do not use" else "solved"), line


def left_inside(context):
    """How deep the shown skin lies in the shown grip, mm."""
    settings = context.scene.thenar
    copy = copies.find_copy(settings.product.name)
    points, _ = grasping.seen(settings.hand)
    skin = grasping.is_skin(settings.hand)
    return float(measuring.depths(points[skin], *grasping.seen(copy or settings.product)).max(initial=0.0))


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    os._exit(code)
