"""Product files written byte by byte from the formats' descriptions: a box of 40 x 30 x 125 about the origin."""

import json
import struct

import numpy as np

SIDES = (40.0, 30.0, 125.0)
_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_TRIANGLES = [
    (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4),
    (1, 5, 7), (1, 7, 3),
]  # fmt: skip


def corners(scale=1.0):
    """The box's corners (8, 3)."""
    return _CORNERS * SIDES * scale


def stl(scale=1.0):
    """Binary: 80 bytes, the count, then normal, three corners and two bytes for each triangle."""
    points = corners(scale)
    rows = [struct.pack("<12fH", 0, 0, 0, *points[list(t)].ravel(), 0) for t in _TRIANGLES]
    return b"made by hand".ljust(80, b"\0") + struct.pack("<I", len(rows)) + b"".join(rows)


def stl_text(scale=1.0):
    """The same as text."""
    lines = ["solid box"]
    for triangle in _TRIANGLES:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex {} {} {}".format(*corners(scale)[index]) for index in triangle]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid box", ""]).encode()


def obj(scale=1.0):
    """Corners, then faces that count from 1; z up, so y and z change places."""
    lines = [f"v {x} {z} {-y}" for x, y, z in corners(scale)]
    return "\n".join([*lines, *("f {} {} {}".format(*(i + 1 for i in t)) for t in _TRIANGLES), ""]).encode()


def ply(scale=1.0):
    """Text: header, corners, faces."""
    head = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 12\nproperty list uchar int vertex_indices\nend_header\n"
    rows = ["{} {} {}".format(*row) for row in corners(scale)] + ["3 {} {} {}".format(*t) for t in _TRIANGLES]
    return (head + "\n".join(rows) + "\n").encode()


def ply_bytes(scale=1.0):
    """The same in bytes."""
    head = "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
    head += "property float z\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [struct.pack("<B3i", 3, *t) for t in _TRIANGLES]
    return head.encode() + corners(scale).astype("<f4").tobytes() + b"".join(rows)


def usda(scale=1.0, unit=1.0):
    """Text, z up, with a camera next to the box; `unit`: metres per unit."""
    points = ", ".join("({}, {}, {})".format(*row) for row in corners(scale))
    faces = ", ".join(str(index) for t in _TRIANGLES for index in t)
    return (
        f'#usda 1.0\n(\n metersPerUnit = {unit}\n upAxis = "Z"\n startTimeCode = 5\n endTimeCode = 9\n)\n'
        f'def Mesh "box"\n{{\n int[] faceVertexCounts = [{", ".join("3" for _ in _TRIANGLES)}]\n'
        f" int[] faceVertexIndices = [{faces}]\n point3f[] points = [{points}]\n}}\n"
        'def Camera "eye"\n{\n}\ndef SphereLight "lamp"\n{\n}\n'
    ).encode()


def glb(scale=1.0, count=1):
    """`count` boxes 100 units apart along x under one moved and turned node, with a camera, in the format's y up."""
    points = (corners(scale) @ np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])).astype("<f4")
    indices = np.array(_TRIANGLES, "<u2").ravel()
    data = points.tobytes() + indices.tobytes()
    nodes = [{"name": "root", "children": [*range(1, count + 2)], "translation": [0.0, 0.25, 0.0]}]
    nodes += [{"name": f"part{k}", "mesh": 0, "translation": [100.0 * scale * k, 0.0, 0.0]} for k in range(count)]
    nodes += [{"name": "eye", "camera": 0}]
    held = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes,
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.01}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 96},
                        {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3",
                       "min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()},
                      {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
    }  # fmt: skip
    text = json.dumps(held).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


WRITERS = {
    "bytes.stl": stl,
    "text.stl": stl_text,
    "box.obj": obj,
    "text.ply": ply,
    "bytes.ply": ply_bytes,
    "box.usda": usda,
    "box.glb": glb,
}
