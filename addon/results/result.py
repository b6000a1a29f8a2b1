"""A contact's numbers: from the native record into the file's properties, and out again as JSON."""

from collections.abc import Sequence
from functools import lru_cache
from math import isfinite
from typing import Any

import numpy as np
from bpy.types import PropertyGroup

from .. import names
from ..scene.units import KPA_PER_MPA
from ..scene.write import WriteReport
from . import grades

FINGERS = ("thumb", "index", "middle", "ring", "little")


def fill(result: PropertyGroup, job: Any, contact: Any, written: WriteReport, notes: Sequence[str]) -> PropertyGroup:
    """Fill `scene.thenar.result` from a native contact, the write report and the contact's notes. Returns it."""
    result.region_index = 0
    result.reference.is_valid, result.reference.note = False, ""
    result.schema, result.is_valid, result.is_held_known = names.SCHEMA, True, False
    result.hand_name, result.product_name = job.hand_name, ", ".join(job.part_names)
    result.model, result.vertices = job.model, len(job.reading.hand.rest_mm)
    result.effects = ", ".join(f"{effect.name} {effect.amplitude:g}" for effect in job.effects)
    total, origin = np.asarray(contact.total_force_n).tolist(), job.reading.hand.origin_mm.tolist()
    result.force_n = float(np.asarray(contact.force_n).sum())
    result.force_vector_n = total
    result.shear_n = 0.0 if contact.friction is None else float(np.linalg.norm(contact.friction.total_force_n))
    result.shear_peak_kpa, result.slipping = _slip(contact)
    result.moment_nmm = _sum(contact.total_moment_nmm, _cross(origin, total))
    result.center_mm = _finite(_sum(contact.center_of_pressure_mm, origin))
    result.area_mm2 = contact.contact_area_mm2
    result.peak_kpa = contact.peak_pressure_mpa * KPA_PER_MPA
    result.patch_peak_kpa = contact.patch_peak_mpa * KPA_PER_MPA
    result.mean_kpa = contact.mean_pressure_mpa * KPA_PER_MPA
    result.depth_mm = abs(float(np.fmin.reduce(np.asarray(contact.gap_mm), initial=0.0)))
    left = contact.residual
    result.penetration_mm, result.complementarity = left["penetration_mm"], left["complementarity"]
    result.load_balance = left["load_balance"]
    result.write_error_mm = written.error_mm
    _add_shown(result, written.shown, origin)
    _add_grip(result, job, contact)
    _add_grade(result, contact)
    result.offset_mm = float(contact.offset_mm) if job.force_n is not None else 0.0
    result.direction = _finite(np.asarray(contact.direction).tolist())
    result.input_hash = job.input_hash
    result.made_with = f"Thenar {names.VERSION}"
    _add_regions(result, job, contact)
    _add_stages(result, job, contact)
    texts = (*job.reading.hand.warnings, *written.notes, *notes)
    for row, text in zip(_sized(result.warnings, len(texts)), texts, strict=True):
        row.name = text
    return result


def _add_grip(result: PropertyGroup, job: Any, contact: Any) -> None:
    """How deep a soft grip yields, mm and as a share of its thickness."""
    result.grip_mm = result.grip_share = 0.0
    if job.grip is None:
        return
    yielded = np.linalg.norm(np.asarray(contact.grip_displacement_mm), axis=1)
    thickness = np.array([numbers[0] for numbers in job.grip.elastomers])
    soft = job.grip.of_vertex >= 0
    result.grip_mm = float(yielded[soft].max(initial=0.0))
    result.grip_share = float((yielded[soft] / thickness[job.grip.of_vertex[soft]]).max(initial=0.0))


def add_holding(result: PropertyGroup, held: Any) -> None:
    """Keep a `holding.Holding`: how well the product is held; without one nothing is said of it."""
    result.is_held_known = held is not None
    if held is None:
        return
    result.is_force_closed, result.held_share = held.quality.is_closed, held.quality.least
    result.held_n = held.quality.least * held.sum_n
    result.held_friction, result.held_arm_mm = held.friction, held.arm_mm


