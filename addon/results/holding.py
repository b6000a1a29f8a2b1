"""How well a contact holds the product in every direction: force closure with friction, smallest wrench resisted.

Knows nothing of Blender. Ferrari and Canny 1992: the wrenches that contacts can apply while their normal forces sum to
one; the measure is the radius of the largest ball about zero among them. Coulomb's cones are exact, not pyramids.
"""

from dataclasses import dataclass

import numpy as np

SIZE = 6
TOLERANCE = 0.02
"""The two bounds of the measure lie this share of the upper one apart, or `LEAST` at most."""

LEAST = 1e-3
STEPS = 600
MOST_FACETS = 20_000
"""Points that are added, and facets that are made, at most; the bounds found so far are returned then."""

JOGGLE = 1e-7
"""Supporting points are moved so little, in parts of the largest wrench, so that no facet is degenerate."""

FLAT = 1e-5
"""Wrenches that span less than this in some direction, in parts of the largest one, leave that direction free."""


@dataclass(frozen=True)
class Contacts:
    """Where a product is touched: `points` (k, 3), mm, and `inward` (k, 3), unit normals into the product; `friction`,
    Coulomb's coefficient; `about_mm` (3), about which moments are taken; `arm_mm`, by which they are divided."""

    points: np.ndarray
    inward: np.ndarray
    friction: float
    about_mm: np.ndarray
    arm_mm: float


LEAST_SHARE = 1e-4
"""Vertices that carry less of the sum of forces are left out."""


@dataclass(frozen=True)
class Quality:
    """Bounds of Ferrari and Canny's measure, in parts of the sum of normal forces: a wrench of `least` times that sum,
    moments divided by the arm, is resisted in every direction. `worst` (6): the direction resisted least, force then
    moment over arm. Without force closure `least` is 0."""

    least: float
    most: float
    worst: np.ndarray

    @property
    def is_closed(self):
        """Whether every small wrench is resisted: force closure."""
        return self.least > 0.0


@dataclass(frozen=True)
class Holding:
    """A `Quality` with what it is of: the coefficient of `friction`, the sum of normal forces, N, the arm, mm."""

    quality: Quality
    friction: float
    sum_n: float
    arm_mm: float


def of_press(posed_mm, contact, friction, cancel=None, _progress=None):
    """The `Holding` of a native contact of the posed hand (n, 3), or None where nothing presses."""
    force = np.asarray(contact.force_n)
    used = np.flatnonzero(force > 0.0)
    push = -np.nan_to_num(np.asarray(contact.product_normal)[used]) * force[used, None]
    return of_skin(posed_mm[used] + np.asarray(contact.displacement_mm)[used], push, friction, cancel)


def of_skin(points, push, friction, cancel=None):
    """The `Holding` of pressed skin, or None where nothing presses.

    `points` (k, 3) mm, `push` (k, 3) normal forces on the product there, N. Moments are about the middle of the
    forces, in parts of the greatest distance of a contact from it, so that the product's mass does not count.
    """
    size = np.linalg.norm(push, axis=1)
    used = size > LEAST_SHARE * size.sum()
    points, push, size = points[used], push[used], size[used]
    if len(size) == 0:
        return None
    about = size @ points / size.sum()
    arm = max(float(np.linalg.norm(points - about, axis=1).max()), 1e-9)
    contacts = Contacts(points, push / size[:, None], friction, about, arm)
    return Holding(measure(contacts, cancel), friction, float(size.sum()), arm)


def measure(contacts, cancel=None):
    """The `Quality` of contacts.

    A polytope of wrenches grows from the inside: the facet nearest to zero is pushed out to the farthest wrench there
    is in its direction, until there is none beyond (Zheng 2013). Its nearest facet is a lower bound, the farthest
    wrench in any direction asked an upper one.
    """
    wrenches = _Wrenches(contacts)
    corners = _simplex(wrenches)
    if isinstance(corners, Quality):
        return corners
    hull = _Hull(corners)
    most, worst = np.inf, np.zeros(SIZE)
    for _ in range(STEPS):
        if len(hull.offsets) > MOST_FACETS or (cancel is not None and cancel.is_set()):
            break
        nearest = int(hull.offsets.argmin())
        way, least = hull.normals[nearest], float(hull.offsets[nearest])
        point, reach = wrenches.farthest(way)
        if reach < most:
            most, worst = reach, -way
        if most <= LEAST * wrenches.size:
            return Quality(0.0, max(most, 0.0), worst)
        if most - least <= TOLERANCE * most or not hull.add(point):
            break
    return Quality(max(float(hull.offsets.min()), 0.0), most, worst)


