"""Hands in random postures with a random product at them, pressed by the module alone, and the verdict on each press.

A posture's seed alone decides it. The hand is bent by a linear blend of our own; the product comes straight from afar,
touches skin, and goes on by `travel_mm`: taken back by as much it would touch nothing, so no skin has reason to move
farther than that, and the allowance is `SPARE_MM` beyond it.
"""

import json
import time
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import thenar
from handles import measuring, random_products

PERCENTILES = (1.0, 5.0, 50.0, 95.0, 99.0)
SPARE_MM = 3.0
LEFT_MM = 0.05
PEAK_MPA = 0.6
THROUGH_MM, RIM_MM, THROUGH_RIM_MM = 1.5, 3.0, 4.0
"""A product deeper than this under the written skin went through it. Within 3 mm of a rim or sharp edge, skin whose
vertices are 2.5 to 3 mm apart may span it: there only what is deeper than 4 mm is counted."""
THIN = ("plate", "sheet", "fork", "wire", "tube")
LEAST_MM, MOST_MM = 0.3, 8.0
SECONDS = 30.0
TRIES = 400
MATERIAL_NUMBERS = (
    *("g0_mpa", "g_lim_mpa", "d_lim_mm", "thickness_mm", "poisson_ratio", "zone_mm"),
    *("swelling_height_mm_per_n", "swelling_radius_mm", "swelling_width_mm"),
)
MODULE_ERRORS = (thenar.ThenarError, ValueError)


@dataclass(frozen=True)
class HandArrays:
    """A made hand, its materials, and which vertices are skin."""

    made: object
    materials: list
    is_skin: np.ndarray

    def arrays(self):
        """What another process needs to make the skin again, as `numpy.savez` takes it."""
        numbers = [{name: getattr(material, name) for name in MATERIAL_NUMBERS} for material in self.materials]
        return {
            "vertices": self.made["vertices_mm"],
            "triangles": self.made["triangles"],
            "regions": self.made["regions"],
            "materials": json.dumps(numbers),
            "region_names": json.dumps(list(self.made["region_names"])),
        }


@dataclass(frozen=True)
class Posture:
    """A hand of one `percentile` posed (n, 3), a product in the world, and how far it went on after first touch.

    `lean`: the unit way back out of the hand.
    """

    seed: int
    percentile: float
    posed: np.ndarray
    product: random_products.Made
    vertices: np.ndarray
    lean: np.ndarray
    travel_mm: float
    overlap_mm: float
    draws: int


@lru_cache(maxsize=8)
def hand_of(percentile):
    """The made hand of that size with the presets that Make Hand gives it."""
    made = thenar.hand(percentile=percentile)
    preset = {"finger": thenar.Material.finger_layer(), "palm": thenar.Material.palm_layer()}
    each = zip(made["kind"], made["thickness_mm"], strict=True)
    materials = [preset[kind].replace(thickness_mm=float(thickness)) for kind, thickness in each]
    return HandArrays(made, materials, np.asarray(made["regions"]) >= 0)


@lru_cache(maxsize=8)
def skin_of(percentile):
    """The prepared skin of that hand."""
    return _prepared(hand_of(percentile))


