"""Balls as hands, products finer than their vertices, and exact readings of meshes; shares nothing with the add-on."""

from math import cos, pi, sin

import bpy
import numpy as np
import stage
from mathutils import Euler

RADIUS = 8.0
"""Of the ball, mm; its edges are about 2.4 mm long."""


def ball():
    """A coarse ball, chosen as the scene's hand."""
    hand = stage.pad(radius=RADIUS, fineness=3)
    bpy.context.scene.thenar.hand = hand
    return hand


def points_mm(obj):
    """Positions (n, 3) of the mesh itself, mm."""
    flat = np.empty(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float) / stage.MM


def triangles_of(obj):
    """Triangles (m, 3) that Blender draws of the mesh itself."""
    obj.data.calc_loop_triangles()
    return np.array([tuple(triangle.vertices) for triangle in obj.data.loop_triangles])


def area_and_volume(points, triangles):
    """Of a closed mesh, mm2 and mm3."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum(), np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


def sides_of_edges(obj):
    """How many faces each edge has, by Blender's own polygons: vertex pair -> count."""
    found = {}
    for polygon in obj.data.polygons:
        ring = list(polygon.vertices)
        for pair in zip(ring, ring[1:] + ring[:1], strict=True):
            key = tuple(sorted(pair))
            found[key] = found.get(key, 0) + 1
    return found


def replaced(obj, points, triangles):
    """`obj` with a mesh of these triangles, mm."""
    mesh = bpy.data.meshes.new("Uniform")
    mesh.from_pydata((points * stage.MM).tolist(), [], triangles.tolist())
    mesh.update()
    obj.data = mesh
    return obj


def quartered(points, triangles, times):
    """Every triangle cut into four at the middles of its edges, `times` over."""
    for _ in range(times):
        sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
        edges, index = np.unique(sides, axis=0, return_inverse=True)
        ab, bc, ca = index.reshape(3, -1) + len(points)
        points = np.concatenate([points, points[edges].mean(axis=1)])
        a, b, c = triangles.T
        triangles = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return points, triangles


def gap_place(points, triangles, around=36):
    """Where a straight wire on the ball passes farthest from all vertices: (foot, direction, outward), unit vectors."""
    best = (0.0, None)
    for face in triangles[:20]:
        foot = points[face].mean(axis=0)
        out = foot / np.linalg.norm(foot)
        side = np.cross(out, [0.3, 0.5, 0.81])
        side /= np.linalg.norm(side)
        other = np.cross(out, side)
        for turn in np.linspace(0.0, pi, around, endpoint=False):
            way = cos(turn) * side + sin(turn) * other
            off = points - foot
            near = np.linalg.norm(off, axis=1) < 4.0
            away = np.linalg.norm(off - np.outer(off @ way, way) - np.outer(off @ out, out), axis=1)[near].min()
            if away > best[0]:
                best = (away, (foot, way, out))
    return best[1]


def wire(place, radius, sunk, half=30.0):
    """A closed wire along the skin, its surface `sunk` mm below the foot; chosen as product. Returns (object, axis)."""
    foot, way, out = place
    centre, across = foot + (radius - sunk) * out, np.cross(way, out)
    turns = np.linspace(0.0, 2.0 * pi, 32, endpoint=False)
    ring = radius * (np.outer(np.cos(turns), across) + np.outer(np.sin(turns), out))
    places = np.linspace(-half, half, 61)
    points = np.concatenate([centre + at * way + ring for at in places])
    count, faces = len(turns), []
    for k in range(len(places) - 1):
        for j in range(count):
            i = (j + 1) % count
            faces.append((k * count + j, k * count + i, (k + 1) * count + i, (k + 1) * count + j))
    last = (len(places) - 1) * count
    faces += [tuple(range(count))[::-1], tuple(range(last, last + count))]
    return _product("Wire", points, faces), (centre, way)


def blade(place, thickness, sunk, half=20.0):
    """A card on edge along the skin, its edge `sunk` mm below the foot; a thickness of 0 makes a sheet. The product."""
    foot, way, out = place
    across = np.cross(way, out)
    ways = (-half * way, half * way), (-0.5 * thickness * across, 0.5 * thickness * across), (-sunk * out, 12.0 * out)
    corners = np.array([foot + a + b + c for a in ways[0] for b in ways[1] for c in ways[2]])
    if thickness == 0.0:
        return _product("Sheet", corners[[0, 1, 5, 4]], [(0, 1, 2, 3)])
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    turned = np.linalg.det([way, across, out]) < 0.0
    return _product("Card", corners, [face[::-1] for face in faces] if turned else faces)


def _product(name, points, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata((np.asarray(points) * stage.MM).tolist(), [], faces)
    mesh.update()
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.scene.thenar.product = obj
    bpy.context.view_layer.update()
    return obj


def is_between(result):
    """Whether a result says that the product lies between vertices none of which touch it."""
    kind = result.reason_kind
    return kind == "product_between_vertices" or (kind == "no_contact" and result.passes_between)


def refine(times=1, **options):
    """Press Refine Skin so many times."""
    for _ in range(times):
        assert bpy.ops.thenar.refine_skin(**options) == {"FINISHED"}


def crossed_finger():
    """A hand of 9,600 vertices whose index finger is bent, a wire across the pad of it between vertices."""
    bpy.ops.thenar.make_hand()
    hand = bpy.context.scene.thenar.hand
    rig = hand.parent
    for name in ("index_proximal", "index_middle"):
        rig.pose.bones[name].rotation_euler = Euler((0.4, 0.0, 0.0))
    shown, triangles = stage.evaluated(hand), triangles_of(hand)
    pad = hand.vertex_groups["index_distal_pad"].index
    on_pad = np.array([any(group.group == pad for group in vertex.groups) for vertex in hand.data.vertices])
    rows = np.flatnonzero(on_pad[triangles].all(axis=1))
    middle = shown[on_pad].mean(axis=0)
    corners = shown[triangles[rows]]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    facing = outward.mean(axis=0)
    best = np.argmax((corners.mean(axis=1) - middle) @ facing)
    out, foot = outward[best], corners[best].mean(axis=0)
    side = np.cross(out, [0.0, 0.3, 1.0])
    side /= np.linalg.norm(side)
    turns = [np.cos(turn) * side + np.sin(turn) * np.cross(out, side) for turn in np.linspace(0.0, np.pi, 60)]

    def clear(way):
        off = shown[on_pad] - foot
        return np.linalg.norm(off - np.outer(off @ way, way) + 0.05 * out, axis=1).min()

    way = max(turns, key=clear)
    crossing, (centre, _) = wire((foot, way, out), radius=0.35, sunk=0.25, half=9.0)
    off = shown - centre
    assert np.linalg.norm(off - np.outer(off @ way, way), axis=1).min() > 0.35  # no vertex lies in it
    return hand, crossing
