"""One level of Catmull-Clark subdivision as a linear map of vertices, as Blender computes it. Knows nothing of Blender.

Catmull & Clark 1978, limit positions by Halstead, Kass & DeRose 1993. For closed and open meshes without creases.
"""

from dataclasses import dataclass

import numpy as np

from ..scene.units import Bools, Floats, Ints


@dataclass(frozen=True)
class Faces:
    """The faces of a mesh of `count` vertices, one after the other, as corners.

    `corners` (l,): vertex of each corner; `sides` (l,): edge from it to the next corner of its face; `starts` (f,):
    first corner of each face; `edges` (m, 2): vertices of each edge.
    """

    count: int
    corners: Ints
    sides: Ints
    starts: Ints
    edges: Ints


@dataclass(frozen=True)
class Rules:
    """How Blender subdivides.

    `is_limit`: vertices go on to where infinitely many levels bring them; `keeps_corners`: those with one face stay.
    """

    is_limit: bool = True
    keeps_corners: bool = False


@dataclass(frozen=True)
class Rim:
    """Edges of one face (r,), the vertices on them (s,) with two such `arms` (s, 2) each, and vertices kept `sharp`."""

    edges: Ints
    vertices: Ints
    arms: Ints
    sharp: Ints


@dataclass(frozen=True)
class Level:
    """The map from vertices (n) to those of the subdivided mesh (n + m + f): its own, its edges', its faces'.

    Made by `level`. `face_of`, `before`, `after`, `place` (l,): of each corner its face, the corners before and after
    it, and its number in the face; `sizes` (f,): corners of each face; `valence` (n,): faces at each vertex.
    """

    faces: Faces
    face_of: Ints
    before: Ints
    after: Ints
    place: Ints
    sizes: Ints
    valence: Floats
    rim: Rim
    is_limit: bool

    def points(self, cage: Floats) -> Floats:
        """Positions (n + m + f, 3) of the subdivided mesh, from those (n, 3) of its vertices."""
        own, edges, centers = refined = self._refined(cage)
        if self.is_limit:
            own, edges, centers = self._own_limit(refined), self._edge_limit(refined), self._center_limit(refined)
        return np.concatenate([own, edges, centers])

    def own_points(self, cage: Floats) -> Floats:
        """The first (n, 3) of `points`, with the same bits."""
        refined = self._refined(cage)
        return self._own_limit(refined) if self.is_limit else refined[0]

    def only(self, vertices: Bools) -> Bools:
        """Which vertices (n + m + f,) of the subdivided mesh come of the chosen `vertices` (n,) only."""
        edges = vertices[self.faces.edges].all(axis=1)
        centers = np.logical_and.reduceat(vertices[self.faces.corners], self.faces.starts)
        return np.concatenate([vertices, edges, centers])

    def triangles(self, points: Floats) -> Ints:
        """Triangles (2 l, 3) of the subdivided mesh, along the diagonals that Blender takes at those `points`."""
        faces = self.faces
        center = faces.count + len(faces.edges) + self.face_of
        after, back = faces.count + faces.sides, faces.count + faces.sides[self.before]
        quads = np.stack([faces.corners, after, center, back], axis=1)
        is_turned = (self.sizes[self.face_of] == 4) & (self.place % 2 == 1)
        quads[is_turned] = np.roll(quads[is_turned], 1, axis=1)
        is_folded = _is_folded(points, quads)
        quads[is_folded] = np.roll(quads[is_folded], 1, axis=1)
        split: Ints = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3).astype(np.int32)
        return split

    def _refined(self, cage: Floats) -> tuple[Floats, Floats, Floats]:
        """Positions after one level: of vertices, edges and faces."""
        faces, rim = self.faces, self.rim
        middles = 0.5 * (cage[faces.edges[:, 0]] + cage[faces.edges[:, 1]])
        centers = _sums(self.face_of, cage[faces.corners], len(faces.starts)) / self.sizes[:, None]
        edges = 0.5 * middles + 0.25 * _sums(faces.sides, centers[self.face_of], len(middles))
        edges[rim.edges] = middles[rim.edges]
        own, k = cage.copy(), np.maximum(self.valence, 1.0)[:, None]
        around = self._at_corners(centers) + 2.0 * self._at_ends(middles)
        used = self.valence > 0.0
        own[used] = ((around / k + (k - 3.0) * cage) / k)[used]
        own[rim.vertices] = 0.5 * cage[rim.vertices] + 0.25 * middles[rim.arms].sum(axis=1)
        own[rim.sharp] = cage[rim.sharp]
        return own, edges, centers

    def _own_limit(self, refined: tuple[Floats, Floats, Floats]) -> Floats:
        (own, edges, centers), rim = refined, self.rim
        k = self.valence[:, None]
        limit = (k * own + (4.0 * self._at_ends(edges) + self._at_corners(centers)) / np.maximum(k, 1.0)) / (k + 5.0)
        limit[self.valence == 0.0] = own[self.valence == 0.0]
        limit[rim.vertices] = (4.0 * own[rim.vertices] + edges[rim.arms].sum(axis=1)) / 6.0
        limit[rim.sharp] = own[rim.sharp]
        return limit

    def _edge_limit(self, refined: tuple[Floats, Floats, Floats]) -> Floats:
        (own, edges, centers), faces = refined, self.faces
        sides = faces.sides
        ends = own[faces.edges[:, 0]] + own[faces.edges[:, 1]]
        near = ends + _sums(sides, centers[self.face_of], len(edges))
        far = _sums(sides, edges[sides[self.before]] + edges[sides[self.after]], len(edges))
        limit = (16.0 * edges + 4.0 * near + far) / 36.0
        rim = self.rim.edges
        limit[rim] = (4.0 * edges[rim] + ends[rim]) / 6.0
        return limit

    def _center_limit(self, refined: tuple[Floats, Floats, Floats]) -> Floats:
        own, edges, centers = refined
        k = self.sizes[:, None].astype(np.float64)
        ring = _sums(self.face_of, 4.0 * edges[self.faces.sides] + own[self.faces.corners], len(centers))
        limit: Floats = (k * centers + ring / k) / (k + 5.0)
        return limit

    def _at_corners(self, centers: Floats) -> Floats:
        """Sum over the faces at each vertex."""
        return _sums(self.faces.corners, centers[self.face_of], self.faces.count)

    def _at_ends(self, edges: Floats) -> Floats:
        """Sum over the edges at each vertex."""
        return _sums(self.faces.edges.T.ravel(), np.concatenate([edges, edges]), self.faces.count)