@lru_cache(maxsize=5)
def refined_of(percentile):
    """That hand with every triangle cut in four at the middles of its edges: (`HandArrays`, its skin, edges (k, 2)).

    The shape stays; a middle takes the mean thickness of its ends and, where they differ, the lesser region's number.
    """
    hand = hand_of(percentile)
    triangles = np.asarray(hand.made["triangles"])
    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges, index = np.unique(sides, axis=0, return_inverse=True)
    ab, bc, ca = index.reshape(3, -1) + len(hand.made["vertices_mm"])
    a, b, c = triangles.T
    cut = np.concatenate([np.stack(corners, 1) for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    made = {
        "vertices_mm": with_middles(hand.made["vertices_mm"], edges),
        "triangles": cut,
        "regions": np.concatenate([hand.made["regions"], np.asarray(hand.made["regions"])[edges].min(axis=1)]),
        "region_names": hand.made["region_names"],
    }
    fine = HandArrays(made, hand.materials, made["regions"] >= 0)
    return fine, _prepared(fine), edges


def with_middles(positions, edges):
    """Positions (n, 3), and after them the middles of the edges (k, 2)."""
    positions = np.asarray(positions)
    return np.concatenate([positions, positions[edges].mean(axis=1)])


def _prepared(hand):
    return thenar.Skin(
        hand.made["vertices_mm"],
        hand.made["triangles"],
        regions=hand.made["regions"],
        materials=hand.materials,
        model="layer",
        region_names=list(hand.made["region_names"]),
    )


def bent(made, rng):
    """Vertices (n, 3) with every joint turned at random within its limits (degrees from rest), parents first."""
    place = {None: (np.eye(3), np.zeros(3))}
    posed = np.zeros_like(made["vertices_mm"])
    weights = np.asarray(made["weights"], float)
    for bone, weight in zip(made["bones"], (weights / weights.sum(axis=1, keepdims=True)).T, strict=True):
        limits = bone["limits_deg"]
        flexion, abduction = (np.radians(rng.uniform(*limits[way])) for way in ("flexion", "abduction"))
        turn, shift = place[bone["parent"]]
        own = turned(bone["abduction_axis"], abduction) @ turned(bone["flexion_axis"], flexion)
        head = np.asarray(bone["head_mm"])
        turn, shift = turn @ own, turn @ (head - own @ head) + shift
        place[bone["name"]] = turn, shift
        posed += weight[:, None] * (made["vertices_mm"] @ turn.T + shift)
    return posed


def turned(axis, angle):
    """Rotation (3, 3) by `angle` (rad) about `axis`, from a quaternion."""
    w, (x, y, z) = np.cos(angle / 2.0), np.sin(angle / 2.0) * np.asarray(axis) / np.linalg.norm(axis)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def draw(seed):
    """The posture of that seed; what does not touch skin first, or too deep or hardly, is drawn again."""
    rng = np.random.default_rng(seed)
    percentile = PERCENTILES[seed // len(random_products.KINDS) % len(PERCENTILES)]
    hand = hand_of(percentile)
    kind = random_products.kind_of(seed)
    for attempt in range(1, TRIES + 1):
        if attempt % 20 == 1:
            posed = bent(hand.made, rng)
            normals = outward_normals(posed, hand.made["triangles"])
        product = random_products.draw(kind, rng)
        laid = _lay(hand, (posed, normals), product, rng)
        if laid is None:
            continue
        vertices, lean, travel = laid
        overlap = overlap_of(hand, posed, vertices, product)
        if LEAST_MM <= overlap <= MOST_MM:
            return Posture(seed, percentile, posed, product, vertices, lean, travel, overlap, attempt)
    raise RuntimeError(f"no posture of seed {seed} in {TRIES} draws")


def overlap_of(hand, posed, vertices, product):
    """How deep hand and product lie in each other: skin in the product, and product under the skin where it is thin."""
    deepest = 0.0
    if product.is_closed:
        deepest = measuring.depths(posed[hand.is_skin], vertices, product.triangles).max()
    if deepest >= LEAST_MM:
        return float(deepest)
    return max(float(deepest), under_skin(hand, posed, vertices, product.triangles)[0])


def under_skin(hand, positions, vertices, triangles):
    """How deep the product lies under the skin of these `positions`: at most, and at most off its rims, mm."""
    box = positions[hand.is_skin].min(axis=0), positions[hand.is_skin].max(axis=0)
    samples = measuring.sampled(vertices, triangles, 1.5, box)
    under = measuring.sunk(samples, positions, hand.made["triangles"], hand.is_skin)
    deep, rims = np.flatnonzero(under > THROUGH_MM), measuring.rims(vertices, triangles)
    if len(deep) == 0 or len(rims) == 0:
        return float(under.max(initial=0.0)), float(under.max(initial=0.0))
    off = measuring.distances(samples[deep], vertices, rims[:, [0, 1, 1]])[0] > RIM_MM
    return float(under.max()), float(under[deep[off]].max(initial=0.0))


def _lay(hand, shape, product, rng):
    """The product at a random place of the skin, come from outside: (its vertices, way back, travel after touch)."""
    posed, normals = shape
    at = rng.choice(np.flatnonzero(hand.is_skin))
    lean = normals[at] + 0.5 * rng.normal(size=3)
    lean /= np.linalg.norm(lean)
    way = turned(rng.normal(size=3), rng.uniform(0.0, np.pi))
    if product.kind in ("plate", "sheet") and rng.random() < 0.6:
        way = _facing(lean, rng.uniform(0.0, 2.0 * np.pi))
    point = product.vertices[rng.integers(len(product.vertices))] * rng.uniform(0.0, 1.0)
    travel = rng.uniform(0.5, 6.0)
    points = np.concatenate([posed, posed[hand.made["triangles"]].mean(axis=1)])
    far = 400.0
    base = posed[at] - way @ point
    for _ in range(200):
        distance = product.distance((points - base - far * lean) @ way)
        nearest = distance.argmin()
        if distance[nearest] < 0.02 or far < -60.0:
            break
        far -= distance[nearest]
    if distance[nearest] >= 0.02 or not _is_skin(hand, nearest):
        return None
    return product.vertices @ way.T + base + (far - travel) * lean, lean, travel


def _is_skin(hand, index):
    """Whether that vertex, or beyond them that triangle, is skin."""
    count = len(hand.is_skin)
    if index < count:
        return bool(hand.is_skin[index])
    return bool(hand.is_skin[hand.made["triangles"][index - count]].all())


def _facing(normal, spin):
    """Axes (columns) whose third is `normal`, the others turned by `spin`."""
    side = np.cross(normal, [0.3, -0.5, 0.81])
    side /= np.linalg.norm(side)
    other = np.cross(normal, side)
    first = np.cos(spin) * side + np.sin(spin) * other
    return np.stack([first, np.cross(normal, first), normal], axis=1)


def outward_normals(positions, triangles):
    """Unit normals (n, 3), the sum of the triangles' around each vertex by area."""
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    out = np.zeros_like(positions)
    for k in range(3):
        np.add.at(out, triangles[:, k], np.cross(b - a, c - a))
    return out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-12)


def press(posture, is_refined=False):
    """What the module makes of it, as one row: refused, or numbers with the skin measured independently.

    `is_refined`: on the hand of `refined_of`, in the same pose.
    """
    hand, skin, posed = hand_of(posture.percentile), skin_of(posture.percentile), posture.posed
    if is_refined:
        hand, skin, edges = refined_of(posture.percentile)
        posed = with_middles(posed, edges)
    row = {
        "kind": posture.product.kind,
        "percentile": posture.percentile,
        "closed": posture.product.is_closed,
        "draws": posture.draws,
        "travel_mm": posture.travel_mm,
        "overlap_mm": posture.overlap_mm,
        **posture.product.sizes,
    }
    ends = time.monotonic() + SECONDS
    started = time.process_time()
    try:
        contact = skin.press(
            posture.vertices,
            posture.product.triangles,
            posed_vertices_mm=posed,
            cancel=lambda: time.monotonic() > ends,
        )
    except thenar.Cancelled:
        return row | {"hung": f"no answer in {SECONDS:.0f} s"}
    except MODULE_ERRORS as error:
        return row | {"refused": f"{type(error).__name__}: {error}", "seconds": time.process_time() - started}
    row["seconds"] = time.process_time() - started
    return row | measured(posture, (hand, posed), np.asarray(contact.displacement_mm)) | claimed(contact)


def measured(posture, skin, displacement):
    """Numbers of the written skin, made apart from the library. `skin`: the `HandArrays` and its posed vertices."""
    hand, posed = skin
    moved = np.linalg.norm(displacement, axis=1)
    after = posed + displacement
    left = 0.0
    if posture.product.is_closed and np.isfinite(after).all():
        left = measuring.depths(after[hand.is_skin], posture.vertices, posture.product.triangles).max()
    under, through = 0.0, 0.0
    if posture.product.kind in THIN and moved.max() < 50.0:
        under, through = under_skin(hand, after, posture.vertices, posture.product.triangles)
    return {
        "moved_mm": float(moved.max()),
        "at": int(moved.argmax()),
        "left_mm": float(left),
        "under_mm": under,
        "through_mm": through,
    }


def claimed(contact):
    """What the module says of its own result."""
    return {
        "force_n": float(np.asarray(contact.force_n).sum()),
        "peak_mpa": float(contact.peak_pressure_mpa),
        "touching": int(np.asarray(contact.in_contact).sum()),
        "converged": bool(contact.convergence["has_converged"]),
        "passes": int(contact.convergence["passes"]),
        "claimed_left_mm": float(contact.residual["penetration_mm"]),
        "complementarity": float(contact.residual["complementarity"]),
        "grade": str(getattr(contact, "grade", "")),
        "reason": contact.reason or "",
        "warnings": list(contact.warnings),
    }


def faults(row):
    """What is wrong with a row: empty if it is sound or a refusal."""
    if "hung" in row or "died" in row:
        return ["hung" if "hung" in row else "died"]
    if is_refused(row):
        return []
    wrong = []
    if not row["moved_mm"] <= max(row["travel_mm"], row["overlap_mm"]) + SPARE_MM:
        wrong.append("spike")
    if not row["left_mm"] <= LEFT_MM:
        wrong.append("inside")
    if not row["peak_mpa"] <= PEAK_MPA:
        wrong.append("peak")
    if not row["converged"]:
        wrong.append("not converged")
    if (row["through_mm"] > THROUGH_MM or row["under_mm"] > THROUGH_RIM_MM) and grade_of(row) != "read this":
        wrong.append("through")
    return wrong


def is_refused(row):
    """Whether the module gave no result, or one that it marks as none."""
    return "refused" in row or grade_of(row) == "do not use"


def grade_of(row):
    """The module's own grade in lower case with spaces; empty if it gives none."""
    return row.get("grade", "").rsplit(".", 1)[-1].replace("_", " ").lower()
