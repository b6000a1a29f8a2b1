"""The order of a comparison: press as the scene stands, lay the mat, compare by sensel, write the residual back."""

from functools import partial

import numpy as np

from .. import native, status, workflow
from ..scene import attributes, own, read, units
from ..scene.checks import Refusal
from . import filling, laying, loading, settings

last = {}
"""By scene: what was compared last, for reports. Not kept in files."""


def steps(context):
    """The comparison of the selected recording as the steps of a computation. Returns the library's comparison."""
    problem = native.problem()
    if problem:
        raise Refusal(problem)
    item = settings.chosen(context)
    if item is None:
        raise Refusal("no recording is loaded; load one first")
    state, name = context.scene.thenar_recordings, item.name
    if item.kind == settings.STUDY:
        comparison = yield partial(_study, item.path)
    else:
        comparison = yield from _still(context, item)
    hand = context.scene.thenar.hand
    filling.fill(state.comparison, comparison, (name, hand))
    last[context.scene.name] = comparison
    return comparison


def _study(path, cancel=None, progress=None):
    thenar = native.module
    return thenar.compare(thenar.Study.load(path), progress, cancel)


def _still(context, item):
    """Solve, compare one frame with the contact, and write residuals on hand and product."""
    seat = seat_of(context)
    job = workflow.prepare(context)
    seat = laying.Seat(seat.axes, job.reading.product.vertices_mm)
    told = (seat, laying.lie_of(item), item.name, item.frame_rule, item.frame)
    contact = yield partial(workflow.compute, job)
    comparison, mat, residual = yield partial(_compare, job, contact, told)
    workflow.finish(context, job, contact)
    _write(context, job, (comparison, mat, residual))
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
    maps = native.module.read_recording(lie.path).maps
    found = next((found for found in maps if found.name == lie.mat), None)
    if found is None:
        raise Refusal(f"'{lie.path}' holds no mat '{lie.mat}' any more; load it again")
    frame = loading.frame_number(found, rule, number)
    is_calibrated = found.pressure_kpa is not None
    limit, unit = found.threshold or (None, found.unit)
    hand = job.reading.hand
    comparison = native.module.compare_map(
        loading.values_of(found)[frame],
        mat,
        hand.posed_mm + np.asarray(contact.displacement_mm) - workflow.offset_mm(contact, job),
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
    return comparison, mat, _residual(comparison, mat) if is_calibrated else None


def _residual(comparison, mat):
    """The residual per sensel of the whole mat, kPa; NaN for missing cells."""
    residual = np.full(len(mat.area_mm2), np.nan)
    frames = comparison.recordings[0].frames
    if frames:
        residual[~np.isnan(mat.area_mm2)] = frames[0].residual
    return residual


def _write(context, job, found):
    """Residuals as attributes on hand and product; none where the mat is not calibrated."""
    comparison, mat, residual = found
    hand, parts = context.scene.thenar.hand, workflow.product_parts(context.scene.thenar)
    for obj in (hand, *parts):
        if obj.type == "MESH" and obj.data.is_editable:
            attributes.remove(obj.data, workflow.names.RESIDUAL_ATTRIBUTES)
    if residual is None:
        return
    carried = comparison.recordings[0].residual_kpa
    if carried is not None:
        put(hand.data, carried)
    spread = native.module.spread_map(residual, mat, job.reading.product.vertices_mm)
    for record in job.reading.product.parts:
        part = next((part for part in parts if part.name == record.name), None)
        if part is not None and not record.reason:
            put(part.data, spread[record.first : record.first + len(part.data.vertices)])
    status.set_stale(context.scene.name, False)


def put(mesh, residual_kpa):
    """Write residuals (n,), kPa, NaN away from the mat."""
    is_on = np.isfinite(residual_kpa)
    attributes.write(mesh, workflow.names.RESIDUAL_KPA, "FLOAT", np.where(is_on, residual_kpa, 0.0))
    attributes.write(mesh, workflow.names.ON_MAT, "FLOAT", is_on.astype(np.float32))
    mesh.update()
