"""Which vertices of the product a soft grip covers, with what, and what the library is given of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from bpy.types import Context, Object

from .. import native
from ..scene import checks, regions
from ..scene.read import Part, ProductReading, Reading
from ..scene.units import Bools, Ints
from ..skin_display import refine
from . import settings


@dataclass(frozen=True)
class Grip:
    """`elastomers`: numbers by index; `of_vertex` (k,) int32: the index of every product vertex, -1 where rigid."""

    elastomers: tuple[settings.Numbers, ...]
    of_vertex: Ints


def read(context: Context, parts: Sequence[Object], product: ProductReading) -> Grip | None:
    """The product's grip, or None where all of it is rigid. Raises `Refusal`."""
    elastomers, of_vertex = [], np.full(len(product.vertices_mm), -1, np.int32)
    for part, record in zip(parts, product.parts, strict=True):
        found = settings.numbers(part)
        if found is None:
            continue
        if context.scene.thenar.model == "PAPER":
            raise checks.Refusal(
                f"'{part.name}' has a soft grip, and the paper's model presses rigid products only; "
                "choose the model Layer on bone, or Rigid under Soft Grip"
            )
        mine = of_vertex[record.first : record.first + record.count]
        if found not in elastomers:
            elastomers.append(found)
        mine[_covered(context, part, record)] = elastomers.index(found)
    return Grip(tuple(elastomers), of_vertex) if elastomers else None


def refined(reading: Reading, grip: Grip | None) -> tuple[Reading, Grip | None]:
    """The product as fine as its map needs, or its grip, which goes along."""
    finer = refine.refined(reading.product, reading.hand, refine.FOR_MAPS if grip is None else refine.FOR_GRIPS)
    return Reading(reading.hand, finer), grip and _carried(grip, reading.product, finer)


def elastomers(grip: Grip | None) -> "list[native.Elastomer] | None":
    """The grip's elastomers as the library wants them, or None where the product is rigid."""
    return None if grip is None else [native.module.Elastomer(*numbers) for numbers in grip.elastomers]


def hashed(grip: Grip | None) -> tuple[object, ...]:
    """What a digest of the input takes of it."""
    return () if grip is None else (grip.elastomers, grip.of_vertex)


def _carried(grip: Grip, before: ProductReading, after: ProductReading) -> Grip:
    """The same grip on the refined product: a new vertex is soft where both ends of its edge are."""
    out = []
    for old, new in zip(before.parts, after.parts, strict=True):
        mine = grip.of_vertex[old.first : old.first + old.count]
        for parents in () if new.refinement is None else new.refinement.parents:
            a, b = mine[parents[:, 0]], mine[parents[:, 1]]
            mine = np.concatenate([mine, np.where(a == b, a, -1)])
        out.append(mine)
    return replace(grip, of_vertex=np.concatenate(out).astype(np.int32))


def check_rigid(parts: Sequence[Object], doer: str) -> None:
    """Refuse a soft product for what presses rigid ones only. Raises `Refusal`."""
    for part in parts:
        if settings.numbers(part) is not None:
            raise checks.Refusal(
                f"'{part.name}' has a soft grip, but {doer} rigid products only; choose Rigid under Soft Grip"
            )


def _covered(context: Context, part: Object, record: Part) -> slice | Bools:
    name = part.thenar.grip.group
    if not name:
        return slice(None)
    if part.type != "MESH" or name not in part.vertex_groups:
        raise checks.Refusal(
            f"'{part.name}' has no vertex group '{name}' that its soft grip names; choose another, or clear Group"
        )
    if record.count != len(part.data.vertices) or record.reason:
        why = record.reason or "its modifiers change which vertices there are"
        raise checks.Refusal(
            f"the group '{name}' of '{part.name}' cannot say where its soft grip is: {why}; mend that, or clear Group"
        )
    covered: Bools = regions.group_weights(context, part, [name])[0] >= settings.LEAST_WEIGHT
    if not covered.any():
        raise checks.Refusal(
            f"no vertex of '{part.name}' weighs {settings.LEAST_WEIGHT:g} or more in '{name}', which its soft grip "
            "names; paint the group, or clear Group"
        )
    return covered
