"""The grasps of Xie et al. on cylinders (Table 6, Fig. 21) next to a solved one, both as a pressure mat reads them."""

import numpy as np

from .. import names, workflow
from ..grasp import fitting
from ..grasp_fit import fitter
from ..hand import pads
from ..scene import attributes
from ..scene.checks import Refusal
from ..terminal import headless
from . import virtual_mat

PAPER = {
    48: {"mean_kpa": (33.0, 28.0), "peak_kpa": (165.0, 165.0), "force_n": (337.0, 323.0)},
    60: {"mean_kpa": (29.0, 27.0), "peak_kpa": (150.0, 150.0), "force_n": (260.0, 243.0)},
    100: {"mean_kpa": (28.0, 22.0), "peak_kpa": (138.0, 138.0), "force_n": (122.0, 115.0)},
}
"""Xie Table 6 by diameter, mm: measured by F-Scan, and simulated by the paper."""
FRAMES_N = {"least": 287.0, "mean": 337.0, "greatest": 387.0}
"""Fig. 21 compares frames of the least, mean and greatest force of one grasp; here on 48 mm. The mean is Table 6's. Of
the others only this is at hand: force drifted by more than 100 N, and the paper simulated it within 14 N. So 50 N to
either side is assumed, and since the force is a target here, the 14 N are no test."""
LABELS = {
    "area_mm2": ("area, cm2", 0.01, 0),
    "mean_kpa": ("mean, kPa", 1.0, 1),
    "peak_kpa": ("peak, kPa", 1.0, 0),
    "force_n": ("force, N", 1.0, 0),
}
"""What a quantity of `virtual_mat` is called, the factor to the unit shown, and its decimals."""


def measured(diameter_mm):
    """Table 6 for a cylinder of that diameter, with the area, mm², that force over mean pressure gives; else None."""
    known = PAPER.get(round(diameter_mm))
    if known is None:
        return None
    areas = tuple(1e3 * force / mean for force, mean in zip(known["force_n"], known["mean_kpa"], strict=True))
    return {"area_mm2": areas} | known


def read_scene(context):
    """What a virtual mat on the scene's product reads of the solved contact.

    Returns `virtual_mat.reading` and `skin`, the same quantities of the skin itself. Raises `Refusal` where nothing is
    solved, the scene changed since, or the product is no cylinder.
    """
    result = context.scene.thenar.result
    if not result.is_valid or workflow.is_out_of_date(context):
        raise Refusal("there is no contact of this scene that a mat could read; press Solve first")
    hand, parts = workflow.check(context)
    seen = workflow.read_job(context, hand, parts).reading
    force, pressure, displacement = (
        attributes.read(hand.data, name).astype(float)
        for name in (names.FORCE_N, names.PRESSURE_KPA, names.DISPLACEMENT_MM)
    )
    is_on = force > 0.0
    if not is_on.any():
        raise Refusal(
            f"'{hand.name}' does not touch '{result.product_name}', so a mat reads nothing; move them together"
        )
    places = seen.hand.posed_mm + displacement - result.offset_mm * np.array(result.direction)
    loads = np.column_stack([places[is_on], force[is_on], 1e3 * force[is_on] / pressure[is_on]])
    product = seen.product
    cylinder = virtual_mat.cylinder_of(result.product_name, product.vertices_mm, product.triangles, loads[:, :3])
    skin = (result.area_mm2, result.mean_kpa, result.peak_kpa, result.force_n)
    reading = virtual_mat.reading(result.product_name, cylinder, loads)
    return reading | {"skin": dict(zip(virtual_mat.QUANTITIES, skin, strict=True))}


def read_frames(context, path):
    """Readings of the grasp of the file `path` at the forces of `FRAMES_N`, by name; the last one stays open.

    The mean frame is the file's own grasp; the others are fitted from its posture by bending joints, as the paper's
    authors did by hand, to a total force within 2 %.
    """
    found = {}
    for name, force_n in FRAMES_N.items():
        headless.open_file(path)
        settings = context.scene.thenar
        if name != "mean":
            wish = fitter.Wish(pads.FIRM_MM, is_placed=True)
            fit = fitting.prepare(context, settings.hand, workflow.product_parts(settings), wish, force_n)
            fitting.finish(context, fit, fitting.compute(fit), "HAND")
        workflow.solve(context)
        found[name] = {"wanted_n": force_n, **read_scene(context)}
    return found


def text(name, bounds):
    """The least and greatest of a quantity of `virtual_mat` in the unit and decimals of `LABELS`, as "77 to 96"."""
    _, factor, decimals = LABELS[name]
    low, high = (f"{factor * value:.{decimals}f}" for value in (bounds[0], bounds[-1]))
    return low if low == high else f"{low} to {high}"


def lines(reading):
    """The table of a reading: by threshold, over all, Table 6 for a diameter of the paper's, and the skin itself."""
    (along, around), placements = reading["pitch_mm"], reading["placements"]
    yield _head(
        "as a mat reads it", f"least to greatest of {placements} placements, pitch {along:.2f} x {around:.2f} mm"
    )
    for row in reading["rows"]:
        yield _line(f"sensels over {row['threshold_kpa']:g} kPa", row)
    yield _line("over all thresholds", reading["range"])
    paper = measured(reading["diameter_mm"])
    if paper is not None:
        yield _line("measured (Xie Table 6)", {name: values[:1] for name, values in paper.items()})
        yield _line("paper's simulation", {name: values[1:] for name, values in paper.items()})
    yield _line("the skin itself, no mat", {name: (value,) for name, value in reading["skin"].items()})


def frame_lines(frames):
    """The table of the readings of `read_frames`."""
    yield _head("force frames (Xie Fig. 21)", "as a mat reads it, over all thresholds and placements")
    for name, reading in frames.items():
        yield _line(f"{name}, {reading['wanted_n']:.0f} N wanted", reading["range"])
    yield "Assumed: 50 N less and more than the mean frame; the figure's own forces are not at hand"


def _head(title, about):
    return f"{title:28}" + "".join(f"{label:>15}" for label, _, _ in LABELS.values()) + f"   {about}"


def _line(title, bounds):
    return f"{title:28}" + "".join(f"{text(name, bounds[name]):>15}" for name in LABELS)
