"""How the hand looks: what its vertices know of creases, nails and color, and the skin material that draws it.

Creases are drawn, not modelled: at 2.5 mm spacing they would turn into ripples. Each vertex carries its place
on the finger and its signed distance to the lines of the palm, both smooth, so a crease can be finer than a triangle.
"""

import numpy as np

from ..hand import model
from .normals import vertex_normals

REST = "skin_rest_mm"
"""Rest position, mm: textures stick to the skin in every pose."""
TONE = "skin_tone"
"""(palmar side, blush, nail), each 0 to 1."""
FINGER = "skin_finger"
"""(place along the finger: 1, 2, 3 at the base, PIP and DIP crease; share of the palmar side; of the back)."""
LINES = "skin_lines_mm"
"""Signed distance to the thenar, proximal and distal crease of the palm, mm."""
LINES_FADE = "skin_lines_fade"
"""How visible each of the three lines is at the vertex, 0 to 1."""

NAIL = "skin_nail"
"""Place on the digit's nail: across and along from its middle, in half widths and half lengths, and height towards the
palm; linear over the skin, so the shader draws the outline finer than a triangle. `NO_NAIL` elsewhere."""
NO_NAIL = 9.0
NAIL_LENGTH = 1.12
"""Length of a nail over its width (rust/hand, nail)."""
NAIL_CORNER = 0.45
"""Radius of its corners over its half width (the same)."""

REFERENCE_MM = (190.0, 85.0)
PALM_LINES = (
    ((36, 79), (27, 76), (14, 60), (8, 42), (6, 22), (9, 6)),
    ((40, 79), (26, 77), (8, 68), (-14, 56), (-27, 47)),
    ((-47, 61), (-34, 64), (-16, 70), (2, 79), (10, 86)),
)
"""Thenar, proximal and distal crease in the palm plane of a hand of 190 by 85 mm."""
FAR_MM = 20.0
"""This far from the lines of the palm, skin knows nothing of them."""
BASE_CREASE_MM = {"index": 18.0, "middle": 19.0, "ring": 18.0, "little": 14.5, "thumb": 1.0}
PIP_CREASE_MM, DIP_CREASE_MM = -2.5, -7.5


def mark_skin(mesh, made):
    """Write the attributes that the skin material reads to `mesh`; those of an earlier shape are overwritten."""
    rig = model.rig_of(made)
    joints = model.joints_of(made, rig)
    neighbors = _edges(made)
    palmar = _palmar_share(rig, joints, made)
    for _ in range(2):
        palmar = _smooth(palmar, neighbors)
    place, on_finger = _finger_places(rig, joints, made)
    distance, fade = _palm_lines(made, palmar)
    nail = np.asarray(made.get("nails", np.zeros(len(palmar))), float)
    _write(mesh, REST, rig.vertices)
    _write(mesh, TONE, np.stack([palmar, _blush(made, rig, joints, neighbors), nail], axis=1))
    _write(mesh, FINGER, np.stack([place, palmar * on_finger, (1.0 - palmar) * on_finger], axis=1))
    _write(mesh, NAIL, _nail_places(rig, joints, nail > 0.5))
    _write(mesh, LINES, distance)
    _write(mesh, LINES_FADE, fade)


def _write(mesh, name, vectors):
    attribute = mesh.attributes.get(name) or mesh.attributes.new(name, "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", np.ascontiguousarray(vectors, np.float32).ravel())


