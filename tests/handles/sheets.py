"""Contact sheets: hands from four sides, a row each, drawn without Blender's renderer, so that any machine can.

    target/venv/bin/python tests/bench/handles.py --percentiles 50 --starts made --dump target/grasps
    target/venv/bin/python tests/handles/sheets.py target/grasps addon/docs/pictures

Columns: the palm, the thumb's side, the back, the little finger's side. Grasps stand in the order of `shapes.SHAPES`,
poses in that of the library.
"""

import json
import os
import sys
from pathlib import Path

import numpy as np

SIDE_PX = 180
HALF_MM = 118.0
"""A tile of so many pixels shows so much to each side of the hand's middle."""

ROWS = 6
SKIN, PRODUCT, GROUND = (228, 178, 152), (112, 146, 190), 246.0
LIGHT = np.array([0.35, 0.5, 0.8]) / np.linalg.norm([0.35, 0.5, 0.8])
DENSITY = 8.0
"""Points on the surface for each pixel that they cover."""

SIDES = {"palm": (0, 0, 1), "thumb": (1, 0, 0), "back": (0, 0, -1), "little": (-1, 0, 0)}
"""From where a row looks, in the axes of the hand at rest: x to the thumb, y along the fingers, z out of the palm."""


def tile(bodies, view, middle):
    """A picture (p, p, 3) of bodies, each (points (n, 3), mm, triangles (m, 3), color); `view` (3, 3): rows right, up
    and toward the eye."""
    image, depth = np.full((SIDE_PX**2, 3), GROUND), np.full(SIDE_PX**2, -np.inf)
    for points, triangles, color in bodies:
        places, normals = _spread((np.asarray(points) - middle) @ view.T, np.asarray(triangles))
        is_seen = (np.abs(places[:, :2]) < HALF_MM).all(axis=1) & (normals[:, 2] > 0.0)
        places, normals = places[is_seen], normals[is_seen]
        order = np.argsort(places[:, 2], kind="stable")
        places, normals = places[order], normals[order]
        column, row = ((places[:, :2] / HALF_MM + 1.0) / 2.0 * SIDE_PX).astype(int).clip(0, SIDE_PX - 1).T
        at = (SIDE_PX - 1 - row) * SIDE_PX + column
        nearest, shade = np.full(SIDE_PX**2, -np.inf), np.zeros(SIDE_PX**2)
        nearest[at], shade[at] = places[:, 2], 0.35 + 0.65 * np.maximum(normals @ LIGHT, 0.0)
        is_front = nearest > depth
        depth[is_front] = nearest[is_front]
        image[is_front] = np.outer(shade[is_front], color)
    return image.reshape(SIDE_PX, SIDE_PX, 3)


def _spread(points, triangles):
    """Points (k, 3) spread over a surface by area, and the normals there (k, 3)."""
    corners = points[triangles]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = 0.5 * np.linalg.norm(crosses, axis=1)
    normals = crosses / np.maximum(2.0 * areas, 1e-12)[:, None]
    pixel_mm = 2.0 * HALF_MM / SIDE_PX
    of = np.repeat(np.arange(len(triangles)), np.maximum((DENSITY * areas / pixel_mm**2).astype(int), 6))
    root, share = np.random.default_rng(0).random((2, len(of), 1))
    root = np.sqrt(root)
    a, b, c = corners[of].transpose(1, 0, 2)
    return (1.0 - root) * a + root * (1.0 - share) * b + root * share * c, normals[of]


def row(rest, posed, triangles, palm, product=None):
    """The four tiles of a hand side by side (p, 4 p, 3). `rest` and `posed` (n, 3) mm; `palm`: rows that do not bend;
    `product`: its vertices and triangles, or None."""
    turn = _turn(rest[palm], posed[palm])
    middle = 0.5 * (posed.min(axis=0) + posed.max(axis=0))
    bodies = [(posed, triangles, SKIN)] + ([] if product is None else [(*product, PRODUCT)])
    tiles = []
    for eye in SIDES.values():
        right = np.cross([0.0, 1.0, 0.0], eye)
        tiles.append(tile(bodies, np.stack([right, np.cross(eye, right), eye]) @ turn.T, middle))
    return np.concatenate(tiles, axis=1)


def _turn(rest, posed):
    """The rotation (3, 3) from `rest` to `posed` (n, 3) that fits best (Kabsch 1976)."""
    left, _, right = np.linalg.svd((posed - posed.mean(axis=0)).T @ (rest - rest.mean(axis=0)))
    return left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right


def grasp_row(path):
    """The row of a grasp that `handles.py --dump` kept, its skin pressed by the product."""
    kept = np.load(path)
    names = json.loads(str(kept["region_names"]))
    palm = np.isin(kept["regions"], [k for k, name in enumerate(names) if name in ("hypothenar", "palm_hollow")])
    product = kept["shown_product"], kept["shown_product_triangles"]
    return row(kept["vertices"], kept["shown"], kept["triangles"], palm, product)


def palm_of(hand):
    """Vertices of a made hand that do not bend."""
    groups = [hand.vertex_groups[name].index for name in ("hypothenar", "palm_hollow")]
    return [vertex.index for vertex in hand.data.vertices if any(each.group in groups for each in vertex.groups)]


def pose_rows():
    """The rows of the pose library, with a median hand."""
    import bpy
    from handles import grasping
    from thenar_blender.hand.poses import POSES

    grasping.register()
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.thenar.make_hand(percentile=50)
    hand = bpy.context.scene.thenar.hand
    rest, triangles = grasping.seen(hand)
    palm = palm_of(hand)
    for pose in POSES:
        bpy.ops.thenar.apply_pose(name=pose)
        yield row(rest, grasping.seen(hand)[0], triangles, palm)


def save(path, rows):
    """Rows below each other as a JPEG."""
    import bpy

    pixels = np.concatenate(list(rows)).clip(0.0, 255.0) / 255.0
    high, wide, _ = pixels.shape
    image = bpy.data.images.new(path.stem, wide, high)
    image.pixels.foreach_set(np.dstack([pixels[::-1], np.ones((high, wide))]).astype(np.float32).ravel())
    image.file_format, image.filepath_raw = "JPEG", str(path)
    image.save(quality=82)
    print(f"{path} {path.stat().st_size // 1000} kB")


def main():
    """Draws the sheets. Returns the exit code."""
    from handles import shapes

    kept, out = Path(sys.argv[1]), Path(sys.argv[2])
    grasps = [kept / f"{handle}_50_made.npz".replace(" ", "_") for handle in shapes.SHAPES]
    for count, first in enumerate(range(0, len(grasps), ROWS)):
        save(out / f"grasps_{count + 1}.jpg", map(grasp_row, grasps[first : first + ROWS]))
    poses = list(pose_rows())
    half = len(poses) // 2
    save(out / "poses_1.jpg", poses[:half])
    save(out / "poses_2.jpg", poses[half:])
    return 0


if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])
    code = main()
    sys.stdout.flush()
    os._exit(code)
