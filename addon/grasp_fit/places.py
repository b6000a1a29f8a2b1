"""Where on a product a hand may close: its own frame, and spots with an axis to wrap. Knows nothing of Blender.

Everything is found from the product's own shape, so that it goes along when the product is moved or turned.
"""

from dataclasses import dataclass, replace

import numpy as np

BEST_RADIUS_MM = 17.0
"""Maximal grip over diameter has its top at 17.9 % of hand length (Ergonomics 2012): 34 mm for a hand of 190 mm."""

LEAST_RADIUS_MM, MOST_RADIUS_MM = 3.47, 45.13
"""A bar thinner or thicker than this is no spot of its own; the whole product always is one."""

GRID_POINTS = 40_000
LEAST_STEP_MM = 3.0
"""The product's inside is looked at on a grid of about so many points, at least this far apart."""

REACH_MM = 12.0
"""What lies about a spot says which way the bar runs there, weighed by a bell as wide as the bar and this."""

RIDGES = 300
"""Points in the middle of bars that are judged at most, evenly taken."""

APART_MM = 45.0
SPOTS = 3
"""So many spots are kept besides the whole product, at least so far apart or turned by 50 degrees."""

MARK_MM = 10.0
MARKED = 0.4
MARK_STEP_MM = 2.5
"""The product's origin is a spot where it lies at most so far outside; its cost is less by `MARKED`."""

WORSE = 1.2
"""A spot whose cost is so much above the best one's is left out."""

FINGER_MM = (10.0, 20.0)
"""A finger needs room at these distances from the bar's surface."""


@dataclass(frozen=True)
class Spot:
    """A bar to close the hand around: its `center` (3), mm, unit `axis`, a unit `side` across it, and its radius.

    `cost` says how far it is from a bar that a hand likes: thick as it should be, long enough, free all around.
    """

    center: np.ndarray
    axis: np.ndarray
    side: np.ndarray
    radius_mm: float
    cost: float = 0.0


ROBERTS = np.array([0.7548776662466927, 0.5698402909980532])
"""Steps of a sequence of points that fills a square evenly: 1 / p and 1 / p^2 with p^3 = p + 1 (Roberts 2018)."""

ALIKE = 0.02
"""Moments that differ by less, relative, have no axes of their own: the order of the vertices then decides."""


def own_frame(vertices, triangles):
    """Origin (3) and axes (3, 3; columns, the longest first) of a surface, from its area alone.

    The moments are those of the surface, so they go along when it is moved or turned. Where they do not fix an axis or
    its sense, as on a cylinder, the first vertex that lies off the axis does: the mesh carries it along as well.
    """
    corners = vertices[triangles]
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    areas = areas / max(areas.sum(), 1e-12)
    middle = areas @ corners.mean(axis=1)
    local = corners - middle
    total = local.sum(axis=1)
    second = np.einsum("t,tki,tkj->ij", areas, local, local) + np.einsum("t,ti,tj->ij", areas, total, total)
    sizes, axes = np.linalg.eigh(second)
    sizes, axes = sizes[::-1], axes[:, ::-1].copy()
    marks = vertices - middle
    is_ball = sizes[2] > (1.0 - 2.0 * ALIKE) * sizes[0]
    if is_ball or sizes[1] > (1.0 - ALIKE) * sizes[0]:
        kept = np.zeros(3) if is_ball else axes[:, 2]
        axes[:, 0] = _first_off(marks, kept)
        axes[:, 1] = _first_off(marks, axes[:, 0]) if is_ball else np.cross(kept, axes[:, 0])
    elif sizes[2] > (1.0 - ALIKE) * sizes[1]:
        axes[:, 1] = _first_off(marks, axes[:, 0])
    for k in (0, 1):
        third = areas @ (total @ axes[:, k]) ** 3
        if abs(third) < 1e-3 * sizes[k] ** 1.5:
            along = marks @ axes[:, k]
            third = along[np.flatnonzero(np.abs(along) > 0.1 * np.abs(along).max())[0]]
        axes[:, k] *= -1.0 if third < 0.0 else 1.0
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    reach = marks @ axes
    return middle + axes @ (0.5 * (reach.min(axis=0) + reach.max(axis=0))), axes


def _first_off(marks, axis):
    """Unit direction, across the unit `axis` (or zero), to the first of the points that lies well off it."""
    off = marks - np.outer(marks @ axis, axis)
    far = np.linalg.norm(off, axis=1)
    first = np.flatnonzero(far > 0.5 * far.max())[0]
    return off[first] / far[first]