def clear(result: PropertyGroup) -> None:
    """Forget the result."""
    _clear_rows(result)
    result.is_held_known = False
    result.is_valid = result.reference.is_valid = False
    result.input_hash = result.state_hash = result.comfort = result.comfort_source = ""
    result.grade = result.reason = result.reason_kind = ""
    result.reason_vertex = -1
    result.passes_between = False


def as_dict(result):
    """The result as plain values for JSON; units stand in the keys."""
    rows = [_row_dict(row) for row in result.regions]
    return {
        "schema": result.schema,
        "grade": result.grade,
        "reason": result.reason,
        "hand": result.hand_name,
        "product": result.product_name,
        "model": result.model,
        "effects": result.effects,
        "vertices": result.vertices,
        "force_n": result.force_n,
        "force_vector_n": list(result.force_vector_n),
        "shear_force_n": result.shear_n,
        "peak_shear_kpa": result.shear_peak_kpa,
        "slipping_share": result.slipping,
        "moment_nmm": list(result.moment_nmm),
        "center_of_pressure_mm": list(result.center_mm),
        "contact_area_mm2": result.area_mm2,
        "peak_pressure_kpa": result.peak_kpa,
        "patch_peak_kpa": result.patch_peak_kpa,
        "mean_pressure_kpa": result.mean_kpa,
        "max_penetration_before_mm": result.depth_mm,
        "penetration_after_mm": result.penetration_mm,
        "write_back_error_mm": result.write_error_mm,
        "shown_penetration_mm": result.shown_penetration_mm,
        "shown_between_mm": result.shown_between_mm,
        "shown_place_mm": list(result.shown_place_mm),
        "shown_vertex": result.shown_vertex,
        "shown_corrected_vertices": result.shown_corrected,
        "shown_corrected_by": result.shown_blame,
        "complementarity": result.complementarity,
        "load_balance": result.load_balance,
        "over_threshold_mm2": result.over_mm2,
        "comfort": result.comfort,
        "comfort_source": result.comfort_source,
        "reference": _reference_dict(result),
        "holding": _holding_dict(result),
        "offset_mm": result.offset_mm,
        "grip_mm": result.grip_mm,
        "grip_share_of_thickness": result.grip_share,
        "direction": list(result.direction),
        "regions": rows,
        "fingers": [_row_dict(row) for row in result.fingers],
        "seconds": {stage.name: stage.seconds for stage in result.stages},
        "warnings": [text.name for text in result.warnings],
        "input_hash": result.input_hash,
        "made_with": result.made_with,
    }


@lru_cache(maxsize=256)
def finger_of(region_name):
    """The finger or part of the hand that a region belongs to: palm for all of the palm, else its name's first word."""
    words = region_name.lower().replace(".", "_").replace("-", "_").replace(" ", "_").split("_")
    if words[0] in FINGERS:
        return words[0]
    return "palm" if any("palm" in word or "thenar" in word for word in words) else words[0] or region_name


def _clear_rows(result):
    for rows in (result.regions, result.fingers, result.stages, result.warnings):
        rows.clear()
    result.region_index = 0


def _sized(rows, count):
    """So many rows, those that are there kept: Live fills them anew every frame, and making one takes longer."""
    while len(rows) > count:
        rows.remove(len(rows) - 1)
    while len(rows) < count:
        rows.add()
    return rows


def _add_regions(result, job, contact):
    """Row by row: `foreach_set` is no faster for so few, and makes Blender evaluate the scene anew."""
    records, fingers = contact.regions, {}
    for index, (row, record) in enumerate(zip(_sized(result.regions, len(records)), records, strict=True)):
        name, peak, mean = job.region_names[index], record["peak_mpa"] * KPA_PER_MPA, record["mean_mpa"] * KPA_PER_MPA
        force, area, depth = record["force_n"], record["area_mm2"], max(record["dmax_mm"], 0.0)
        row.name, row.force_n, row.area_mm2, row.peak_kpa, row.mean_kpa = name, force, area, peak, mean
        row.depth_mm, row.shear_modulus_kpa = depth, record["g_mpa"] * KPA_PER_MPA
        fingers.setdefault(finger_of(name), []).append((force, area, peak, depth))
    if len(fingers) < 2:
        result.fingers.clear()
        return
    for total, (name, members) in zip(_sized(result.fingers, len(fingers)), fingers.items(), strict=True):
        force, area, peak, depth = zip(*members, strict=True)
        total.name, total.force_n, total.area_mm2 = name, sum(force), sum(area)
        total.peak_kpa, total.depth_mm = max(peak), max(depth)
        total.mean_kpa = total.force_n / total.area_mm2 * KPA_PER_MPA if total.area_mm2 > 0.0 else 0.0


