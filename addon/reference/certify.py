"""The reference solve of a contact: the hand's tissue as a solid between skin and bone."""

from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from bpy.types import Context, Object, PropertyGroup

from .. import names, native, sentences, workflow
from ..hand import pads, reading, rig_axes, roles, skinning
from ..scene import attributes, checks, units, write
from ..scene.units import Bools, Floats, Ints
from ..steps import Cancel, Progress, Steps

SIDES_MM = 10.0
"""How far beyond the regions, along the skin, tissue may move; what is farther is held."""
LAYERS = 3
MOST_SIDEWAYS = 0.05
"""Share of the force that pushes skin along itself from which a note is given."""


@dataclass(frozen=True)
class Tissue:
    """What the reference solve is given, in mm about the hand's center; nothing in it is a Blender object."""

    job: workflow.Job
    posed_mm: Floats
    triangles: Ints
    bone_mm: Floats
    held: Bools
    shear_modulus_mpa: Floats
    product_mm: Floats
    merged: Ints
    """(n): the vertex of the arrays above that every vertex of the hand is."""


def steps(context: Context) -> Steps[PropertyGroup]:
    """One reference solve as the steps of a computation. Returns the scene's result, with the reference's numbers."""
    with ExitStack() as taken:
        tissue = read(context, taken)
    found = yield partial(press, tissue)
    return finish(context, tissue, found)


def read(context: Context, taken: ExitStack) -> Tissue:
    """The tissue of the scene's hand and its product, as they were solved. Raises `Refusal`."""
    result = context.scene.thenar.result
    check(context)
    job = workflow.prepare(context, taken)
    hand = context.scene.thenar.hand
    skin, thickness = job.reading.hand, _thickness(hand, job)
    modulus = np.array([row.shear_modulus_kpa for row in result.regions]) / units.KPA_PER_MPA
    by_vertex = np.where(skin.regions >= 0, modulus[np.maximum(skin.regions, 0)], modulus.mean())
    first, merged = _merge(skin.rest_mm)
    triangles = merged[skin.triangles]
    triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
    posed = skin.posed_mm[first]
    bone = posed + _ways(context, hand, (posed, triangles, thickness[first]), first)
    return Tissue(
        job=job,
        posed_mm=posed,
        triangles=triangles,
        bone_mm=bone,
        held=_held(posed, triangles, skin.regions[first]),
        shear_modulus_mpa=by_vertex[first],
        product_mm=job.reading.product.vertices_mm + result.offset_mm * np.array(result.direction),
        merged=merged,
    )


def check(context: Context) -> None:
    """Refuse a scene without a fast result that fits it. Raises `Refusal`."""
    result = context.scene.thenar.result
    if not result.is_valid or workflow.is_out_of_date(context):
        raise checks.Refusal("the result is not of the scene as it is now; press Solve, then Certify")
    if result.model != "layer":
        raise checks.Refusal(
            f"the model '{result.model}' has no tissue that could be meshed; choose the model Layer and solve"
        )


def press(tissue: Tissue, cancel: Cancel | None = None, progress: Progress | None = None) -> Any:
    """The native module's record of the reference solve; no Blender in it, so that a thread may run it."""
    try:
        return native.module.reference_press(
            tissue.posed_mm,
            tissue.triangles,
            tissue.bone_mm,
            tissue.shear_modulus_mpa,
            tissue.product_mm,
            tissue.job.reading.product.triangles,
            held=tissue.held.tolist(),
            layers=LAYERS,
            cancel=cancel,
            progress=progress,
        )
    except native.error_types() as error:
        raise sentences.named(error, tissue.job) from None


def finish(context: Context, tissue: Tissue, found: Any) -> PropertyGroup:
    """Write the reference next to the fast result. Raises `Refusal` if the scene changed meanwhile."""
    settings = context.scene.thenar
    result, hand = settings.result, settings.hand
    if not result.is_valid or workflow.is_out_of_date(context):
        raise checks.Refusal("the scene was changed while the reference was solved; solve again, then certify")
    force = np.linalg.norm(np.asarray(found.force_n), axis=1)[tissue.merged]
    shared = np.bincount(tissue.merged, minlength=len(tissue.posed_mm))[tissue.merged]
    pressure = units.kpa(np.asarray(found.pressure_mpa)[tissue.merged])
    regions = tissue.job.reading.hand.regions
    write.write_reference(hand, pressure)
    for index, row in enumerate(result.regions):
        row.reference_n = float((force / shared)[regions == index].sum())
    reference = result.reference
    reference.is_valid = True
    reference.force_n, reference.area_mm2 = found.normal_force_n, found.contact_area_mm2
    reference.patch_peak_kpa = found.patch_peak_mpa * units.KPA_PER_MPA
    reference.note = ". ".join(sentence[0].upper() + sentence[1:] for sentence in _notes(tissue, found))
    return result


