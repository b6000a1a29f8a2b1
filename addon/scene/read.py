"""Hand and product as arrays in mm about the hand, in world axes. Writes nothing that lasts."""

from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass

import numpy as np
from bpy.types import Context, Depsgraph, Object

from .. import names
from ..ownership import owned
from ..subdivision.last import Last
from . import checks, mesh, regions, units
from .units import Bools, Floats, Ints


@dataclass(frozen=True)
class HandReading:
    """The hand as the library wants it; positions (n, 3) float64, mm."""

    rest_mm: Floats
    posed_mm: Floats
    triangles: Ints
    regions: Ints
    matrix: Floats
    scale: float
    origin_mm: Floats
    warnings: tuple[str, ...] = ()
    last: Last | None = None
    """The Subdivision at the end of the stack that is switched off and computed, or None."""


@dataclass(frozen=True)
class Refinement:
    """What was added to a part: `parents` of each new vertex by level, and areas (mm2) before and after."""

    parents: tuple[Ints, ...]
    own_count: int
    own_areas_mm2: Floats
    areas_mm2: Floats


@dataclass(frozen=True)
class Part:
    """One object's share of the product's vertices, from `first`; `reason` says why it cannot carry results."""

    name: str
    first: int
    count: int
    base_count: int
    reason: str = ""
    refinement: Refinement | None = None
    """How `refine` refined a coarse part, or None."""


@dataclass(frozen=True)
class ProductReading:
    """The product's evaluated surface, parts joined; positions (k, 3) float64, mm."""

    vertices_mm: Floats
    triangles: Ints
    parts: tuple[Part, ...] = ()


@dataclass(frozen=True)
class Reading:
    """Hand and product, read at the same moment."""

    hand: HandReading
    product: ProductReading


def read_hand(context: Context, hand: Object, group_names: Sequence[str], last: Last | None = None) -> HandReading:
    """The hand at rest and posed, about its own centre; `last` is its Subdivision where that is switched off.

    Raises `Refusal` for vertices that are not numbers, an impossible size, or modifiers that reorder vertices.
    """
    mesh.require_vertices(context, hand)
    vertex_regions = regions.vertex_regions(context, hand, group_names)
    _check_regions(hand, vertex_regions)
    depsgraph = context.evaluated_depsgraph_get()
    count = len(hand.data.vertices)
    rest = rest_positions(hand)
    posed = mesh.evaluated_positions(hand, depsgraph, count)
    if last is not None:
        posed = last.level.own_points(posed)
    checks.check_finite(rest, hand.name, "hand")
    checks.check_finite(posed, hand.name, "posed hand")
    matrix, scale = units.world_from_local(hand), units.mm_per_unit(context.scene)
    triangles = mesh.triangles(hand.data)
    skin = mesh.is_used(triangles, count)
    far = units.to_world_mm(posed[skin], matrix, scale, np.zeros(3))
    origin = 0.5 * (far.min(axis=0) + far.max(axis=0))
    posed_mm = units.to_world_mm(posed, matrix, scale, origin)
    checks.check_size(posed_mm[_skin_of_regions(skin, vertex_regions)], hand.name, context.scene)
    if units.is_mirrored(matrix):
        triangles = triangles[:, ::-1].copy()
    return HandReading(
        rest_mm=_stretched(rest, matrix, scale),
        posed_mm=posed_mm,
        triangles=triangles,
        regions=vertex_regions,
        matrix=matrix,
        scale=scale,
        origin_mm=origin,
        warnings=_hand_warnings(hand),
        last=last,
    )


def _skin_of_regions(skin: Bools, vertex_regions: Ints) -> Bools:
    """The skin that has a region, of which a body has its hand's alone; all of it where none has."""
    felt = skin & (vertex_regions >= 0)
    return felt if felt.any() else skin


