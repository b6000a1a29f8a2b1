"""How large hand and product are, and whether the product's size is a mistake of units. Evaluates no mesh."""

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from bpy.types import Context, Object, Scene
from mathutils import Matrix

from ..ownership import own
from . import checks, mesh, units
from .units import Floats

FACTORS = (1e-3, 1e-2, 1e-1, 0.0254, 1.0 / 0.0254, 10.0, 100.0, 1000.0)
"""What a file in one unit is off by when it is read in another: mm, cm, dm and inches as m, and the other way."""
LONG_MM = 8000.0
"""Products from here on are asked about. A car or a wall is shorter; 80 mm read as cm, or 203 mm as inches, are not."""
THICK_MM = 600.0
"""A product thinner than this is a rail, a rope or a wall, and may be long; a handle in wrong units is thick too."""
SHORT = 1.0 / 50.0
"""Products shorter than this share of the hand are asked about: 4 mm for a whole hand, less for a patch of skin."""
USUAL_MM = (10.0, 1000.0)
"""Longest side of what a hand holds or presses, to which a factor must bring it."""
HAND_MM = 190.0
"""Length of a hand where none is chosen yet: an adult's."""
FEW = 16
"""Parts that are measured at every redraw."""
_KEPT = 20.0
"""A size is kept for so many times what measuring it took: a redraw of many parts must stay cheap."""


@dataclass(frozen=True)
class Sizes:
    """Longest sides, mm; `factors` bring a product that is not believed to a usual size, the likeliest first.

    A product that was just read from a file is believed between 10 mm and 1 m; others, from 1/50 of the hand to 8 m.
    """

    hand_mm: float
    product_mm: float
    factors: tuple[float, ...] = ()

    def __str__(self) -> str:
        return f"Hand {length(self.hand_mm)}, product {length(self.product_mm)}"


_kept: dict[str, tuple[float, tuple[str, int, str], Sizes]] = {}


def measure(scene: Scene, hand: Object | None, parts: Sequence[Object]) -> Sizes:
    """Sizes by the bounding boxes as last evaluated, and factors where the product's is not believed."""
    sizes = _measured(scene, hand, parts)
    return _measured(scene, hand, parts, without_loose=True) if sizes.factors else sizes


def glance(scene: Scene, hand: Object | None, parts: Sequence[Object]) -> Sizes:
    """The same for a panel: kept a moment where there are many parts."""
    if len(parts) <= FEW:
        return measure(scene, hand, parts)
    kept = _kept.get(scene.name)
    began = time.monotonic()
    wanted = hand.name if hand is not None else "", len(parts), parts[0].name
    if kept is not None and began < kept[0] and kept[1] == wanted:
        return kept[2]
    sizes = measure(scene, hand, parts)
    now = time.monotonic()
    _kept[scene.name] = now + _KEPT * (now - began), wanted, sizes
    return sizes


def check_product_size(context: Context, hand: Object, parts: Sequence[Object]) -> None:
    """Refuse a product whose size is a likely mistake of units. Raises `Refusal`, which names sizes and remedy."""
    sizes = measure(context.scene, hand, parts)
    if not sizes.factors:
        return
    factor = sizes.factors[0]
    raise checks.Refusal(
        f"the product '{parts[0].name}' is {length(sizes.product_mm)} long, the hand {length(sizes.hand_mm)}, "
        f"as if its file were read in the wrong unit; scale it by {factor:.4g} to {length(factor * sizes.product_mm)}, "
        "or accept its size, in the Thenar panel"
    )


def accept(scene: Scene, hand: Object | None, parts: Sequence[Object]) -> None:
    """Believe the product's size from now on, as long as it stays so."""
    scene.thenar.accepted_mm = measure(scene, hand, parts).product_mm


