"""The order of a comparison: press as the scene stands, lay the mat, compare by sensel, write the residual back.

A study is compared with its own skin; where that is the scene's hand, its places and residuals are shown on it.
"""

from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial

import numpy as np

from .. import names, native, status, workflow
from ..contact_fields import written
from ..ownership import own
from ..results import reports
from ..scene import attributes, matching, read, units
from ..scene.checks import Refusal
from . import filling, frames, laying, settings

simulated = {}
"""Scene name -> (`Lie`, what each cell of the mat would read of the contact, kPa, or None), of the last comparison.
Derived: nothing of it lasts."""


@dataclass(frozen=True)
class Cells:
    """Residual and simulated reading of every cell of a mat (n,), NaN where it has no place; None where not known."""

    residual: np.ndarray | None
    simulated: np.ndarray | None


def steps(context):
    """The comparison of the selected recording as the steps of a computation. Returns the library's comparison."""
    problem = native.problem()
    if problem:
        raise Refusal(problem)
    item = settings.chosen(context)
    if item is None:
        raise Refusal("no recording is loaded; load one first")
    state, name = context.scene.thenar_recordings, item.name
    hand, match = context.scene.thenar.hand, None
    if item.kind == settings.STUDY:
        comparison, skin_mm = yield partial(_study, item.path)
        match = matching.on_scene_hand(context, skin_mm)
        told = "" if match is None else _carry(context, comparison, match)
        filling.fill(state.comparison, comparison, (name, None if match is None else hand, match))
        if told:
            state.comparison.notes.add().name = told
    else:
        comparison = yield from _still(context, item)
        filling.fill(state.comparison, comparison, (name, hand, None))
        state.comparison.frame = item.frame if item.kind == settings.MAP else 0
    state.comparison.stamp = reports.keep(comparison)
    return comparison


def _study(path, cancel=None, progress=None):
    """The library's comparison, and the study's skin (n, 3), mm."""
    thenar = native.module
    study = thenar.Study.load(path)
    return thenar.compare(study, progress, cancel), np.asarray(study.skin.vertices_mm)


def _carry(context, comparison, match):
    """Write the largest residual of a study's mats, or its worst print, on the hand. Returns a note, or nothing."""
    hand, parts = context.scene.thenar.hand, workflow.product_parts(context.scene.thenar)
    carried = [each for each in comparison.recordings if each.residual_kpa is not None and len(each.residual_kpa)]
    carried = [each for each in carried if np.isfinite(each.residual_kpa).any()]
    prints = [each for each in comparison.recordings if each.print is not None]
    if not carried and not prints:
        return ""
    if not hand.data.is_editable or hand.mode == "EDIT":
        return f"'{hand.name}' is linked or in Edit Mode, so the residual is not shown on it."
    _take_off(hand, parts)
    if not carried:
        least = min(prints, key=_overlap)
        put(hand.data, match.carried(least.print.print_residual), names.PRINT_RESIDUAL)
        return f"The hand shows where ink and simulation differ in '{least.name}', the print that overlaps least."
    worst = max(carried, key=lambda each: np.nanmax(np.abs(each.residual_kpa)))
    put(hand.data, match.carried(worst.residual_kpa))
    return f"The hand shows the residual of '{worst.name}', the largest of the study."


def _overlap(recording):
    return next(row.simulated for row in recording.measures if row.name == "overlap")


def _still(context, item):
    """Solve, compare one frame with the contact, and write residuals on hand and product."""
    seat = seat_of(context)
    with ExitStack() as taken:
        job = workflow.prepare(context, taken)
        seat = laying.Seat(seat.axes, job.reading.product.vertices_mm)
        request = (seat, laying.lie_of(item), item.name, item.frame_rule, item.frame)
        contact = yield partial(workflow.compute, job)
        by_cell = _compare_print if item.kind == settings.PRINT else _compare
        comparison, mat, cells = yield partial(by_cell, job, contact, request)
        yield from workflow.finish(context, job, contact)
    _write(context, job, (comparison, mat, cells.residual))
    simulated[context.scene.name] = (request[1], cells.simulated)
    return comparison