def read_product(context: Context, parts: Sequence[Object], scale: float, origin_mm: Floats) -> ProductReading:
    """The evaluated surface of all parts and their instances. Raises `Refusal` where there is none."""
    context.view_layer.update()
    depsgraph = context.evaluated_depsgraph_get()
    vertices, triangles, records, first = [], [], [], 0
    for part in parts:
        pieces = list(_pieces(depsgraph, part))
        if not pieces:
            raise checks.Refusal(f"the product '{part.name}' has no faces; give it a surface (a curve needs a bevel)")
        count = 0
        for local, faces, matrix in pieces:
            checks.check_finite(local, part.name, "product")
            vertices.append(units.to_world_mm(local, matrix, scale, origin_mm))
            flipped = faces[:, ::-1] if units.is_mirrored(matrix) else faces
            triangles.append(flipped + first + count)
            count += len(local)
        base_count = len(part.data.vertices) if part.type == "MESH" else 0
        records.append(Part(part.name, first, count, base_count, _carry_problem(context, part, len(pieces))))
        depsgraph = context.evaluated_depsgraph_get()
        first += count
    return ProductReading(np.concatenate(vertices), np.concatenate(triangles).astype(np.int32), tuple(records))


def rest_mm(context: Context, hand: Object) -> Floats:
    """The hand's rest positions (n, 3), mm, in the frame that the library has them in, whatever was solved."""
    return _stretched(rest_positions(hand), units.world_from_local(hand), units.mm_per_unit(context.scene))


def _stretched(rest: Floats, matrix: Floats, scale: float) -> Floats:
    return rest.astype(np.float64) @ units.rest_stretch(matrix, scale).T


def rest_positions(hand: Object) -> Floats:
    """Positions (n, 3) float32 of the hand's first shape, local, Blender units."""
    keys = hand.data.shape_keys
    if keys is None:
        return mesh.positions(hand.data)
    out = np.empty(len(hand.data.vertices) * 3, np.float32)
    keys.reference_key.points.foreach_get("co", out)
    return out.reshape(-1, 3)


def _check_regions(hand: Object, vertex_regions: Ints) -> None:
    if (vertex_regions < 0).all():
        raise checks.Refusal(
            f"no vertex of '{hand.name}' belongs to a region; paint the vertex groups listed under Materials, "
            "or clear that list"
        )


def _hand_warnings(hand: Object) -> tuple[str, ...]:
    if any(modifier.type == "MIRROR" and modifier.show_viewport for modifier in hand.modifiers):
        return (f"a Mirror modifier on '{hand.name}': only the modelled half was pressed; its mirror image repeats it",)
    return ()


def _pieces(depsgraph: Depsgraph, part: Object) -> Iterator[tuple[Floats, Ints, Floats]]:
    """Local positions, triangles and world matrix of the part's own surface and of everything it instances."""
    with mesh.evaluated_mesh(part, depsgraph) if part.type in checks.PRODUCT_TYPES else nullcontext() as surface:
        if surface is not None and len(surface.polygons):
            yield mesh.positions(surface), mesh.triangles(surface), units.world_from_local(part)
    for instance in depsgraph.object_instances:
        if not instance.is_instance or instance.parent is None or instance.parent.original != part:
            continue
        if instance.object.type not in checks.PRODUCT_TYPES:
            continue
        matrix = np.array(instance.matrix_world, dtype=np.float64)
        surface = instance.object.to_mesh()
        try:
            if len(surface.polygons):
                yield mesh.positions(surface), mesh.triangles(surface), matrix
        finally:
            instance.object.to_mesh_clear()


def _carry_problem(context: Context, part: Object, pieces: int) -> str:
    """Why the part's own mesh cannot carry pressure per vertex; empty if it can."""
    if part.type != "MESH":
        return f"it is a {part.type.lower()}"
    if pieces > 1 or not part.data.polygons:
        return "nodes or instances make its surface"
    if not part.data.is_editable or part.data.library is not None:
        return "it is linked from a library"
    if part.data.users - part.data.use_fake_user > 1:
        return "several objects share its mesh"
    foreign = owned.foreign(part.data, names.PRODUCT_ATTRIBUTES)
    if foreign is not None:
        return f"its attribute '{foreign.name}' is not Thenar's"
    if not mesh.keeps_vertices(context, part):
        return "its modifiers change which vertices there are"
    return ""