def scale_product(context: Context, hand: Object | None, parts: Sequence[Object], factor: float) -> Sizes:
    """Scale the whole product by `factor`; the parts keep their places to each other.

    One object is scaled about its own origin, several about the world's, as their importer would have. Returns the new
    `Sizes`. Raises `Refusal`, with nothing changed, where an object is linked, held by keys, drivers or constraints,
    or carries the hand.
    """
    roots = own.roots(parts)
    for part in roots:
        if not part.is_editable or part.library is not None:
            raise checks.Refusal(f"'{part.name}' is linked; make it local, or scale it in its own file")
    before = measure(context.scene, hand, parts)
    kept = [(part, part.matrix_basis.copy()) for part in roots]
    wanted = [_scaled(part, roots, factor) for part in roots]
    for part, matrix in zip(roots, wanted, strict=True):
        part.matrix_world = matrix
    context.view_layer.update()
    after = measure(context.scene, hand, parts)
    problem = ""
    if hand is not None and abs(after.hand_mm - before.hand_mm) > 1e-3 * before.hand_mm:
        problem = f"the hand '{hand.name}' hangs on the product and would be scaled too; clear its parent first"
    elif abs(after.product_mm - factor * before.product_mm) > 1e-3 * factor * before.product_mm:
        held = ", ".join(f"'{part.name}'" for part in roots)
        problem = f"{held} did not take the scale: keys, a driver or a constraint hold it; scale it by hand"
    if problem:
        for part, basis in kept:
            part.matrix_basis = basis
        context.view_layer.update()
        raise checks.Refusal(problem)
    return after


def length(mm: float) -> str:
    """A length as one reads it: m from 1000 mm on, else mm."""
    return f"{mm / 1000:.4g} m" if mm >= 1000.0 else f"{mm:.3g} mm"


def _measured(scene: Scene, hand: Object | None, parts: Sequence[Object], without_loose: bool = False) -> Sizes:
    """By boxes, or by the vertices of faces where a mesh has others: they take longer, and change the size rarely."""
    scale = units.mm_per_unit(scene)
    sides = np.sort(np.ptp(_corners(parts, without_loose), axis=0)) * scale
    hand_mm = HAND_MM
    if hand is not None:
        hand_mm = float(np.ptp(_corners([hand], without_loose), axis=0).max() * scale)
    product_mm = float(sides[-1])
    too_long = product_mm > LONG_MM and sides[0] > THICK_MM
    low, high = USUAL_MM
    is_unusual = _is_near(product_mm, scene.thenar.added_mm) and not low <= product_mm <= high
    is_doubtful = too_long or product_mm < SHORT * hand_mm or is_unusual
    is_doubtful &= not _is_near(product_mm, scene.thenar.accepted_mm)
    is_doubtful &= checks.HAND_MM[0] <= hand_mm <= checks.HAND_MM[1]  # else the hand is at fault: reported later
    usual = [factor for factor in FACTORS if low <= factor * product_mm <= high] if is_doubtful else []
    nearness = sorted(usual, key=lambda factor: abs(np.log(factor * product_mm / 150.0)))
    return Sizes(hand_mm, product_mm, tuple(nearness))


def _scaled(part: Object, roots: Sequence[Object], factor: float) -> Matrix:
    """The part's world matrix after the scaling."""
    matrix = part.matrix_world.copy()
    place = matrix.translation.copy()
    matrix = matrix * factor
    matrix.translation = place if len(roots) == 1 else place * factor
    matrix[3] = (0.0, 0.0, 0.0, 1.0)
    return matrix


def _is_near(product_mm: float, remembered_mm: float) -> bool:
    return bool(abs(product_mm - remembered_mm) < 0.01 * product_mm)


def _corners(objects: Iterable[Object], without_loose: bool = False) -> Floats:
    """World corners (k, 3) of the objects' boxes, Blender units; of what an empty instances in its stead."""
    boxes = []
    for obj in objects:
        matrix = np.array(obj.matrix_world)
        if obj.instance_type == "COLLECTION" and obj.instance_collection is not None:
            offset = np.array(obj.instance_collection.instance_offset)
            inside = [_box(member) - offset for member in obj.instance_collection.all_objects]
            boxes += [box @ matrix[:3, :3].T + matrix[:3, 3] for box in inside]
        else:
            boxes.append(_box(obj, without_loose))
    return np.concatenate(boxes) if boxes else np.zeros((1, 3))


def _box(obj: Object, without_loose: bool = False) -> Floats:
    matrix = np.array(obj.matrix_world)
    box = np.array(obj.bound_box)
    if without_loose and obj.type == "MESH" and len(obj.data.polygons):
        points, used = mesh.positions(obj.data), np.zeros(len(obj.data.loops), np.int32)
        obj.data.loops.foreach_get("vertex_index", used)
        if not mesh.is_used(used, len(points)).all():
            box = points[used]  # as modelled: boxes know nothing of loose vertices
    corners: Floats = box @ matrix[:3, :3].T + matrix[:3, 3]
    return corners
