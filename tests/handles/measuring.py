"""How deep points lie in a mesh, measured apart from the library: ray parity over many directions, exact distances.

Knows nothing of Thenar and of Blender; numpy and scipy alone. Lengths in mm.

Sign: from each point, rays leave in `DIRECTIONS`; a point is inside a connected part if more than half of its rays
cross that part an odd number of times, and inside the mesh if it is inside one of the parts. No normal decides, so a
face turned over, a coarse triangle or a sharp edge changes nothing; a small hole turns the rays through it alone; a
flat sheet without thickness has no inside, since at most half of the rays from any point reach it. Parts that lie in
each other are united.
"""

import numpy as np
from scipy.spatial import cKDTree


def _directions(count):
    """Unit directions (count, 3) spread over the sphere, off every axis and plane that a designer would use."""
    k = np.arange(count) + 0.5
    height, turn = 1.0 - 2.0 * k / count, np.pi * (1.0 + np.sqrt(5.0)) * k + 0.731
    flat = np.sqrt(1.0 - height**2)
    found = np.stack([flat * np.cos(turn), flat * np.sin(turn), height], axis=1)
    tilt, _ = np.linalg.qr(np.array([[0.9, 0.31, -0.17], [-0.22, 1.1, 0.43], [0.37, -0.29, 0.8]]))
    return found @ tilt.T


DIRECTIONS = _directions(13)
PAIRS_AT_ONCE = 2_000_000
NEIGHBORS = 16


def inside(points, vertices, triangles):
    """Whether each point lies in the mesh (n,) bool, by the vote of parities."""
    out = np.zeros(len(points), bool)
    near = _within_box(points, vertices)
    if len(near) == 0:
        return out
    label = parts(vertices, triangles)
    odd = np.zeros((len(near), label.max() + 1), int)
    for direction in DIRECTIONS:
        for rows, faces, _ in crossings(points[near], direction, vertices, triangles):
            keys = rows * odd.shape[1] + label[faces]
            odd_now = np.bincount(keys, minlength=odd.size).reshape(odd.shape) % 2
            odd += odd_now
    out[near] = (2 * odd > len(DIRECTIONS)).any(axis=1)
    return out


def winding(points, vertices, triangles, directions=5):
    """How often the mesh winds around each point (n,) int: the median over rays of crossings out less crossings in.

    For a closed surface that runs through itself, as a folded hand: 1 inside, 2 where it overlaps, 0 outside.
    """
    out = np.zeros(len(points), int)
    near = _within_box(points, vertices)
    counts = np.zeros((directions, len(near)), int)
    for row, direction in zip(counts, DIRECTIONS[:directions], strict=True):
        for rows, _, ways in crossings(points[near], direction, vertices, triangles):
            np.add.at(row, rows, ways)
    out[near] = np.median(counts, axis=0).astype(int)
    return out


def crossings(points, direction, vertices, triangles):
    """The crossings of the rays from `points` along `direction`: one (rows of points, triangles, +1 out or -1 in)."""
    side = np.cross(direction, [0.61, -0.35, 0.71])
    side /= np.linalg.norm(side)
    frame = np.stack([side, np.cross(direction, side), direction], axis=1)
    at, corners = points @ frame, (vertices @ frame)[triangles]
    order = np.argsort(at[:, 0], kind="stable")
    first = np.searchsorted(at[order, 0], corners[:, :, 0].min(axis=1), "left")
    last = np.searchsorted(at[order, 0], corners[:, :, 0].max(axis=1), "right")
    counts = last - first
    found = []
    for chunk in _chunks(counts):
        face = np.repeat(chunk, counts[chunk])
        start = np.repeat(np.cumsum(counts[chunk]) - counts[chunk], counts[chunk])
        row = order[np.repeat(first[chunk], counts[chunk]) + np.arange(len(face)) - start]
        v = at[row, 1]
        is_near = (v >= corners[face, :, 1].min(axis=1)) & (v <= corners[face, :, 1].max(axis=1))
        is_near &= corners[face, :, 2].max(axis=1) > at[row, 2]
        found.append(_struck(at, corners, row[is_near], face[is_near]))
    if found:
        yield tuple(np.concatenate(part) for part in zip(*found, strict=True))


def _struck(at, corners, row, face):
    """Which of the pairs (row, face) are crossings: the point's shadow in the triangle's, and the triangle above it."""
    a, b, c = (corners[face, k] - at[row] for k in range(3))
    areas = [p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] for p, q in ((b, c), (c, a), (a, b))]
    total = areas[0] + areas[1] + areas[2]
    way = np.sign(total)
    is_in = (way != 0) & np.all([way * area > 0.0 for area in areas], axis=0)
    height = sum(area * p[:, 2] for area, p in zip(areas, (a, b, c), strict=True)) * way
    hit = is_in & (height > 0.0)
    return row[hit], face[hit], way[hit].astype(int)