def _edges(made):
    triangles = np.asarray(made["triangles"])
    pairs = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    count = int(triangles.max()) + 1
    numbers = np.unique(pairs.min(axis=1) * count + pairs.max(axis=1))
    return np.stack([numbers // count, numbers % count], axis=1)


def _smooth(values, edges, passes=1):
    degree = np.maximum(np.bincount(edges.ravel(), minlength=len(values)), 1)
    for _ in range(passes):
        total = np.bincount(edges[:, 0], values[edges[:, 1]], len(values))
        total += np.bincount(edges[:, 1], values[edges[:, 0]], len(values))
        values = 0.4 * values + 0.6 * total / degree
    return values


def _palmar_share(rig, joints, made):
    """1 on the palm side, 0 on the back, by the skin's direction against its bone's palm side."""
    normals = vertex_normals(rig.vertices, np.asarray(made["triangles"]))
    facing = rig.weights @ rig.rest[:, :3, 2]
    facing /= np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-9)
    share = np.clip(0.5 + 0.9 * np.einsum("ij,ij->i", normals, facing), 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


def _blush(made, rig, joints, edges):
    """Redness: finger pads, the two mounds of the palm, and the knuckles on the back."""
    regions = np.asarray(made["regions"])
    value = np.zeros(len(regions))
    for region, name in enumerate(made["region_names"]):
        strength = 1.0 if "distal_pad" in name else 0.55 if name in ("thenar", "hypothenar") else 0.25
        value[regions == region] = strength if "hollow" not in name else 0.1
    for role, bone in joints.bones.items():
        if role.endswith(("proximal", "middle", "distal")):
            away = np.linalg.norm(rig.vertices - rig.rest[bone, :3, 3], axis=1)
            value = np.maximum(value, 0.6 * np.exp(-((away / 13.0) ** 2)) * (regions < 0))
    return _smooth(value, edges, 5)


def _finger_places(rig, joints, made):
    """Place along the digit (n,) as in `FINGER`, and how much a vertex belongs to a digit's phalanges (n,)."""
    place = np.zeros(len(rig.vertices))
    on_finger = np.zeros(len(rig.vertices))
    tails = model.tails_of(made)
    owner = rig.weights.argmax(axis=1)
    for digit, base in BASE_CREASE_MM.items():
        segments = ("proximal", "middle", "distal") if digit != "thumb" else ("proximal", "distal")
        chain = [joints.bones[f"{digit}_{segment}"] for segment in segments]
        lengths = np.array([np.linalg.norm(tails[bone] - rig.rest[bone, :3, 3]) for bone in chain])
        starts = np.concatenate([[0.0], np.cumsum(lengths)])
        marks = (
            [base, starts[1] + PIP_CREASE_MM]
            if digit == "thumb"
            else [base, starts[1] + PIP_CREASE_MM, starts[2] + DIP_CREASE_MM]
        )
        marks = [marks[0] - 30.0, *marks, starts[-1] + 12.0]
        rows = np.isin(owner, chain) | (rig.weights[:, chain].sum(axis=1) > 0.3)
        along = np.zeros(int(rows.sum()))
        for bone, start in zip(chain, starts, strict=False):
            local = (rig.vertices[rows] - rig.rest[bone, :3, 3]) @ rig.rest[bone, :3, 1]
            share = rig.weights[rows, bone] / np.maximum(rig.weights[rows][:, chain].sum(axis=1), 1e-9)
            along += share * (start + local)
        place[rows] = np.interp(along, marks, np.arange(len(marks)))
        on_finger = np.maximum(on_finger, np.clip(2.0 * rig.weights[:, chain].sum(axis=1) - 0.6, 0.0, 1.0))
    return place, on_finger


def _nail_places(rig, joints, on_nail):
    """Places (n, 3) as in `NAIL`; `on_nail` (n,): which vertices lie on a nail."""
    places = np.full((len(rig.vertices), 3), NO_NAIL)
    for role, bone in joints.bones.items():
        own = rig.weights[:, bone] > 0.3
        if not role.endswith("_distal") or not (own & on_nail).any():
            continue
        local = (rig.vertices[own] - rig.rest[bone, :3, 3]) @ rig.rest[bone, :3, :3]
        half, middle = _nail_size(local, on_nail[own])
        places[own] = (local - [0.0, middle, 0.0]) / [half, NAIL_LENGTH * half, half]
    return places


def _nail_size(local, on_nail):
    """Half width and middle, mm, of the outline that parts the vertices on a nail from the others best."""
    back = local[:, 2] < 0.0
    across, along, inside = np.abs(local[back, 0]), local[back, 1], on_nail[back]
    half, middle = across[inside].max(), 0.5 * (along[inside].min() + along[inside].max())
    for step in (0.8, 0.4, 0.2, 0.1, 0.05):
        tries = [(half + i * step, middle + j * step) for i in range(-2, 3) for j in range(-2, 3)]
        half, middle = min(tries, key=lambda size: _missed((across, along), inside, size))
    return half, middle


def _missed(points, inside, size):
    """How far, mm in all, vertices lie on the wrong side of a nail's outline."""
    half, middle = size
    outline = half * nail_outline(points[0] / half, np.abs(points[1] - middle) / half)
    return np.maximum(np.where(inside, outline, -outline), 0.0).sum()


def nail_outline(across, along):
    """Signed distance to a nail's outline in half widths, negative on it, at distances from its middle (>= 0)."""
    x, y = across - 1.0 + NAIL_CORNER, along - NAIL_LENGTH + NAIL_CORNER
    return np.hypot(np.maximum(x, 0.0), np.maximum(y, 0.0)) + np.minimum(np.maximum(x, y), 0.0) - NAIL_CORNER


def _palm_lines(made, palmar):
    """Signed distances (n, 3) to the lines of the palm, mm, and their visibility (n, 3)."""
    positions = np.asarray(made["vertices_mm"], float)
    heads = {bone["name"]: np.asarray(bone["head_mm"], float) for bone in made["bones"]}
    knuckles = heads["index_proximal"][0] - heads["little_proximal"][0]
    across = knuckles / (0.653 * REFERENCE_MM[1])
    lengthwise = heads["middle_proximal"][1] / (0.446 * REFERENCE_MM[0])
    flat = positions[:, :2] / [across, lengthwise]
    distances, fades = [], []
    palm = (palmar > 0.0) & (flat[:, 1] > -FAR_MM) & (flat[:, 1] < REFERENCE_MM[1] + FAR_MM)
    for line in PALM_LINES:
        distance, part = np.full(len(flat), FAR_MM), np.zeros(len(flat))
        distance[palm], part[palm] = _to_polyline(flat[palm], _rounded(np.array(line, float)))
        distances.append(distance)
        ends = np.clip(np.minimum(part + 0.02, 1.02 - part) / 0.12, 0.0, 1.0)
        fades.append(ends * palmar * (np.abs(distance) < 12.0))
    return np.stack(distances, axis=1), np.stack(fades, axis=1)


def _rounded(points, steps=12):
    """Catmull-Rom curve through `points`."""
    padded = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
    out = []
    for k in range(len(points) - 1):
        a, b, c, d = padded[k : k + 4]
        for t in np.linspace(0.0, 1.0, steps, endpoint=False):
            bend = (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3
            out.append(0.5 * (2 * b + (c - a) * t + bend))
    return np.array([*out, points[-1]])


def _to_polyline(points, line):
    """Signed distance of `points` (n, 2) to a polyline, and how far along it the nearest point lies, 0 to 1."""
    best = np.full(len(points), np.inf)
    signed, part = np.zeros(len(points)), np.zeros(len(points))
    for k, (start, end) in enumerate(zip(line[:-1], line[1:], strict=True)):
        along = end - start
        raw = (points - start) @ along / (along @ along)
        t = np.clip(raw, -1.0 if k == 0 else 0.0, 2.0 if k == len(line) - 2 else 1.0)
        off = points - start - t[:, None] * along
        length = np.linalg.norm(off, axis=1)
        nearer = length < best
        best[nearer] = length[nearer]
        sign = np.sign(along[0] * off[:, 1] - along[1] * off[:, 0])
        signed[nearer] = (sign * length)[nearer]
        part[nearer] = ((k + t) / (len(line) - 1))[nearer]
    return signed, part
