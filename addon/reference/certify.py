"""The reference solve of a contact: the hand's tissue as a solid between skin and bone."""

from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from bpy.types import Context, Object, PropertyGroup

from .. import names, native, workflow
from ..contact_fields import skin_edge
from ..hand_look import normals
from ..ownership import own
from ..results import sentences
from ..scene import attributes, checks, units, write
from ..scene.units import Bools, Floats, Ints
from ..soft_grip import covering
from ..steps import Cancel, Progress, Steps
from . import bones, notes

SIDES_MM = 10.0
"""How far beyond the regions, along the skin, tissue may move; what is farther is held."""
LAYERS = 3


@dataclass(frozen=True)
class Tissue:
    """What the reference solve is given, in mm about the hand's center; nothing in it is a Blender object."""

    job: workflow.Job
    posed_mm: Floats
    triangles: Ints
    bone_mm: Floats
    held: Bools
    can_touch: Bools
    shear_modulus_mpa: Floats
    stiffening: Floats
    product_mm: Floats
    merged: Ints
    """(n): the vertex of the arrays above that every vertex of the hand is."""
    first: Ints
    """(k): the vertex of the hand that each of those above is."""
    bones_note: str
    """Why the bones of the rig are not known; empty where they are."""


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
    exponent = np.array([dict(numbers)["stiffening"] for numbers in job.materials])
    by_region = np.maximum(skin.regions, 0)
    modulus = np.where(skin.regions >= 0, modulus[by_region], modulus.mean())
    exponent = np.where(skin.regions >= 0, exponent[by_region], exponent.mean())
    first, merged = _merge(skin.rest_mm)
    triangles = merged[skin.triangles]
    triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
    posed = skin.posed_mm[first]
    product_mm = job.reading.product.vertices_mm + result.offset_mm * np.array(result.direction)
    triangles = _outward(hand, posed, triangles, native.module.Product(product_mm, job.reading.product.triangles))
    ways, bones_note = bones.ways(context, hand, (posed, triangles, thickness[first]), first)
    return Tissue(
        job=job,
        posed_mm=posed,
        triangles=triangles,
        bone_mm=posed + ways,
        held=_held(posed, triangles, skin.regions[first]),
        can_touch=skin.regions[first] >= 0,
        shear_modulus_mpa=modulus[first],
        stiffening=exponent[first],
        product_mm=product_mm,
        merged=merged,
        first=first,
        bones_note=bones_note,
    )


def check(context: Context) -> None:
    """Refuse a scene without a fast result that fits it. Raises `Refusal`."""
    result, hand = context.scene.thenar.result, context.scene.thenar.hand
    if hand is not None and own.bake_modifiers(hand):
        raise checks.Refusal(f"'{hand.name}' plays a bake; press Clear first, then Solve and Certify")
    if not result.is_valid or workflow.is_out_of_date(context):
        raise checks.Refusal("the result is not of the scene as it is now; press Solve, then Certify")
    if result.model != "layer":
        raise checks.Refusal(
            f"the model '{result.model}' has no tissue that could be meshed; choose the model Layer and solve"
        )
    covering.check_rigid(workflow.product_parts(context.scene.thenar), "Certify solves")
    if own.contact_key(hand) is None:
        raise checks.Refusal(
            f"'{hand.name}' has no shape key '{names.SHAPE_KEY}': Apply made the contact part of the mesh; "
            "undo Apply, or solve again"
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
            stiffening=tissue.stiffening,
            can_touch=tissue.can_touch.tolist(),
            layers=LAYERS,
            cancel=cancel,
            progress=progress,
        )
    except native.error_types() as error:
        raise _placed(sentences.named(error, tissue.job), tissue) from None


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
    edge = skin_edge.signed_distance(tissue.posed_mm, tissue.triangles, np.asarray(found.pressure_mpa))
    write.write_reference(hand, pressure, edge[tissue.merged])
    for index, row in enumerate(result.regions):
        row.reference_n = float((force / shared)[regions == index].sum())
    reference = result.reference
    reference.is_valid = True
    reference.force_n, reference.area_mm2 = found.normal_force_n, found.contact_area_mm2
    reference.patch_peak_kpa = found.patch_peak_mpa * units.KPA_PER_MPA
    reference.note = ". ".join(sentence[0].upper() + sentence[1:] for sentence in notes.of(tissue, found))
    return result


def _placed(error: Exception, tissue: Tissue) -> Exception:
    """The error with the hand's vertex and its region in place of the merged vertex."""
    text, regions = str(error), tissue.job.reading.hand.regions
    vertices = [int(tissue.first[vertex]) for vertex in vars(error)["vertices"]]
    for merged, vertex in zip(vars(error)["vertices"], vertices, strict=True):
        region = sentences.titles(tissue.job.region_names)[regions[vertex]] if regions[vertex] >= 0 else "no region"
        text = text.replace(f"skin vertex {merged}", f"skin vertex {vertex} ({region})")
    placed = type(error)(text)
    vars(placed)["vertices"] = vertices
    return placed


def _outward(hand: Object, posed_mm: Floats, triangles: Ints, product: Any) -> Ints:
    """The triangles turned outward: closed skin that is inside out is turned, as in a solve; open skin is refused."""
    corners = posed_mm[triangles] - posed_mm.mean(axis=0)
    if np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) >= 0.0:
        return triangles
    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    if (np.unique(sides, axis=0, return_counts=True)[1] == 2).all():
        return triangles[:, ::-1].copy()
    # The volume of a cupped patch is below zero as well; only skin that is inside out meets the product from behind.
    gaps = product.gap_mm(posed_mm)
    inside = np.asarray(gaps["gap_mm"]) < 0.0
    if (np.asarray(gaps["normal"])[inside] * normals.vertex_normals(posed_mm, triangles)[inside]).sum() > 0.0:
        raise checks.Refusal(
            f"the skin of '{hand.name}' is inside out; turn the normals of the skin outward "
            "(Mesh > Normals > Recalculate Outside), solve, and certify"
        )
    return triangles


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


def _merge(rest_mm: Floats) -> tuple[Ints, Ints]:
    """Vertices at one place become one, in their order: the first of each place (k), and the place of every one (n)."""
    _, first, merged = np.unique(np.round(rest_mm, 6), axis=0, return_index=True, return_inverse=True)
    return np.sort(first), np.argsort(np.argsort(first))[merged.ravel()]


def _held(posed_mm: Floats, triangles: Ints, regions: Ints) -> Bools:
    """(n): tissue far from the regions, which does not move."""
    edges = posed_mm[triangles] - posed_mm[np.roll(triangles, 1, axis=1)]
    spacing = float(np.median(np.linalg.norm(edges, axis=2)))
    reached = regions >= 0
    for _ in range(max(1, round(SIDES_MM / spacing))):
        reached[triangles[reached[triangles].any(axis=1)]] = True
    return ~reached