def sampled(vertices, triangles, count):
    """Points (count, 3) spread over a surface by its area, and the unit normal (count, 3) of the triangle of each.

    They go along when the surface is moved: the order of the triangles decides where they lie.
    """
    corners = vertices[triangles]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(crosses, axis=1)
    sums = np.cumsum(areas)
    number = np.arange(count)
    chosen = np.minimum(np.searchsorted(sums, (number + 0.5) / count * sums[-1]), len(areas) - 1)
    u, v = (number[:, None] * ROBERTS % 1.0).T
    u, v = np.where(u + v > 1.0, 1.0 - u, u)[:, None], np.where(u + v > 1.0, 1.0 - v, v)[:, None]
    a, b, c = (corners[chosen, k] for k in range(3))
    return a + u * (b - a) + v * (c - a), crosses[chosen] / np.maximum(areas[chosen, None], 1e-12)


def spots(product, vertices, triangles, mark=None):
    """Spots of a product (gap_mm), best first; the whole product, wrapped about its longest axis, is the last of all.

    `vertices` (k, 3) mm, `triangles` (m, 3). `mark` (3): where the product's origin lies; if that is in or near its
    surface, it is a spot, and one that goes before others as good.
    """
    origin, axes = own_frame(vertices, triangles)
    reach = np.abs((vertices - origin) @ axes).max(axis=0)
    whole = Spot(origin, axes[:, 0], axes[:, 2], float(0.5 * (reach[1] + reach[2])))
    step = max(LEAST_STEP_MM, float(np.prod(2.0 * reach + 2.0 * LEAST_STEP_MM) / GRID_POINTS) ** (1.0 / 3.0))
    counts = np.ceil((reach + step) / step).astype(int)
    grids = [step * np.arange(-count, count + 1) for count in counts]
    places = np.stack(np.meshgrid(*grids, indexing="ij"), axis=-1)
    gap = _gaps(product, origin + places.reshape(-1, 3) @ axes.T).reshape(places.shape[:3])
    full = _enclosed(np.abs(gap), step)
    depth = np.where(full, np.abs(gap), -gap)
    share = np.clip(depth / step + 0.5, 0.0, 1.0)
    inside, share = places[share > 0.0], share[share > 0.0]
    found = []
    for place, radius in _ridges(places, depth):
        local = inside - place
        weights = share * np.exp(-0.5 * (local**2).sum(axis=1) / (REACH_MM + radius) ** 2)
        axis, side = _bar_axes((weights[:, None] * local).T @ local)
        found.append(Spot(origin + axes @ place, axes @ axis, axes @ side, float(radius)))
    marked = [_marked(product, np.asarray(mark, float), radius)] if (radius := _near(product, mark)) is not None else []
    found += [*marked, whole]

    def read(points):
        cells = np.rint((points - origin) @ axes / step).astype(int) + counts
        is_in = ((cells >= 0) & (cells < 2 * counts + 1)).all(axis=1)
        hollow = np.zeros(len(points), bool)
        hollow[is_in] = full[tuple(cells[is_in].T)]
        return np.where(hollow, -1.0, _gaps(product, points))

    costs = _costs(read, found)
    found = [replace(spot, cost=float(cost)) for spot, cost in zip(found, costs, strict=True)]
    kept = []
    for k in np.argsort(costs[: len(found) - 1].round(2), kind="stable"):
        if len(kept) < SPOTS and all(_differ(found[k], spot) for spot in kept):
            kept.append(found[k])
    if marked:
        first = replace(found[-2], cost=found[-2].cost - MARKED)
        kept = [first, *(spot for spot in kept if spot is not found[-2] and _differ(first, spot))]
    best = min(spot.cost for spot in (*kept, found[-1]))
    return [spot for spot in (*kept, found[-1]) if spot.cost <= best + WORSE]


def _near(product, mark):
    """Half the thickness of a bar about the mark, mm; None where it lies off the product."""
    if mark is None:
        return None
    gap = float(_gaps(product, np.asarray(mark, float)[None])[0])
    return np.clip(-gap, LEAST_RADIUS_MM, MOST_RADIUS_MM) if -MOST_RADIUS_MM < gap < MARK_MM else None


