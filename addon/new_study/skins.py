"""The skin of a new study: a piece of the hand around the site, or a flat patch, in mm, with where the fit starts."""

from dataclasses import dataclass

import numpy as np
from mathutils.geometry import delaunay_2d_cdt

from .. import names, native, workflow
from ..hand_look.normals import vertex_normals
from ..scene import mesh, read, regions, units
from ..scene.checks import Refusal

REACH_MM = 30.0
"""Distance from the site up to which skin of the hand is written: contacts are smaller, and a whole hand is slow."""
NORMAL_MM = 4.0
"""Distance around the site over which the skin's direction is averaged."""
FINE, WIDE = 0.2, 3.0
"""Of a flat patch: spacing in its middle as a share of the smallest contact's radius, and its own radius in largest."""
_LEAST_MM, _MOST_MM = 8.0, 60.0
MOST_POINTS = 100_000
"""Of a flat patch: joining 94,000 to triangles took 10 s and 29,000 0.8 s, through which Blender stands still."""
LARGEST_MM = _MOST_MM / 2.0**0.5
"""Largest contact radius of a half-space that stays inside a flat patch also on the thinnest layer, where a ball's
grows from (R d)^(1/2) up to (2 R d)^(1/2)."""
_GROWTH = 0.12
_FIT_STARTS = ("g0_mpa", "g_lim_mpa", "d_lim_mm", "thickness_mm")


@dataclass(frozen=True)
class Skin:
    """Vertices (n, 3), mm; triangles (m, 3); region name of each vertex or None; numbers by region; the site."""

    vertices_mm: np.ndarray
    triangles: np.ndarray
    regions: tuple | None
    materials: dict
    point_mm: np.ndarray
    direction: np.ndarray
    site: str = "site"


def flat(contacts_mm, thickness_mm):
    """A round flat patch, its middle the site, +z out of the skin.

    `contacts_mm`: least and greatest radius of contact, mm, that `fits`; `thickness_mm`: 0 for a half-space.
    """
    points = [np.zeros((1, 2))]
    for r, count in _rings(*contacts_mm):
        angle = 2.0 * np.pi * (np.arange(count) + 0.5 * (len(points) % 2)) / count
        points.append(r * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    points = np.concatenate(points)
    found = delaunay_2d_cdt([tuple(point) for point in points], [], [], 0, 1e-6)
    flat_points, faces = np.array([tuple(point) for point in found[0]]), np.array(found[2], dtype=np.int64)
    a, b, c = (flat_points[faces[:, k]] for k in range(3))
    turned = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    faces[turned] = faces[turned][:, ::-1]
    vertices = np.column_stack([flat_points, np.zeros(len(flat_points))])
    material = native.published("finger_layer")
    numbers = {name: material[name] for name in _FIT_STARTS}
    numbers["thickness_mm"] = thickness_mm if thickness_mm > 0.0 else np.inf
    return Skin(vertices, faces, None, {"default": numbers}, np.zeros(3), np.array([0.0, 0.0, -1.0]), "middle")


def fits(least, most):
    """Whether a flat patch for contacts of these radii, mm, has at most `MOST_POINTS`."""
    points = 1
    for _, count in _rings(least, most):
        points += count
        if points > MOST_POINTS:
            return False
    return True


def _rings(least, most):
    """Radius, mm, and number of points of each ring of a flat patch, from the middle out."""
    radius = float(np.clip(WIDE * most, _LEAST_MM, _MOST_MM))
    step, r = FINE * least, 0.0
    while r < radius:
        grown = step * (1.0 + _GROWTH * max(0.0, r - 1.2 * most) / step)
        r += grown
        yield r, max(6, round(2.0 * np.pi * r / (1.1 * grown)))


def of_hand(context, hand, vertex, region):
    """The hand's skin at rest around a vertex, or where that is -1 around the middle of a region. Raises `Refusal`."""
    positions = read.rest_mm(context, hand)
    triangles = mesh.triangles(hand.data)
    if units.is_mirrored(units.world_from_local(hand)):
        triangles = triangles[:, ::-1]
    normals = vertex_normals(positions, triangles)
    listed = tuple(material.name for material in hand.thenar.materials)
    sorted_in = regions.vertex_regions(context, hand, listed)
    if vertex < 0:
        vertex = _middle(positions, normals, np.flatnonzero(sorted_in == listed.index(region)), region)
    _check_is_skin(hand, listed, sorted_in[vertex])
    kept = _piece(positions, triangles, vertex)
    near = np.linalg.norm(positions - positions[vertex], axis=1) <= NORMAL_MM
    outward = normals[near & kept].sum(axis=0)
    outward /= np.linalg.norm(outward)
    whole = kept[triangles].all(axis=1)
    used = np.unique(triangles[whole])
    new = np.full(len(positions), -1)
    new[used] = np.arange(len(used))
    numbers = dict(zip(listed or ("default",), map(dict, workflow.material_numbers(hand)), strict=True))
    of_vertex = tuple(listed[k] if k >= 0 else "" for k in sorted_in[used]) if listed else None
    held = {name: numbers[name] for name in (sorted(set(of_vertex) - {""}) if listed else numbers)}
    materials = {name: {key: each[key] for key in _FIT_STARTS} for name, each in held.items()}
    site = listed[sorted_in[vertex]] if listed else names.WHOLE_SKIN
    return Skin(positions[used], new[triangles[whole]], of_vertex, materials, positions[vertex], -outward, site)


def picked(context, hand, place_world):
    """The hand's vertex nearest to a place (3) on its shown, posed skin, in Blender's units.

    Raises `Refusal` where no region lies there, which the model takes for no skin.
    """
    posed = mesh.evaluated_positions(hand, context.evaluated_depsgraph_get(), len(hand.data.vertices))
    matrix = units.world_from_local(hand)
    world = posed @ matrix[:3, :3].T + matrix[:3, 3]
    vertex = int(np.linalg.norm(world - np.asarray(place_world), axis=1).argmin())
    listed = tuple(material.name for material in hand.thenar.materials)
    _check_is_skin(hand, listed, regions.vertex_regions(context, hand, listed)[vertex])
    return vertex


def _check_is_skin(hand, listed, number):
    if listed and number < 0:
        raise Refusal(
            f"this place of '{hand.name}' belongs to no region, so no tissue is known there; "
            "click a pad or the palm, or add the region under Materials"
        )


def _middle(positions, normals, of_region, region):
    """The vertex of a region in the middle of the side that it faces."""
    if not len(of_region):
        raise Refusal(f"no vertex of the hand belongs to the region '{region}'; click the place with Pick Site")
    facing, center = normals[of_region].sum(axis=0), positions[of_region].mean(axis=0)
    if np.linalg.norm(facing) < 0.2 * len(of_region):
        raise Refusal(f"the region '{region}' goes all around, so it has no middle; click the place with Pick Site")
    facing /= np.linalg.norm(facing)
    away = positions[of_region] - center
    across = np.linalg.norm(away - np.outer(away @ facing, facing), axis=1)
    across[normals[of_region] @ facing <= 0.5] = np.inf
    return int(of_region[across.argmin()])


def _piece(positions, triangles, vertex):
    """Which vertices (n,) lie near the vertex and hang together with it there."""
    near = np.linalg.norm(positions - positions[vertex], axis=1) <= REACH_MM
    inside = triangles[near[triangles].all(axis=1)]
    kept = np.zeros(len(positions), bool)
    kept[vertex] = True
    while True:
        touched = inside[kept[inside].any(axis=1)]
        before = kept.sum()
        kept[touched] = True
        if kept.sum() == before:
            return kept
