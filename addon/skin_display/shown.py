"""The surface that a viewer sees: the evaluated hand with every modifier, and what brings it to the contact.

The key is written first. What it did not bring to the shown vertices, since modifiers ignore it, pull it back or add
vertices of their own, a modifier at the end of the stack adds (see `correction`).
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from bpy.types import Context, Modifier, Object

from .. import names
from ..ownership import own
from ..results.certificate import BETWEEN_MM, TOLERANCE_MM, Found, Surface
from ..scene import attributes, correction, mesh, read, units
from ..scene.checks import Refusal
from ..scene.units import Floats, Ints
from ..steps import PAUSE, Steps, Work
from ..subdivision.last import Last

Measure: TypeAlias = Callable[[Surface, Floats | None], Work]
"""The work that gives a `Found` of a surface, and of how far its own vertices still have to go."""

ADDING = {"SUBSURF", "MULTIRES", "SOLIDIFY", "MIRROR", "ARRAY", "EDGE_SPLIT", "TRIANGULATE", "WIREFRAME", "SCREW"}
"""Modifiers that add vertices; the key is fitted without them, which is faster and does not swing."""
PULLING = {
    "SURFACE_DEFORM", "SHRINKWRAP", "CORRECTIVE_SMOOTH", "LAPLACIANDEFORM", "LAPLACIANSMOOTH", "SMOOTH", "MESH_CACHE",
    "MESH_SEQUENCE_CACHE", "MESH_DEFORM", "CLOTH", "SOFT_BODY", "NODES", *ADDING,
}  # fmt: skip
"""Modifiers that may ignore the key or pull it back."""
WELL_MM = 0.005
"""Error up to which vertices are left as the key has them."""
LOST_MM = 0.05
"""Error at which a contact is not shown and is refused."""


@dataclass(frozen=True)
class Shown:
    """The certificate: what was `found` (`certificate.Found`), and what it took.

    `error_mm`: largest error of the displacement at the hand's own vertices; `moved`: how many vertices of the
    evaluated hand the modifier moves, by `moved_mm` at most; `suspects`: names and kinds of what stands before it.
    """

    found: Found
    error_mm: float
    moved: int
    moved_mm: float
    suspects: tuple[tuple[str, str], ...]


def mark_skin(hand: Object, regions: Ints) -> None:
    """Mark skin for `certify`, where modifiers add vertices."""
    attributes.write(hand.data, names.SHOWN_SKIN, "FLOAT", regions >= 0)


def certify(
    context: Context, hand: Object, reading: read.Reading, wanted_mm: Floats, tools: tuple[Measure, ExitStack]
) -> Steps[Shown]:
    """Bring the shown skin to the contact and measure it; steps that return a `Shown`.

    `wanted_mm` (n, 3), world axes, of the hand's own vertices; `tools`: `measure(surface, left_mm)`, the work
    that gives a `Found`, and the stack of what undoes all this.
    Raises `Refusal` where the shown skin does not follow.
    """
    skin, (measure, undo) = reading.hand, tools
    goal = skin.posed_mm + wanted_mm
    count = len(goal)
    surface = _read(context, hand, skin) if skin.last is None else _computed(context, hand, skin, skin.last)
    attributes.remove(hand.data, [names.SHOWN_SKIN])
    yield PAUSE
    left = goal - surface.points_mm[:count]
    follows = _largest(left) <= WELL_MM
    found = yield measure(surface, None if follows else left)
    far = np.sqrt(np.einsum("ij,ij->i", found.offsets_mm, found.offsets_mm))
    moved, moved_mm = int((far > WELL_MM).sum()), float(far.max(initial=0.0))
    if moved:
        offsets = units.vectors_to_local(found.offsets_mm, skin.matrix, skin.scale)
        correction.attach(hand, offsets, undo)
        if skin.last is None:
            surface = _read(context, hand, skin, surface)
            yield PAUSE
        else:
            surface = replace(surface, points_mm=surface.points_mm + found.offsets_mm, before=found)
        found = yield measure(surface, None)
    if skin.last is not None:
        surface = _switched_on(context, hand, skin, surface)
    error = _largest(goal - surface.points_mm[:count])
    suspects = tuple(_suspects(hand))
    if error > LOST_MM:
        raise Refusal(_refused(hand, error, suspects))
    return Shown(found, error, moved, moved_mm, suspects)


def notes(hand: Object, shown: Shown, origin_mm: Floats) -> Iterator[str]:
    """What a user should know of the shown skin, one sentence each; `origin_mm` (3), of the readings."""
    if shown.moved:
        yield (
            f"the contact's shape key does not get through {_listed(shown.suspects)} of '{hand.name}' unchanged: "
            f"'{names.SHOWN_MODIFIER}' at the end of the stack moves {shown.moved} vertices by up to "
            f"{shown.moved_mm:.2f} mm more, for this pose"
        )
    found = shown.found
    if found.depth_mm > TOLERANCE_MM:
        yield (
            f"the shown skin of '{hand.name}' lies {found.depth_mm:.3f} mm inside the product at "
            f"{_place(found.place_mm, origin_mm)} (vertex {found.vertex})"
        )
    if found.between_mm > BETWEEN_MM:
        yield (
            f"between its vertices the skin of '{hand.name}' cuts up to {found.between_mm:.2f} mm into the product, at "
            f"{_place(found.between_place_mm, origin_mm)}: its triangles are flat; one more Subdivision level "
            "on the hand shows rounds four times closer"
        )
    levels = [modifier for modifier in hand.modifiers if _renders_otherwise(modifier)]
    for modifier in levels:
        yield (
            f"renders show '{modifier.name}' of '{hand.name}' at level {modifier.render_levels}, the view at "
            f"{modifier.levels}: the skin was checked at the view's; set both alike for a certified picture"
        )


def _read(context: Context, hand: Object, skin: read.HandReading, before: Surface | None = None) -> Surface:
    """The evaluated hand as a `Surface`; what `before` tells of the same vertices is taken from there."""
    context.view_layer.update()
    with mesh.evaluated_mesh(hand, context.evaluated_depsgraph_get()) as evaluated:
        local = mesh.positions(evaluated)
        if before is not None and len(before.points_mm) == len(local):
            triangles, counts = before.triangles, before.counts
        else:
            weights = attributes.read(evaluated, names.SHOWN_SKIN)
            counts = np.ones(len(local), bool) if weights is None else weights > 0.999
            triangles = mesh.triangles(evaluated)
            if units.is_mirrored(skin.matrix):
                triangles = triangles[:, ::-1]
    points = units.to_world_mm(local, skin.matrix, skin.scale, skin.origin_mm)
    return Surface(points, triangles, counts, len(skin.posed_mm))


def _computed(context: Context, hand: Object, skin: read.HandReading, last: Last) -> Surface:
    """The hand behind its Subdivision, which is switched off, as a `Surface`."""
    context.view_layer.update()
    with mesh.evaluated_mesh(hand, context.evaluated_depsgraph_get()) as cage:
        local = mesh.positions(cage).astype(np.float64)
        weights = attributes.read(cage, names.SHOWN_SKIN)
    is_skin = np.ones(len(local), bool) if weights is None else weights > 0.999
    points = last.level.points(local)
    triangles = last.level.triangles(points)
    if units.is_mirrored(skin.matrix):
        triangles = triangles[:, ::-1]
    points_mm = units.to_world_mm(points, skin.matrix, skin.scale, skin.origin_mm)
    return Surface(points_mm, triangles, last.level.only(is_skin), len(local))


def _switched_on(context: Context, hand: Object, skin: read.HandReading, computed: Surface) -> Surface:
    """The hand as Blender shows it with its Subdivision on. Raises `DiffersError` where that is not as computed."""
    assert skin.last is not None
    skin.last.put_back(hand)
    found = _read(context, hand, skin, computed)
    home = skin.matrix[:3, 3] * skin.scale - skin.origin_mm
    skin.last.check(hand, found.points_mm - home, computed.points_mm - home)
    return found


def _largest(vectors: Floats) -> float:
    return float(np.sqrt(np.einsum("ij,ij->i", vectors, vectors).max(initial=0.0)))


def _suspects(hand: Object) -> Iterator[tuple[str, str]]:
    for modifier in hand.modifiers:
        if modifier.show_viewport and modifier.type in PULLING and modifier not in own.shown_modifiers(hand):
            yield modifier.name, modifier.bl_rna.name.removesuffix(" Modifier")


def _listed(suspects: Sequence[tuple[str, str]]) -> str:
    return ", ".join(f"'{name}' ({kind})" for name, kind in suspects) or "the modifiers"


def _refused(hand: Object, error_mm: float, suspects: Sequence[tuple[str, str]]) -> str:
    return (
        f"the shown skin of '{hand.name}' stays {error_mm:.2f} mm from the contact behind {_listed(suspects)}; apply "
        "them or switch them off in the viewport, then solve again"
    )


def _place(place_mm: Floats, origin_mm: Floats) -> str:
    return "({:.1f}, {:.1f}, {:.1f}) mm".format(*(place_mm + origin_mm))


def _renders_otherwise(modifier: Modifier) -> bool:
    if modifier.type not in {"SUBSURF", "MULTIRES"} or not (modifier.show_render and modifier.show_viewport):
        return False
    return bool(modifier.render_levels != modifier.levels)
