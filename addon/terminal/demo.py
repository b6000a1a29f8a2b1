"""The demo: solve the sample grasp, render it, and set what a mat would read of it next to the paper's Table 6."""

import time
from pathlib import Path

import bpy

from .. import pictures, workflow
from ..recordings import table_6
from ..results import result as results
from ..results import sentences
from ..scene.checks import Refusal
from . import headless


def run(sample, out, with_frames=False):
    """Solve `sample` (a .blend file, or a folder that holds the 48 mm cylinder's); results go to `out`.

    `with_frames` solves the force frames of Fig. 21 too. Raises `Refusal` where there is no sample.
    """
    started = time.perf_counter()
    path = _sample(Path(sample))
    headless.open_file(path)
    context = bpy.context
    settings = context.scene.thenar
    if settings.hand is None or (settings.product is None and settings.product_collection is None):
        raise Refusal(f"'{path}' names no hand and product; make the samples again")
    workflow.solve(context)
    summary = results.as_dict(settings.result)
    out.mkdir(parents=True, exist_ok=True)
    _print_result(summary)
    summary["virtual_mat"] = _read_mat(context)
    seconds = _render(context, out)
    headless.save_file(out / f"{path.stem}-solved.blend")
    if with_frames:
        began = time.perf_counter()
        summary["force_frames"] = table_6.read_frames(context, path)
        seconds["force frames"] = time.perf_counter() - began
        print("\n" + "\n".join(table_6.frame_lines(summary["force_frames"])))
    summary["seconds"] |= seconds | {"whole demo": time.perf_counter() - started}
    headless.save_json(out / "summary.json", summary)
    _print_seconds(summary["seconds"])
    print(f"\nPictures, solved file and summary.json are in {out}")


def _print_result(summary):
    print(f"\n{summary['hand']} on {summary['product']}: {summary['vertices']} vertices, model {summary['model']}\n")
    print(f"{'region':28}{'force N':>9}{'area cm2':>10}{'peak kPa':>10}{'mean kPa':>10}{'depth mm':>10}")
    for row in (*summary["regions"], *summary["fingers"]):
        print(
            f"{sentences.region_title(row['name']):28}{row['force_n']:9.2f}{row['area_mm2'] / 100:10.2f}"
            f"{row['peak_kpa']:10.1f}{row['mean_kpa']:10.1f}{row['depth_mm']:10.2f}"
        )
    print(
        f"{'whole skin':28}{summary['force_n']:9.2f}{summary['contact_area_mm2'] / 100:10.2f}"
        f"{summary['peak_pressure_kpa']:10.1f}{summary['mean_pressure_kpa']:10.1f}"
    )
    print(f"\n{'peak over 24 mm2, kPa':28}{summary['patch_peak_kpa']:9.1f}")
    print(f"{'penetration left, mm':28}{summary['penetration_after_mm']:9.4f}")
    print(f"{'write-back error, mm':28}{summary['write_back_error_mm']:9.4f}")
    reason = f": {summary['reason']}" if summary["reason"] else ""
    print(f"{'grade':28}  {summary['grade']}{reason}")
    for text in summary["warnings"]:
        print(f"note: {text}")


def _read_mat(context):
    """What a virtual mat reads, printed next to Table 6; None, with the reason printed, where no mat can lie."""
    try:
        reading = table_6.read_scene(context)
    except Refusal as why:
        print(f"\nno virtual mat: {why}")
        return None
    print("\n" + "\n".join(table_6.lines(reading)))
    return reading


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