def level(faces: Faces, rules: Rules) -> Level | None:
    """The map of one level, or None for a mesh that is not taken, since Blender treats it by rules of their own.

    Those have an edge of no face or of more than two, turned faces, faces that meet in one vertex only, a vertex inside
    the mesh with two faces, or one on its rim with one face that goes on to the limit (which Blender approximates).
    """
    starts, count = faces.starts, faces.count
    corners = np.arange(len(faces.corners))
    sizes = np.diff(np.append(starts, len(corners)))
    face_of = np.repeat(np.arange(len(starts)), sizes)
    place = corners - starts[face_of]
    before = np.where(place > 0, corners - 1, corners + sizes[face_of] - 1)
    after = np.where(place < sizes[face_of] - 1, corners + 1, starts[face_of])
    across = _across(faces)
    rim = _rim(faces)
    if across is None or rim is None:
        return None
    # Around a vertex: the next face over the side that comes in; from the end of an open fan back to its start.
    turn, first = across[before], np.full(count, -1)
    opens = across < 0
    first[faces.corners[opens]] = corners[opens]
    turn = np.where(turn < 0, first[faces.corners], turn)
    fans = np.bincount(faces.corners[_least_of_cycle(turn) == corners], minlength=count)
    valence = np.bincount(faces.corners, minlength=count)
    is_inside = np.ones(count, bool)
    is_inside[rim.vertices] = False
    if (fans > 1).any() or (is_inside & (valence > 0) & (valence < 3)).any():
        return None
    tips = rim.vertices[valence[rim.vertices] == 1]
    if len(tips) and rules.is_limit and not rules.keeps_corners:
        return None
    sharp = tips if rules.keeps_corners else rim.sharp
    rim = Rim(rim.edges, rim.vertices, rim.arms, sharp)
    return Level(faces, face_of, before, after, place, sizes, valence.astype(np.float64), rim, rules.is_limit)


def _across(faces: Faces) -> Ints | None:
    """The corner (l,) that has the same side from its other end, -1 on the rim; None where that is not one corner."""
    per_side = np.bincount(faces.sides, minlength=len(faces.edges))
    if len(per_side) > len(faces.edges) or (per_side < 1).any() or (per_side > 2).any():
        return None
    is_forward = faces.corners == faces.edges[faces.sides, 0]
    if (np.bincount(faces.sides[is_forward], minlength=len(faces.edges))[per_side == 2] != 1).any():
        return None
    holder = np.full((2, len(faces.edges)), -1)
    holder[is_forward.astype(np.intp), faces.sides] = np.arange(len(faces.sides))
    across: Ints = holder[(~is_forward).astype(np.intp), faces.sides]
    return across


def _rim(faces: Faces) -> Rim | None:
    """The rim, or None where it crosses itself."""
    rim = np.flatnonzero(np.bincount(faces.sides, minlength=len(faces.edges)) == 1)
    ends = faces.edges[rim].ravel()
    degree = np.bincount(ends, minlength=faces.count)
    vertices = np.flatnonzero(degree)
    if (degree[vertices] != 2).any():
        return None
    arms = np.repeat(rim, 2)[np.argsort(ends, kind="stable")].reshape(-1, 2)
    return Rim(rim, vertices, arms, np.zeros(0, np.intp))


def _least_of_cycle(turn: Ints) -> Ints:
    """The smallest index on each index's cycle of the permutation `turn`."""
    least = np.arange(len(turn))
    while True:
        lower = np.minimum(least, least[turn])
        if np.array_equal(lower, least):
            return least
        least, turn = lower, turn[turn]


def _is_folded(points: Floats, quads: Ints) -> Bools:
    """Where the two triangles on the first diagonal face apart, so that Blender takes the other one."""
    a, b, c, d = (points[quads[:, corner]] for corner in range(4))
    along = c - a
    folded: Bools = np.einsum("ij,ij->i", np.cross(b - a, along), np.cross(along, d - a)) < 0.0
    return folded


def _sums(index: Ints, values: Floats, count: int) -> Floats:
    """Sum of `values` (k, 3) by `index` (k,), in order (count, 3)."""
    sums = np.empty((count, values.shape[1]))
    for axis in range(values.shape[1]):
        sums[:, axis] = np.bincount(index, values[:, axis], minlength=count)
    return sums