def _marked(product, mark, radius):
    """The spot at the product's origin; its bar runs as what lies around it is spread."""
    steps = MARK_STEP_MM * np.arange(-12, 13)
    local = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    share = np.clip(1.0 - _gaps(product, mark + local) / MARK_STEP_MM, 0.0, 1.0)
    weights = share * np.exp(-0.5 * (local**2).sum(axis=1) / (REACH_MM + radius) ** 2)
    axis, side = _bar_axes((weights[:, None] * local).T @ local)
    return Spot(mark, axis, side, float(radius))


def _bar_axes(spread):
    """Axis (3) along which a second moment (3, 3) is largest, and a side (3) across it. Where several directions are
    about as good, that one which is nearest to an axis of the frame: noise must not choose."""
    sizes, axes = np.linalg.eigh(spread)
    as_good = axes[:, sizes > 0.95 * sizes[2]]
    near = np.linalg.norm(as_good, axis=1).round(3).argmax()
    axis = as_good @ as_good[near]
    axis = axis / np.linalg.norm(axis)
    axis = axis * (1.0 if axis[np.abs(axis).round(3).argmax()] > 0.0 else -1.0)
    side = np.eye(3)[np.abs(axis).round(3).argmin()]
    side = side - axis * (axis @ side)
    return axis, side / np.linalg.norm(side)


def _enclosed(distance, step):
    """Grid points (bool) that cannot be reached from the grid's border without passing the surface: a hollow counts as
    full, for fingers close around it all the same."""
    is_open = distance > 0.6 * step
    reached = np.ones_like(is_open)
    reached[1:-1, 1:-1, 1:-1] = False
    reached &= is_open
    while True:
        grown = reached.copy()
        for axis in range(3):
            ahead, back = [slice(None)] * 3, [slice(None)] * 3
            ahead[axis], back[axis] = slice(1, None), slice(None, -1)
            grown[tuple(ahead)] |= reached[tuple(back)]
            grown[tuple(back)] |= reached[tuple(ahead)]
        grown &= is_open
        if np.array_equal(grown, reached):
            return is_open & ~reached
        reached = grown


def _gaps(product, points):
    return np.concatenate(
        [product.gap_mm(part)["gap_mm"] for part in np.array_split(points, len(points) // 20_000 + 1)]
    )


def _ridges(places, depth):
    """Points in the middle of bars, with the bar's radius there: about as deep as the deepest next to them."""
    padded = np.pad(depth, 1, constant_values=-np.inf)
    around = np.max(
        [
            padded[i : i + depth.shape[0], j : j + depth.shape[1], k : k + depth.shape[2]]
            for i in range(3)
            for j in range(3)
            for k in range(3)
        ],
        axis=0,
    )
    is_ridge = (depth > LEAST_RADIUS_MM) & (depth < MOST_RADIUS_MM) & (depth >= 0.847 * around)
    chosen = np.flatnonzero(is_ridge.ravel())
    chosen = chosen[:: len(chosen) // RIDGES + 1]
    return zip(places.reshape(-1, 3)[chosen], depth.ravel()[chosen], strict=True)


def _costs(read, found):
    """`Spot.cost` of each spot."""
    along = np.linspace(-48.0, 48.0, 7)
    turns = np.linspace(0.0, 2.0 * np.pi, 9)[:-1]
    centers = np.array([spot.center for spot in found])
    axes = np.array([spot.axis for spot in found])
    sides = np.array([spot.side for spot in found])
    thirds = np.cross(axes, sides)
    radii = np.array([spot.radius_mm for spot in found])
    line = centers[:, None] + along[None, :, None] * axes[:, None]
    support = (read(line.reshape(-1, 3)).reshape(len(found), -1) < 4.0).mean(axis=1)
    out = np.cos(turns)[None, :, None] * sides[:, None] + np.sin(turns)[None, :, None] * thirds[:, None]
    room = []
    for far in FINGER_MM:
        ring = line[:, :, None] + (radii[:, None, None, None] + far) * out[:, None]
        room.append((read(ring.reshape(-1, 3)).reshape(len(found), -1) > 3.0).mean(axis=1))
    return np.abs(np.log(radii / BEST_RADIUS_MM)) + 3.0 * (1.0 - support) + 4.0 * (1.0 - np.min(room, axis=0))


def _differ(one, other):
    apart = np.linalg.norm(one.center - other.center) > APART_MM
    return apart or abs(one.axis @ other.axis) < np.cos(np.radians(50.0))