def _notes(tissue: Tissue, found: Any) -> list[str]:
    """What the reference does not know, or could not mesh."""
    out = []
    active = [effect.name for effect in tissue.job.effects if effect.amplitude > 0.0 and effect.name != "bone"]
    if active:
        out.append(f"the reference has no effects: {', '.join(active)} act in the fast result alone")
    gaps = native.module.Product(tissue.product_mm, tissue.job.reading.product.triangles).gap_mm(tissue.posed_mm)
    folded = np.asarray(found.folded, dtype=np.int64)
    inside = int((np.asarray(gaps["gap_mm"])[folded] < 0.0).sum()) if len(folded) else 0
    if inside:
        out.append(
            f"in creases at {inside} vertices inside the product tissue could not be meshed; it presses less there"
        )
    if found.sideways_share > MOST_SIDEWAYS:
        out.append(
            f"{found.sideways_share:.0%} of the reference's force pushes skin sideways: the product is thinner there "
            "than twice the depth, and its force is not to be used"
        )
    return out


def _thickness(hand: Object, job: workflow.Job) -> Floats:
    """Tissue over bone (n), mm, as the solve wrote it; 0 away from the skin. Refuses tissue without bone."""
    found = attributes.read(hand.data, names.THICKNESS_MM)
    if found is None or len(found) != len(job.reading.hand.rest_mm):
        raise checks.Refusal(f"'{hand.name}' has no thickness of its tissue; press Solve, then Certify")
    if (found >= write.NO_BONE_MM).any():
        raise checks.Refusal(
            "tissue without bone cannot be meshed; give every material a thickness under Materials, solve, and certify"
        )
    return np.asarray(found, dtype=np.float64)


def _ways(context: Context, hand: Object, skin: tuple[Floats, Ints, Floats], first: Ints) -> Floats:
    """From every posed vertex to the bone under it (k, 3), mm.

    `skin`: posed vertices, triangles, thickness; `first`: the vertices of the hand that those are.
    """
    posed_mm, triangles, thickness = skin
    try:
        rig, stored = reading.read_rig(context, hand)
        joints = roles.resolve(rig, stored)
        armature = reading.armature_of(hand)
    except (rig_axes.RigError, roles.RoleError):
        bone = native.module.bone_points(posed_mm, triangles, thickness)
        return np.asarray(bone) - posed_mm
    rig = replace(rig.subset(first), normals=None)
    scale = float(np.cbrt(np.linalg.det(rig.world_from_rig[:3, :3])))
    heads, tails = rig.rest[:, :3, 3] * scale, reading.tails(rig, armature) * scale
    palmar, is_last = np.zeros((len(rig.names), 3)), [False] * len(rig.names)
    for role, bone in joints.bones.items():
        if role != roles.WRIST and not role.endswith("metacarpal"):
            palmar[bone], is_last[bone] = pads.palmar(rig, joints, role), role.endswith("distal")
    at_rest = native.module.bone_points(
        rig.vertices * scale, triangles, thickness, heads, tails, palmar, is_last, rig.weights
    )
    posed = np.array([armature.pose.bones[name].matrix for name in rig.names], dtype=np.float64)
    moved = skinning.skin(replace(rig, vertices=np.asarray(at_rest) / scale), posed)
    return moved - skinning.skin(rig, posed)


def _merge(rest_mm: Floats) -> tuple[Ints, Ints]:
    """Vertices at one place become one: the first of each place (k), and the place of every vertex (n)."""
    _, first, merged = np.unique(np.round(rest_mm, 6), axis=0, return_index=True, return_inverse=True)
    return first, merged.ravel()


def _held(posed_mm: Floats, triangles: Ints, regions: Ints) -> Bools:
    """(n): tissue far from the regions, which does not move."""
    edges = posed_mm[triangles] - posed_mm[np.roll(triangles, 1, axis=1)]
    spacing = float(np.median(np.linalg.norm(edges, axis=2)))
    reached = regions >= 0
    for _ in range(max(1, round(SIDES_MM / spacing))):
        reached[triangles[reached[triangles].any(axis=1)]] = True
    return ~reached