def distances(points, vertices, triangles):
    """Distance of each point to the nearest triangle (n,), and that triangle (n,)."""
    corners = vertices[triangles]
    middle = corners.mean(axis=1)
    radius = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    few = min(NEIGHBORS, len(triangles))
    to_middle, face = cKDTree(middle).query(points, few)
    to_middle, face = to_middle.reshape(len(points), few), face.reshape(len(points), few)
    row = np.repeat(np.arange(len(points)), few)
    exact = np.linalg.norm(points[row] - closest(points[row], corners[face.ravel()]), axis=1).reshape(-1, few)
    pick = exact.argmin(axis=1)
    best, nearest = exact.min(axis=1), face[np.arange(len(points)), pick]
    is_open = (to_middle[:, -1] - radius.max() < best) & (few < len(triangles))
    for some in _pieces(np.flatnonzero(is_open), max(1, PAIRS_AT_ONCE // len(triangles))):
        row, face = np.nonzero(np.sqrt(np.maximum(_squares(points[some], middle), 0.0)) - radius < best[some, None])
        exact = np.linalg.norm(points[some[row]] - closest(points[some[row]], corners[face]), axis=1)
        order = np.lexsort((exact, row))
        one = order[np.unique(row[order], return_index=True)[1]]
        is_better = exact[one] < best[some[row[one]]]
        one = one[is_better]
        best[some[row[one]]], nearest[some[row[one]]] = exact[one], face[one]
    return best, nearest


def closest(points, corners):
    """The nearest point (n, 3) of one triangle each: the foot on its plane where that lies in it, else on an edge."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    size = np.einsum("ij,ij->i", normal, normal)
    off = np.einsum("ij,ij->i", points - a, normal) / np.where(size > 0.0, size, 1.0)
    foot = points - off[:, None] * normal
    is_in = size > 1e-24
    best, out = np.full(len(points), np.inf), a.copy()
    for p, q in ((a, b), (b, c), (c, a)):
        edge = q - p
        is_in &= np.einsum("ij,ij->i", np.cross(edge, foot - p), normal) >= 0.0
        length = np.maximum(np.einsum("ij,ij->i", edge, edge), 1e-300)
        on = p + np.clip(np.einsum("ij,ij->i", points - p, edge) / length, 0.0, 1.0)[:, None] * edge
        away = np.einsum("ij,ij->i", points - on, points - on)
        is_nearer = away < best
        best, out = np.where(is_nearer, away, best), np.where(is_nearer[:, None], on, out)
    return np.where(is_in[:, None], foot, out)


def depths(points, vertices, triangles):
    """How deep each point lies in the mesh (n,), >= 0; 0 outside. To the nearest wall, whichever way it faces."""
    out = np.zeros(len(points))
    rows = np.flatnonzero(inside(points, vertices, triangles))
    if len(rows):
        out[rows] = distances(points[rows], vertices, triangles)[0]
    return out


def parts(vertices, triangles):
    """The connected part of each triangle (m,), vertices at one place (to 1e-6 mm) taken as one."""
    _, welded = np.unique(np.round(vertices * 1e6).astype(np.int64), axis=0, return_inverse=True)
    faces = welded.reshape(-1)[triangles]
    label = np.arange(faces.max() + 1)
    while True:
        lowest = label[faces].min(axis=1)
        after = label.copy()
        for k in range(3):
            np.minimum.at(after, faces[:, k], lowest)
        after = after[after]
        if np.array_equal(after, label):
            break
        label = after
    return np.unique(label[faces[:, 0]], return_inverse=True)[1].reshape(-1)


def sampled(vertices, triangles, spacing_mm, box):
    """Points on the surface within `box` (low, high), at most `spacing_mm` apart: a lattice in each triangle."""
    corners = vertices[triangles]
    corners = corners[((corners.max(axis=1) > box[0]) & (corners.min(axis=1) < box[1])).all(axis=1)]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    steps = np.maximum(1, np.ceil(longest / spacing_mm).astype(int))
    found = [np.empty((0, 3))]
    for count in np.unique(steps):
        i, j = np.mgrid[0 : count + 1, 0 : count + 1]
        keep = i + j <= count
        weights = np.stack([i[keep], j[keep], count - i[keep] - j[keep]], axis=1) / count
        found.append(np.einsum("wk,mkx->mwx", weights, corners[steps == count]).reshape(-1, 3))
    points = np.concatenate(found)
    points = points[((points >= box[0]) & (points <= box[1])).all(axis=1)]
    cells = np.round(points * (2.0 / spacing_mm)).astype(np.int64)
    return points[np.unique(cells, axis=0, return_index=True)[1]]


def rims(vertices, triangles):
    """Ends (k, 2) of the edges that bound the surface or are sharper than about 66 degrees."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges, index, uses = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    total = np.zeros((len(edges), 3))
    np.add.at(total, index.reshape(-1), np.tile(normals, (3, 1)))
    cosine = 0.5 * np.einsum("ij,ij->i", total, total) - 1.0
    return edges[(uses != 2) | (cosine < 0.4)]


def sunk(samples, hand, triangles, is_skin, within_mm=12.0):
    """How deep points of a product lie under the skin of a closed hand (n,), >= 0; 0 where the nearest is no skin.

    `hand` (n, 3), `triangles`, `is_skin` (n,) bool. Points farther than `within_mm` from every vertex are left out.
    """
    out = np.zeros(len(samples))
    near = np.flatnonzero(np.isfinite(cKDTree(hand).query(samples, distance_upper_bound=within_mm)[0]))
    if len(near) == 0:
        return out
    rows = near[winding(samples[near], hand, triangles, 3) > 0]
    if len(rows) == 0:
        return out
    away, face = distances(samples[rows], hand, triangles)
    out[rows] = np.where(is_skin[triangles[face]].all(axis=1), away, 0.0)
    return out


def _within_box(points, vertices):
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))


def _squares(p, q):
    return (p**2).sum(axis=1)[:, None] + (q**2).sum(axis=1) - 2.0 * p @ q.T


def _chunks(counts):
    """Rows in runs whose counts sum to about `PAIRS_AT_ONCE`."""
    rows = np.flatnonzero(counts)
    if len(rows) == 0:
        return []
    return np.split(rows, np.flatnonzero(np.diff(np.cumsum(counts[rows]) // PAIRS_AT_ONCE)) + 1)


def _pieces(rows, size):
    return [rows[start : start + size] for start in range(0, len(rows), size)]
