"""Products drawn at random with the exact distance to each: balls, boxes, rods, sheets, forks, wires, tubes.

Knows nothing of Thenar. Lengths in mm; triangles wound outward where there is an outside.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

KINDS = ("ball", "box", "rod", "plate", "sheet", "fork", "wire", "tube")


@dataclass(frozen=True)
class Made:
    """A product about the origin. `distance` of points (n, 3) is signed, < 0 in the material, exact or below exact."""

    kind: str
    vertices: np.ndarray
    triangles: np.ndarray
    distance: Callable
    is_closed: bool = True
    sizes: dict = field(default_factory=dict)


def kind_of(seed):
    """The kind of product that a seed draws: one after the other."""
    return KINDS[seed % len(KINDS)]


def draw(kind, rng):
    """A product of that kind with sizes of things that hands meet."""
    return DRAWN[kind](rng)


def _ball(rng):
    radius = rng.uniform(3.0, 40.0)
    rings = int(rng.integers(6, 40))
    angles = np.linspace(0.0, np.pi, rings + 1)
    vertices, triangles = revolved(radius * np.sin(angles), -radius * np.cos(angles), 2 * rings)
    return Made("ball", vertices, triangles, lambda p: np.linalg.norm(p, axis=1) - radius, True, {"radius": radius})


def _box(rng):
    half = rng.uniform(4.0, 45.0, 3)
    vertices, triangles = block(-half, half, int(rng.integers(1, 12)))
    return Made("box", vertices, triangles, lambda p: to_block(p, -half, half), True, {"half": half.tolist()})


def _rod(rng):
    radius, half = rng.uniform(2.0, 22.0), rng.uniform(30.0, 90.0)
    rings = int(rng.integers(1, 40))
    heights = np.linspace(-half, half, rings + 1)
    across = np.concatenate([[0.0], np.full(rings + 1, radius), [0.0]])
    vertices, triangles = revolved(across, np.concatenate([[-half], heights, [half]]), int(rng.integers(10, 64)))
    return Made("rod", vertices, triangles, lambda p: _to_ring(p, 0.0, radius, half), True, {"radius": radius})


def _plate(rng):
    half = np.array([rng.uniform(15.0, 60.0), rng.uniform(15.0, 60.0), rng.uniform(0.25, 2.0)])
    vertices, triangles = block(-half, half, int(rng.integers(1, 20)))
    return Made("plate", vertices, triangles, lambda p: to_block(p, -half, half), True, {"thickness": 2.0 * half[2]})


def _sheet(rng):
    half = np.array([rng.uniform(15.0, 60.0), rng.uniform(15.0, 60.0), 0.0])
    steps = int(rng.integers(1, 30))
    vertices, triangles = _lattice(-half, half, steps)
    return Made("sheet", vertices, triangles, lambda p: to_block(p, -half, half), False, {"steps": steps})


def _fork(rng):
    """A comb: a back and three to five tines, one closed body or a part each."""
    tines, thick = int(rng.integers(3, 6)), rng.uniform(1.0, 4.0)
    wide, between, long = rng.uniform(1.5, 5.0), rng.uniform(1.5, 6.0), rng.uniform(25.0, 60.0)
    pitch = wide + between
    low = np.array([[i * pitch, 0.0, 0.0] for i in range(tines)])
    boxes = [(at, at + [wide, long, thick]) for at in low]
    boxes.append((np.array([0.0, -25.0, 0.0]), np.array([(tines - 1) * pitch + wide, 0.0, thick])))
    middle = 0.5 * np.array([(tines - 1) * pitch + wide, long - 25.0, thick])
    boxes = [(a - middle, b - middle) for a, b in boxes]
    if rng.random() < 0.5:
        vertices, triangles = _comb(boxes, thick)
    else:
        meshes = [block(a - [0.0, 3.0 * (k < tines), 0.0], b, 1) for k, (a, b) in enumerate(boxes)]
        vertices, triangles = joined(meshes)

    def distance(points):
        return np.min([to_block(points, a, b) for a, b in boxes], axis=0)

    return Made("fork", vertices, triangles, distance, True, {"thickness": thick, "tine": wide, "between": between})


def _wire(rng):
    """A wire bent once or more: a tube of few sides around a smooth line."""
    radius, turn = rng.uniform(0.4, 1.6), rng.uniform(0.0, np.pi)
    s = np.linspace(-1.0, 1.0, int(rng.integers(8, 48)))
    bent = rng.uniform(20.0, 60.0)
    line = np.stack([bent * np.sin(turn * s) / max(turn, 1e-3), bent * (1.0 - np.cos(turn * s)) / max(turn, 1e-3)], 1)
    line = np.concatenate([line, np.zeros((len(line), 1))], axis=1)
    vertices, triangles = swept(line, np.array([0.0, 0.0, 1.0]), radius, int(rng.integers(6, 14)))

    def distance(points):
        return _to_line(points, line) - radius

    return Made("wire", vertices, triangles, distance, True, {"radius": radius})


def _tube(rng):
    """A pipe with a wall, or a wall without thickness, open at both ends."""
    radius, half, wall = rng.uniform(8.0, 35.0), rng.uniform(20.0, 70.0), rng.uniform(0.5, 4.0)
    segments, rings = int(rng.integers(16, 64)), int(rng.integers(1, 30))
    heights = np.linspace(-half, half, rings + 1)
    if rng.random() < 0.3:
        vertices, triangles = revolved(np.full(rings + 1, radius), heights, segments)
        wall = 0.0
    else:
        across = np.concatenate([np.full(rings + 1, radius), np.full(rings + 1, radius - wall)])
        vertices, triangles = revolved(across, np.concatenate([heights, heights[::-1]]), segments, is_loop=True)

    def distance(points):
        return _to_ring(points, radius - wall, radius, half)

    return Made("tube", vertices, triangles, distance, wall > 0.0, {"radius": radius, "wall": wall})


DRAWN = dict(zip(KINDS, (_ball, _box, _rod, _plate, _sheet, _fork, _wire, _tube), strict=True))


def revolved(across, along, segments, is_loop=False):
    """A profile of radii and heights turned about z, outward if heights grow; radii of 0 close it, or a loop does."""
    count = len(across)
    turn = 2.0 * np.pi * np.arange(segments) / segments
    rings = np.stack([np.outer(across, np.cos(turn)), np.outer(across, np.sin(turn))], axis=-1)
    vertices = np.concatenate([rings, np.broadcast_to(along[:, None, None], (count, segments, 1))], -1).reshape(-1, 3)
    rows = np.arange(count if is_loop else count - 1)[:, None]
    k, after = np.arange(segments), (np.arange(segments) + 1) % segments
    a, b = rows * segments + k, rows * segments + after
    d, c = (rows + 1) % count * segments + k, (rows + 1) % count * segments + after
    triangles = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return without_doubles(vertices, triangles)


def block(low, high, steps):
    """A box of twelve triangles, or each face cut `steps` times along both sides."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    faces = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        i, j = (x.ravel() for x in np.mgrid[0 : steps + 1, 0 : steps + 1] / steps)
        for end, is_high in ((low, False), (high, True)):
            vertices = np.empty((len(i), 3))
            vertices[:, axis] = end[axis]
            vertices[:, u], vertices[:, v] = low[u] + i * (high - low)[u], low[v] + j * (high - low)[v]
            triangles = _lattice_triangles(steps)
            faces.append((vertices, triangles if is_high else triangles[:, ::-1]))
    return without_doubles(*joined(faces))


