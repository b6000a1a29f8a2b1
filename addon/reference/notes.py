"""What the reference solve does not know, could not mesh, or lets through: one sentence each."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from .. import native
from ..properties import effect_settings

MOST_SIDEWAYS = 0.05
"""Share of the force that pushes skin along itself from which a note is given."""
MOST_CUT_MM = 0.1
"""How deep the product may lie in the skin between its vertices without a note."""
WIDEST_MM = 3.2
"""Spacing of the skin in contact from which a note is given: twice the edge to which the solve refines. On the
index pad the force is within 3 % (rms) to there, and 8 % off at 5 mm (`rust/reference/tests/pads.rs`)."""


def of(tissue: Any, found: Any) -> Iterator[str]:
    """The notes on a record `found` of the native module."""
    active = [effect.name for effect in tissue.job.effects if effect.amplitude > 0.0 and effect.name != "bone"]
    if active:
        listed = ", ".join(effect_settings.title(name).lower() for name in active)
        yield (
            f"the reference has no effects: {listed} acts in the fast result alone"
            if len(active) == 1
            else f"the reference has no effects: {listed} act in the fast result alone"
        )
    gaps = native.module.Product(tissue.product_mm, tissue.job.reading.product.triangles).gap_mm(tissue.posed_mm)
    inside = np.asarray(gaps["gap_mm"]) < 0.0
    bare = int((inside & ~tissue.can_touch).sum())
    if bare:
        yield f"at {_vertices(bare)} inside the product the skin has no region; no force acts there in either result"
    folded = int(inside[np.asarray(found.folded, dtype=np.int64)].sum())
    if folded:
        yield (
            f"in creases at {_vertices(folded)} inside the product tissue could not be meshed; it presses less there"
        )
    if found.cut_mm > MOST_CUT_MM:
        yield (
            f"between the vertices of the skin the product cuts up to {found.cut_mm:.2f} mm into it, with "
            f"{found.cut_share:.1%} of the overlap: the reference's force is too low by about that share; subdivide "
            "the hand there, or round the product's edges (Bevel)"
        )
    if found.sideways_share > MOST_SIDEWAYS:
        yield (
            f"{found.sideways_share:.0%} of the reference's force acts along the skin or from behind it, and not into "
            "it, as at the sides of a product, in a slot, or on skin that faces away; that force is not to be used"
        )
    if tissue.bones_note:
        yield (
            f"the bones of the rig are not known: {tissue.bones_note}; bone is taken at the tissue's thickness below "
            "the skin"
        )
    spacing = _spacing(tissue, found)
    if spacing > WIDEST_MM:
        yield (
            f"the skin in contact has vertices {spacing:.1f} mm apart, too far for the reference; subdivide the hand "
            "there"
        )


def _vertices(count: int) -> str:
    return "1 vertex" if count == 1 else f"{count} vertices"


def _spacing(tissue: Any, found: Any) -> float:
    """Median length of the edges in contact, mm; 0 without contact."""
    touched = tissue.triangles[(np.asarray(found.pressure_mpa) > 0.0)[tissue.triangles].any(axis=1)]
    edges = tissue.posed_mm[touched] - tissue.posed_mm[np.roll(touched, 1, axis=1)]
    return float(np.median(np.linalg.norm(edges, axis=2))) if len(touched) else 0.0
