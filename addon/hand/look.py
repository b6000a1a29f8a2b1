"""How the hand looks: what its vertices know of creases, nails and color, and the skin material that draws it.

Creases are drawn, not modelled: at 2.5 mm spacing they would turn into ripples. Each vertex carries its place
on the finger and its signed distance to the lines of the palm, both smooth, so a crease can be finer than a triangle.
"""

import numpy as np

from . import model
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

REFERENCE_MM = (190.0, 85.0)
PALM_LINES = (
    ((36, 79), (27, 76), (14, 60), (8, 42), (6, 22), (9, 6)),
    ((40, 79), (26, 77), (8, 68), (-14, 56), (-27, 47)),
    ((-47, 61), (-34, 64), (-16, 70), (2, 79), (10, 86)),
)
"""Thenar, proximal and distal crease in the palm plane of a hand of 190 by 85 mm."""
BASE_CREASE_MM = {"index": 18.0, "middle": 19.0, "ring": 18.0, "little": 14.5, "thumb": 1.0}
PIP_CREASE_MM, DIP_CREASE_MM = -2.5, -7.5


def mark_skin(mesh, made):
    """Write the attributes that the skin material reads to `mesh`."""
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
    _write(mesh, LINES, distance)
    _write(mesh, LINES_FADE, fade)


def _write(mesh, name, vectors):
    attribute = mesh.attributes.new(name, "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", np.ascontiguousarray(vectors, np.float32).ravel())


def _edges(made):
    triangles = np.asarray(made["triangles"])
    pairs = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0)


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


def _palm_lines(made, palmar):
    """Signed distances (n, 3) to the lines of the palm, mm, and their visibility (n, 3)."""
    positions = np.asarray(made["vertices_mm"], float)
    heads = {bone["name"]: np.asarray(bone["head_mm"], float) for bone in made["bones"]}
    knuckles = heads["index_proximal"][0] - heads["little_proximal"][0]
    across = knuckles / (0.653 * REFERENCE_MM[1])
    lengthwise = heads["middle_proximal"][1] / (0.446 * REFERENCE_MM[0])
    flat = positions[:, :2] / [across, lengthwise]
    distances, fades = [], []
    for line in PALM_LINES:
        distance, part = _to_polyline(flat, _rounded(np.array(line, float)))
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