def swept(line, across, radius, sides):
    """A round section carried along a flat line (k, 3) whose plane has the normal `across`, capped."""
    way = np.gradient(line, axis=0)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    side = np.cross(across, way)
    turn = 2.0 * np.pi * np.arange(sides) / sides
    rings = line[:, None] + radius * (np.cos(turn)[:, None] * side[:, None] + np.sin(turn)[:, None] * across)
    vertices = np.concatenate([rings.reshape(-1, 3), line[[0, -1]]])
    k, after = np.arange(sides), (np.arange(sides) + 1) % sides
    rows = np.arange(len(line) - 1)[:, None] * sides
    a, b, c, d = rows + k, rows + after, rows + sides + after, rows + sides + k
    triangles = [np.stack([a, c, b], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)]
    last = (len(line) - 1) * sides
    first, end = len(vertices) - 2, len(vertices) - 1
    triangles.append(np.stack([np.full(sides, first), k, after], -1))
    triangles.append(np.stack([np.full(sides, end), last + after, last + k], -1))
    return outward(vertices, np.concatenate(triangles))


def joined(meshes):
    """Several meshes as one, none welded to another."""
    first = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    return (
        np.concatenate([vertices for vertices, _ in meshes]),
        np.concatenate([triangles + at for at, (_, triangles) in zip(first, meshes, strict=False)]),
    )