def seat_of(context):
    """The product as it stands, without Thenar's own move. Raises `Refusal`."""
    hand, parts = workflow.check(context)
    with own.without_own_output(context, hand, parts):
        scale = units.mm_per_unit(context.scene)
        product = read.read_product(context, parts, scale, np.zeros(3))
        return laying.Seat(laying.axes_of(units.world_from_local(parts[0])), product.vertices_mm)


def _compare(job, contact, told, cancel=None, progress=None):
    """The library's comparison, the mat, and the residual of every sensel. No Blender in it."""
    seat, lie, name, rule, number = told
    mat = laying.lay(lie, seat)
    found = frames.map_of(lie.path, lie.mat)
    frame = frames.number_of(found, rule, number)
    is_calibrated = found.pressure_kpa is not None
    limit, unit = found.threshold or (None, found.unit)
    hand = job.reading.hand
    comparison = native.module.compare_map(
        frames.values_of(found)[frame],
        mat,
        hand.posed_mm + np.asarray(contact.displacement_mm) - written.offset_mm(contact, job),
        hand.triangles,
        contact.force_n,
        name=f"{name}, frame {frame + 1}",
        product=", ".join(job.part_names),
        hand=job.hand_name,
        calibrated=is_calibrated,
        threshold=limit if unit == found.unit else None,
        clipped_from=found.clipped_from,
        time_s=0.0 if found.time_s is None else float(found.time_s[frame]),
        unknown=list(found.unknown),
    )
    if not is_calibrated:
        return comparison, mat, Cells(None, None)
    compared = comparison.recordings[0].frames
    read = (compared[0].residual, compared[0].simulated) if compared else (np.nan, np.nan)
    return comparison, mat, Cells(*(_by_cell(mat, values) for values in read))


def _compare_print(job, contact, told, cancel=None, progress=None):
    """The same of a handprint: ink alone 1, simulation alone -1 by cell. No Blender in it."""
    seat, lie, name, *_ = told
    print_, hand = lie.source(), job.reading.hand
    mat = laying.lay(lie, seat, print_)
    comparison = native.module.compare_print(
        print_,
        mat,
        hand.posed_mm + np.asarray(contact.displacement_mm) - written.offset_mm(contact, job),
        hand.triangles,
        contact.force_n,
        ink_kpa=lie.print.ink_kpa,
        regions=[int(number) for number in hand.regions],
        region_names=list(job.region_names),
        name=name,
        product=", ".join(job.part_names),
        hand=job.hand_name,
    )
    return comparison, mat, Cells(_by_cell(mat, comparison.recordings[0].print.cell_residual), None)


def _by_cell(mat, of_placed):
    """What is told of the cells that have a place, for every cell of the mat; NaN for the others."""
    whole = np.full(len(mat.area_mm2), np.nan)
    whole[~np.isnan(mat.area_mm2)] = of_placed
    return whole


def _write(context, job, found):
    """Residuals as attributes on hand and product; none where the mat is not calibrated."""
    comparison, mat, residual = found
    hand, parts = context.scene.thenar.hand, workflow.product_parts(context.scene.thenar)
    _take_off(hand, parts)
    if residual is None:
        return
    recording = comparison.recordings[0]
    is_print = recording.print is not None
    name = names.PRINT_RESIDUAL if is_print else names.RESIDUAL_KPA
    carried = recording.print.print_residual if is_print else recording.residual_kpa
    if carried is not None:
        put(hand.data, carried, name)
    spread = native.module.spread_map(residual, mat, job.reading.product.vertices_mm)
    for record in job.reading.product.parts:
        part = next((part for part in parts if part.name == record.name), None)
        if part is not None and not record.reason:
            put(part.data, spread[record.first : record.first + len(part.data.vertices)], name)
    status.set_stale(context.scene.name, False)


def _take_off(hand, parts):
    for obj in (hand, *parts):
        if obj.type == "MESH" and obj.data.is_editable:
            attributes.remove(obj.data, names.RESIDUAL_ATTRIBUTES)


def put(mesh, residual, name=names.RESIDUAL_KPA):
    """Write residuals (n,), NaN away from the mat or print."""
    residual = np.asarray(residual)
    is_on = np.isfinite(residual)
    attributes.write(mesh, name, "FLOAT", np.where(is_on, residual, 0.0))
    attributes.write(mesh, names.ON_MAT, "FLOAT", is_on.astype(np.float32))
    mesh.update()