class _Wrenches:
    """All wrenches of unit normal force: cones of Coulomb at every contact."""

    def __init__(self, contacts):
        self.normal, self.friction = contacts.inward, contacts.friction
        self.arms = (contacts.points - contacts.about_mm) / contacts.arm_mm
        plain = np.concatenate([self.normal, np.cross(self.arms, self.normal)], axis=1)
        self.size = float(np.linalg.norm(plain, axis=1).max(initial=0.0))
        self.noise = np.random.default_rng(0).normal(0.0, JOGGLE * self.size, (len(plain), SIZE))

    def farthest(self, way):
        """The wrench (6) that lies farthest in a direction (6), and how far."""
        pull = way[:3] + np.cross(way[3:], self.arms)
        along = (pull * self.normal).sum(axis=1)
        aside = pull - along[:, None] * self.normal
        drag = np.linalg.norm(aside, axis=1)
        reach = along + self.friction * drag
        k = int(reach.argmax())
        force = self.normal[k] + self.friction * aside[k] / max(drag[k], 1e-12)
        return np.concatenate([force, np.cross(self.arms[k], force)]) + self.noise[k], float(reach[k])


def _simplex(wrenches):
    """Seven wrenches (7, 6) that span all directions; a `Quality` of 0 where some direction is not resisted."""
    corners = [wrenches.farthest(np.eye(SIZE)[0])[0]]
    while len(corners) <= SIZE:
        edges = np.array(corners[1:]).reshape(-1, SIZE) - corners[0]
        free = np.linalg.svd(edges, full_matrices=True)[2][len(edges) :] if len(edges) else np.eye(SIZE)
        best = None
        for way in np.concatenate([free, -free]):
            point, reach = wrenches.farthest(way)
            if reach <= LEAST * wrenches.size:
                return Quality(0.0, max(reach, 0.0), -way)
            off = float(np.linalg.norm(free @ (point - corners[0])))
            if best is None or off > best[0]:
                best = off, point
        if best[0] <= FLAT * wrenches.size:
            return Quality(0.0, 0.0, free[0])
        corners.append(best[1])
    return np.array(corners)


class _Hull:
    """The convex hull of wrenches: facets by their corners, outward `normals` (m, 6) and `offsets` (m,) from zero."""

    def __init__(self, corners):
        self.points = list(corners)
        self.middle = corners.mean(axis=0)
        self.facets = np.array([np.delete(np.arange(SIZE + 1), k) for k in range(SIZE + 1)])
        self.normals, self.offsets = self._planes(self.facets)

    def add(self, point):
        """Grows by a point; False where it lies beyond no facet."""
        beyond = self.normals @ point - self.offsets > 1e-9
        if not beyond.any():
            return False
        self.points.append(point)
        seen = self.facets[beyond]
        ridges = np.concatenate([np.delete(seen, k, axis=1) for k in range(SIZE)])
        ridges, counts = np.unique(np.sort(ridges, axis=1), axis=0, return_counts=True)
        rim = ridges[counts == 1]
        fresh = np.concatenate([rim, np.full((len(rim), 1), len(self.points) - 1)], axis=1)
        normals, offsets = self._planes(fresh)
        self.facets = np.concatenate([self.facets[~beyond], fresh])
        self.normals = np.concatenate([self.normals[~beyond], normals])
        self.offsets = np.concatenate([self.offsets[~beyond], offsets])
        return True

    def _planes(self, facets):
        """Outward unit normals (m, 6) and offsets (m,) of facets (m, 6), from a point inside."""
        arms = np.array(self.points)[facets] - self.middle
        normals = np.linalg.solve(arms, np.ones((len(facets), SIZE, 1)))[:, :, 0]
        size = np.linalg.norm(normals, axis=1)
        return normals / size[:, None], 1.0 / size + normals @ self.middle / size
