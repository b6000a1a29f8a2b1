"""What a mat around a cylinder reads of a solved hand: skin pressure integrated over cells by NumPy, nothing of ours.

Cells stand in rows along z and columns around it from x, by the right hand.
"""

import bpy
import numpy as np

COLUMNS, ROWS = 31, 57
PARTS = 8
"""Each triangle is cut into the square of so many."""


def read(hand, radius_mm):
    """Pressure (rows, columns), kPa, on the cells of the mat on a cylinder about z, and the pitch, mm."""
    pitch = 2.0 * np.pi * radius_mm / COLUMNS
    points, kpa, triangles = _skin(hand)
    triangles = triangles[kpa[triangles].max(axis=1) > 0.0]
    corners, at = points[triangles], kpa[triangles]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    force = np.zeros((ROWS, COLUMNS))
    for shares in _middles():
        place = np.einsum("c,tci->ti", shares, corners)
        load = area / PARTS**2 * (at @ shares) / 1e3
        column = np.floor(np.arctan2(place[:, 1], place[:, 0]) * radius_mm / pitch).astype(int) % COLUMNS
        row = np.floor(place[:, 2] / pitch + ROWS / 2).astype(int)
        is_on = (row >= 0) & (row < ROWS)
        np.add.at(force, (row[is_on], column[is_on]), load[is_on])
    return 1e3 * force / pitch**2, pitch


def _middles():
    """Middles of the equal small triangles that a triangle is cut into, as shares of its corners."""
    out = []
    for i in range(PARTS):
        for j in range(PARTS - i):
            out.append((i + 1 / 3, j + 1 / 3))
            if i + j < PARTS - 1:
                out.append((i + 2 / 3, j + 2 / 3))
    return [np.array([1.0 - (a + b) / PARTS, a / PARTS, b / PARTS]) for a, b in out]


def _skin(hand):
    """The shown skin: vertices, mm in the world, its pressure there, kPa, and triangles."""
    shown = hand.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = shown.to_mesh()
    mesh.calc_loop_triangles()
    points, triangles = np.empty(3 * len(mesh.vertices), np.float32), np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.vertices.foreach_get("co", points)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    world = np.array(shown.matrix_world, float)
    points = points.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]
    shown.to_mesh_clear()
    kpa = np.array([each.value for each in hand.data.attributes["pressure_kpa"].data])
    return 1e3 * bpy.context.scene.unit_settings.scale_length * points, kpa, triangles.reshape(-1, 3)


def written(path, frame, pitch):
    """A text export of one frame, kPa."""
    rows, columns = frame.shape
    head = (
        "DATA_TYPE MOVIE\nVERSION Tekscan Pressure Measurement System 6.33\nSENSOR_TYPE TEST\n"
        f"ROWS {rows}\nCOLS {columns}\nROW_SPACING {pitch:.6f} mm\nCOL_SPACING {pitch:.6f} mm\n"
        f"SENSEL_AREA {pitch**2:.6f} mm2\nNOISE_THRESHOLD 0\nSECONDS_PER_FRAME 0.1\n"
        "START_FRAME 1\nEND_FRAME 1\nUNITS KPa\nMIRROR_ROW 0\nMIRROR_COL 0\nASCII_DATA @@\n\nFrame 1\n"
    )
    path.write_text(head + "".join(",".join(f"{cell:.3f}" for cell in row) + "\n" for row in frame))
    return str(path)
