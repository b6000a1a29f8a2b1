"""Meshes of the sample products in mm: turned shapes and plates, finely meshed where a hand touches them.

Knows nothing of Blender. Every function returns `(vertices (k, 3), faces)`, closed, normals outward.
"""

import numpy as np

EDGE_MM = 1.8
"""Edge of the product's mesh under the hand: finer than the skin's 2.5 mm, so that its pressure looks smooth."""


def turned(profile, edge_mm=EDGE_MM):
    """A solid of revolution about z from `profile` (p, 2): radius and height, both ends closed by a flat cap.

    The profile is divided so that no edge is longer than `edge_mm`, as is the widest circle.
    """
    profile = divided(np.asarray(profile, float), edge_mm)
    around = int(np.ceil(2.0 * np.pi * profile[:, 0].max() / edge_mm / 2.0)) * 2
    angle = np.linspace(0.0, 2.0 * np.pi, around, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rings = [np.column_stack([radius * ring, np.full(around, height)]) for radius, height in profile]
    rings = _caps_inward(rings[0], edge_mm)[::-1] + rings[1:-1] + _caps_inward(rings[-1], edge_mm)
    vertices = np.concatenate([*rings, [rings[0].mean(axis=0)], [rings[-1].mean(axis=0)]])
    here = np.arange(around)
    following = np.roll(here, -1)
    faces = []
    for level in range(len(rings) - 1):
        low, high = level * around, (level + 1) * around
        faces.append(np.stack([low + here, low + following, high + following, high + here], axis=1))
    quads = np.concatenate(faces).tolist()
    bottom, top = len(vertices) - 2, len(vertices) - 1
    last = (len(rings) - 1) * around
    quads += [[bottom, int(b), int(a)] for a, b in zip(here, following, strict=True)]
    quads += [[top, last + int(a), last + int(b)] for a, b in zip(here, following, strict=True)]
    return vertices, quads


def _caps_inward(ring, edge_mm):
    """The ring and smaller ones towards its middle, steps growing so that a cap costs few faces."""
    center = ring.mean(axis=0)
    radius = np.linalg.norm(ring[0] - center)
    shares, share, step = [1.0], 1.0, edge_mm / radius
    while share - step > 0.12:
        share, step = share - step, step * 1.6
        shares.append(share)
    return [center + share * (ring - center) for share in shares]


def divided(line, edge_mm):
    """A polyline (p, 2) with points added so that no segment is longer than `edge_mm`."""
    out = [line[:1]]
    for start, end in zip(line[:-1], line[1:], strict=True):
        steps = max(1, int(np.ceil(np.linalg.norm(end - start) / edge_mm)))
        out.append(start + (end - start) * (np.arange(1, steps + 1) / steps)[:, None])
    return np.concatenate(out)


def rounded(corners, radius_mm, steps=5):
    """A polyline (p, 2) whose inner corners are arcs-like curves of about `radius_mm`."""
    corners = np.asarray(corners, float)
    out = [corners[0]]
    for before, corner, after in zip(corners[:-2], corners[1:-1], corners[2:], strict=True):
        reach = [min(radius_mm, 0.45 * np.linalg.norm(p - corner)) for p in (before, after)]
        start = corner + reach[0] * (before - corner) / np.linalg.norm(before - corner)
        end = corner + reach[1] * (after - corner) / np.linalg.norm(after - corner)
        for t in np.linspace(0.0, 1.0, steps):
            out.append((1 - t) ** 2 * start + 2 * t * (1 - t) * corner + t**2 * end)
    return np.array([*out, corners[-1]])


def cylinder(diameter_mm, length_mm=200.0):
    """A cylinder with edges rounded by 2 mm, its axis along z, centered."""
    radius, half = 0.5 * diameter_mm, 0.5 * length_mm
    return turned(rounded([(radius - 3.0, -half), (radius, -half), (radius, half), (radius - 3.0, half)], 2.0))


def bottle():
    """A squeeze bottle of 62 mm with a waist of 57 mm and a cap, 220 mm tall, centered."""
    profile = [
        (22, -110), (31, -110), (31, -70), (29.8, -45), (28.5, -20), (28.5, 5), (29.8, 30), (31, 55),
        (30, 72), (22, 83), (15, 87), (14, 91), (17.5, 91.5), (17.5, 108), (15.5, 110), (12, 110),
    ]  # fmt: skip
    return turned(rounded(profile, 6.0, steps=7))


def grip():
    """A handlebar grip of 35 mm at its thickest, 130 mm long, a collar at both ends; its axis along z, centered.

    The usual grip has 32 mm. Around that the palm folds further: 1.06 % of the hand's triangles then cut each other,
    most of them in the fold below the fingers; at 35 mm it is 0.90 %.
    """
    profile = [
        (11.5, -66), (20.5, -66), (20.5, -61), (16.7, -59.5), (16.1, -40), (17.6, -5), (16.7, 35), (15.8, 56),
        (19.4, 58.5), (19.4, 63), (11.5, 64),
    ]  # fmt: skip
    return turned(rounded(profile, 3.0, steps=5))


def bar():
    """The steel bar of 22.2 mm on which the grip sits, running on past the thumb: decoration, coarse."""
    return turned(rounded([(8.5, -66.5), (11.1, -66.5), (11.1, 320.0), (8.0, 320.0)], 1.0), edge_mm=5.0)


def plate(width_mm, depth_mm, thickness_mm, edge_mm=EDGE_MM):
    """A plate, its top at z = 0, meshed evenly on top and coarsely below, edges rounded by 1.5 mm."""
    across = max(4, int(np.ceil(width_mm / edge_mm)))
    along = max(4, int(np.ceil(depth_mm / edge_mm)))
    x = np.linspace(-0.5, 0.5, across + 1)
    y = np.linspace(-0.5, 0.5, along + 1)
    loop = _border(across, along)
    round_mm = min(1.5, 0.4 * thickness_mm)
    flat = np.array([width_mm, depth_mm]) - 2.0 * round_mm
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    top = np.column_stack([grid * flat, np.zeros(len(grid))])
    rims = []
    corner = np.sign(grid[loop]) * (np.abs(grid[loop]) > 0.5 - 1e-9)
    for turn in np.linspace(0.0, np.pi, 9)[1:]:
        out = round_mm * np.sin(turn)
        down = round_mm * (1.0 - np.cos(turn))
        if turn > np.pi / 2:
            down = thickness_mm - round_mm * (1.0 + np.cos(turn))
        rims.append(np.column_stack([grid[loop] * flat + corner * out, np.full(len(loop), -down)]))
    vertices = np.concatenate([top, *rims, [[0.0, 0.0, -thickness_mm]]])
    cell = np.arange(across)[:, None] * (along + 1) + np.arange(along)
    faces = np.stack([cell, cell + along + 1, cell + along + 2, cell + 1], axis=-1).reshape(-1, 4).tolist()
    levels = [np.array(loop)] + [len(top) + k * len(loop) + np.arange(len(loop)) for k in range(len(rims))]
    for high, low in zip(levels[:-1], levels[1:], strict=True):
        faces += np.stack([high, low, np.roll(low, -1), np.roll(high, -1)], axis=1).tolist()
    last = levels[-1]
    faces += [[len(vertices) - 1, int(b), int(a)] for a, b in zip(last, np.roll(last, -1), strict=True)]
    return vertices, faces


def _border(across, along):
    """Grid indices around the border, counter-clockwise seen from above."""

    def at(i, j):
        return i * (along + 1) + j

    return (
        [at(i, 0) for i in range(across)]
        + [at(across, j) for j in range(along)]
        + [at(i, along) for i in range(across, 0, -1)]
        + [at(0, j) for j in range(along, 0, -1)]
    )


def sleeve(scale=1.0):
    """A shirt cuff and the sleeve behind it, around a wrist along -y; lengths for a hand of 190 mm."""
    rows = [
        (-13.0, 32.5, 22.0), (-11.0, 34.5, 24.0), (-12.0, 36.2, 25.8), (-16.0, 37.0, 26.5),
        (-34.0, 37.5, 27.5), (-44.0, 37.8, 28.0), (-46.0, 36.4, 27.0), (-49.0, 38.2, 29.5),
        (-80.0, 41.0, 34.0), (-150.0, 46.0, 41.0), (-330.0, 52.0, 48.0),
    ]  # fmt: skip
    angle = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    rings = []
    for y, half_width, half_depth in [(-40.0, 29.0, 19.0), *rows]:
        fold = 1.0 + 0.012 * np.sin(5.0 * angle + 0.13 * y) * (y < -46.0)
        rings.append(
            np.column_stack(
                [
                    half_width * np.cos(angle) * fold,
                    np.full(64, y),
                    half_depth * np.sin(angle) * fold - 1.0,
                ]
            )
        )
    vertices = scale * np.concatenate(rings)
    here = np.arange(64)
    following = np.roll(here, -1)
    faces = []
    for level in range(len(rings) - 1):
        low, high = 64 * level, 64 * (level + 1)
        faces += np.stack([low + here, low + following, high + following, high + here], axis=1).tolist()
    return vertices, faces
