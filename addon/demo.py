"""The demo: solve the sample grasp, render it, and set its numbers beside the paper's Table 6."""

import time
from pathlib import Path

import bpy

from . import headless, pictures, workflow
from . import result as results
from .scene.checks import Refusal

PAPER = {"force_n": (337, 323), "peak_pressure_kpa": (165, 165), "mean_pressure_kpa": (33, 28)}
"""Xie Table 6, 48 mm cylinder: measured, simulated."""
PAPER_AREA_CM2 = (337 / 0.033 / 100, 323 / 0.028 / 100)
"""Total force over average pressure of the same table, cm²."""


def run(sample, out):
    """Solve `sample` (a .blend file, or a folder that holds the 48 mm cylinder's); results go to `out`.

    Raises `Refusal` where there is no sample.
    """
    started = time.perf_counter()
    path = _sample(Path(sample))
    headless.open_file(path)
    context = bpy.context
    settings = context.scene.thenar
    if settings.hand is None or (settings.product is None and settings.product_collection is None):
        raise Refusal(f"'{path}' names no hand and product; make the samples anew")
    workflow.solve(context)
    summary = results.as_dict(settings.result)
    out.mkdir(parents=True, exist_ok=True)
    print_table(summary)
    seconds = _render(context, out)
    headless.save_file(out / f"{path.stem}-solved.blend")
    summary["seconds"] |= seconds | {"whole demo": time.perf_counter() - started}
    headless.save_json(out / "summary.json", summary)
    _print_seconds(summary["seconds"])
    print(f"\nPictures, solved file and summary.json stand in {out}")


def print_table(summary):
    """Regions, fingers and totals beside the paper's figures, on the terminal."""
    print(f"\n{summary['hand']} on {summary['product']}: {summary['vertices']} vertices, model {summary['model']}\n")
    print(f"{'region':28}{'force N':>9}{'area cm2':>10}{'peak kPa':>10}{'mean kPa':>10}{'depth mm':>10}")
    for row in (*summary["regions"], *summary["fingers"]):
        print(
            f"{row['name']:28}{row['force_n']:9.2f}{row['area_mm2'] / 100:10.2f}{row['peak_kpa']:10.1f}"
            f"{row['mean_kpa']:10.1f}{row['depth_mm']:10.2f}"
        )
    print(f"\n{'':28}{'Thenar':>9}{'measured':>10}{'paper sim':>10}   (Xie Table 6, 48 mm)")
    for label, key in (("force, N", "force_n"), ("peak, kPa", "peak_pressure_kpa"), ("mean, kPa", "mean_pressure_kpa")):
        measured, simulated = PAPER[key]
        print(f"{label:28}{summary[key]:9.1f}{measured:10}{simulated:10}")
    area = summary["contact_area_mm2"] / 100
    print(f"{'area, cm2 (force / mean)':28}{area:9.1f}{PAPER_AREA_CM2[0]:10.0f}{PAPER_AREA_CM2[1]:10.0f}")
    print(f"{'peak over 24 mm2, kPa':28}{summary['patch_peak_kpa']:9.1f}")
    print(f"{'penetration left, mm':28}{summary['penetration_after_mm']:9.4f}")
    print(f"{'write-back error, mm':28}{summary['write_back_error_mm']:9.4f}")
    print(
        f"{'grade':28}  {summary['grade']}: {summary['reason']}"
        if summary["reason"]
        else f"{'grade':28}  {summary['grade']}"
    )
    for text in summary["warnings"]:
        print(f"note: {text}")


def _render(context, out):
    seconds = {}
    front, back = out / "product-front.png", out / "product-back.png"
    for name, draw in (
        ("render: scene", lambda: pictures.render_scene(context, out / "scene.png")),
        ("render: hand", lambda: pictures.render_hand(context, out / "hand-pressure.png")),
        ("render: product front", lambda: pictures.render_product(context, front, 0.0)),
        ("render: product back", lambda: pictures.render_product(context, back, 3.14159)),
    ):
        started = time.perf_counter()
        draw()
        seconds[name] = time.perf_counter() - started
    pictures.beside([front, back], out / "product-pressure.png")
    pictures.beside([out / "scene.png", out / "hand-pressure.png"], out / "overview.png")
    front.unlink()
    back.unlink()
    return seconds


def _print_seconds(seconds):
    print("\nseconds by stage")
    for stage, value in seconds.items():
        print(f"  {stage:26}{value:8.3f}")


def _sample(path):
    if path.is_file():
        return path
    found = sorted(file for file in path.glob("*.blend") if "48" in file.stem) if path.is_dir() else []
    if not found:
        raise Refusal(f"there is no sample of the 48 mm cylinder at '{path}'; make it with 'cargo xtask samples'")
    return found[0]