def _add_shown(result, shown, origin):
    """The certificate of the shown surface; Live writes none, and its -1 says that nothing was measured."""
    result.shown_penetration_mm = result.shown_between_mm = -1.0
    result.shown_vertex, result.shown_corrected, result.shown_blame = -1, 0, ""
    result.shown_place_mm = (0.0, 0.0, 0.0)
    if shown is None:
        return
    found = shown.found
    result.shown_penetration_mm, result.shown_between_mm = found.depth_mm, found.between_mm
    result.shown_vertex, result.shown_corrected = found.vertex, shown.moved
    if found.vertex >= 0:
        place = found.place_mm if found.depth_mm >= found.between_mm else found.between_place_mm
        result.shown_place_mm = _sum(place, origin)
    result.shown_blame = ", ".join(name for name, _ in shown.suspects) if shown.moved else ""


def _add_grade(result, contact):
    shown_mm, vertex = result.shown_penetration_mm, result.shown_vertex
    found = grades.judge(contact, shown_mm, vertex)
    result.grade, result.reason = found.grade, found.reason
    result.reason_kind, result.reason_vertex = found.kind, found.vertex
    result.passes_between = False


def _add_stages(result, job, contact):
    stages = dict(job.seconds)
    for name, seconds in _items(contact.seconds):
        stages[f"press: {name}"] = seconds
    for row, (name, seconds) in zip(_sized(result.stages, len(stages)), stages.items(), strict=True):
        row.name, row.seconds = name, seconds


def _items(record):
    return record.items() if hasattr(record, "items") else vars(record).items()


def _row_dict(row):
    keys = ("name", "force_n", "area_mm2", "peak_kpa", "mean_kpa", "depth_mm", "shear_modulus_kpa", "threshold_kpa")
    return {key: getattr(row, key) for key in keys} | {"over_threshold_mm2": row.over_mm2}


def _holding_dict(result):
    """How well the product is held (Ferrari and Canny 1992), or None where that was not computed, as in Live."""
    if not result.is_held_known:
        return None
    return {
        "friction": result.held_friction,
        "is_force_closed": result.is_force_closed,
        "smallest_wrench_share": result.held_share,
        "smallest_wrench_n": result.held_n,
        "torque_arm_mm": result.held_arm_mm,
    }


def _reference_dict(result):
    """The reference solve's numbers, with the force of every region; None where it was not solved."""
    reference = result.reference
    if not reference.is_valid:
        return None
    return {
        "force_n": reference.force_n,
        "contact_area_mm2": reference.area_mm2,
        "patch_peak_kpa": reference.patch_peak_kpa,
        "note": reference.note,
        "regions": [{"name": row.name, "force_n": row.reference_n} for row in result.regions],
    }


def _slip(contact):
    """Largest shear traction, kPa, and the share of the contact's area on which skin slips; zeros without friction."""
    if contact.friction is None:
        return 0.0, 0.0
    force, pressure = np.asarray(contact.force_n), np.asarray(contact.pressure_mpa)
    area = np.divide(force, pressure, out=np.zeros_like(force), where=pressure > 0.0)
    slips = (pressure > 0.0) & ~np.asarray(contact.is_sticking)
    shear = float(np.asarray(contact.tangential_traction_mpa).max(initial=0.0)) * KPA_PER_MPA
    return shear, float(area[slips].sum() / max(area.sum(), 1e-12))


def _cross(a, b):
    """Of two vectors, as plain numbers like all of three here: numpy takes many times as long."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _sum(array, values):
    return tuple(a + b for a, b in zip(np.asarray(array).tolist(), values, strict=True))


def _finite(values):
    return tuple(value if isfinite(value) else 0.0 for value in values)