def without_doubles(vertices, triangles):
    """Vertices at one place made one, triangles without area left out."""
    _, first, index = np.unique(np.round(vertices, 9), axis=0, return_index=True, return_inverse=True)
    faces = index.reshape(-1)[triangles]
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return vertices[first], faces[whole].astype(np.int32)


def outward(vertices, triangles):
    """The closed mesh turned so that its volume is positive."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum()
    return vertices, (triangles if volume > 0.0 else triangles[:, ::-1]).astype(np.int32)


def to_block(points, low, high):
    """Signed distance to a box, also one without thickness."""
    q = np.abs(points - 0.5 * (low + high)) - 0.5 * (high - low)
    return np.linalg.norm(np.maximum(q, 0.0), axis=1) + np.minimum(q.max(axis=1), 0.0)


def _to_ring(points, inner, outer, half):
    """Signed distance to a pipe about z between two radii; a rod if the inner one is 0."""
    r, z = np.hypot(points[:, 0], points[:, 1]), np.abs(points[:, 2]) - half
    radial = r - outer if inner == 0.0 else np.abs(r - 0.5 * (inner + outer)) - 0.5 * (outer - inner)
    q = np.stack([radial, z], axis=1)
    return np.linalg.norm(np.maximum(q, 0.0), axis=1) + np.minimum(q.max(axis=1), 0.0)


def _to_line(points, line):
    best = np.full(len(points), np.inf)
    for a, b in zip(line[:-1], line[1:], strict=True):
        t = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(points - a - t[:, None] * (b - a), axis=1))
    return best


def _lattice(low, high, steps):
    i, j = (x.ravel() for x in np.mgrid[0 : steps + 1, 0 : steps + 1] / steps)
    flat = np.stack([low[0] + i * (high - low)[0], low[1] + j * (high - low)[1], np.zeros(len(i))], axis=1)
    return flat, _lattice_triangles(steps)


def _lattice_triangles(steps):
    at = np.arange((steps + 1) ** 2).reshape(steps + 1, steps + 1)
    a, b, c, d = (x.ravel() for x in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    return np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)


def _comb(boxes, thick):
    """The outline of the boxes, side by side and on one back, as one body of that thickness."""
    *tines, back = boxes
    across = np.unique(np.concatenate([[a[0], b[0]] for a, b in tines]))
    cells = {(i, 0) for i in range(len(across) - 1)}
    cells |= {(i, 1) for i in range(0, len(across) - 1, 2)}
    y = [back[0][1], back[1][1], tines[0][1][1]]
    z = (back[0][2], back[0][2] + thick)
    quads = []
    for i, j in cells:
        p = [(across[i], y[j]), (across[i + 1], y[j]), (across[i + 1], y[j + 1]), (across[i], y[j + 1])]
        quads += [[(*q, z[1]) for q in p], [(*q, z[0]) for q in p[::-1]]]
        for k, way in enumerate([(0, -1), (1, 0), (0, 1), (-1, 0)]):
            if (i + way[0], j + way[1]) not in cells:
                a, b = p[k], p[(k + 1) % 4]
                quads.append([(*a, z[0]), (*b, z[0]), (*b, z[1]), (*a, z[1])])
    vertices = np.array(quads).reshape(-1, 3)
    first = 4 * np.arange(len(quads))[:, None]
    return without_doubles(vertices, np.concatenate([first + [0, 1, 2], first + [0, 2, 3]]))
