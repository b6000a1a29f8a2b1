"""Where a new hand's skin lies on an older one: places that correspond by bone, though sizes and sides differ."""

from functools import cached_property

import numpy as np
from mathutils.bvhtree import BVHTree

SNAP = 1e-4
"""Shares of a triangle's corner below this are none: equal hands hand on exactly what they have."""


class Match:
    """Places on an older hand at rest that correspond to those of a new one; both (positions mm, triangles).

    `place(points)` carries the new rest to the old one.
    """

    def __init__(self, old, new, place):
        self._old, self._new = old, new
        self._points = place(new[0])
        self._tree = BVHTree.FromPolygons(old[0].tolist(), old[1].tolist(), all_triangles=True)

    @cached_property
    def vertices(self):
        """Old triangle (n,) of each new vertex, and the shares (n, 3) of that triangle's corners."""
        faces = _nearest(self._tree, self._points)
        return faces, _snapped(np.clip(_barycentric(self._old, faces, self._points), 0.0, 1.0))

    @cached_property
    def faces(self):
        """Old triangle (m,) of each new triangle, and the shares (m, 3, 3) at its corners.

        All three lie in the plane of that one old triangle, so that seams stay between triangles.
        """
        corners = self._points[self._new[1]]
        faces = _nearest(self._tree, corners.mean(axis=1))
        shares = [_barycentric(self._old, faces, corners[:, corner]) for corner in range(3)]
        return faces, _snapped(np.stack(shares, axis=1))


def between(old_frames, new_frames, weights):
    """Function that carries points (n, 3) of a new hand at rest to the older hand at rest, mm.

    Frames by bone: (rig_from_bone (4, 4), length); `weights` (n, b) of the new vertices in the order of `new_frames`.
    """
    matrices = np.array([motion[:3].ravel() for motion in motions(new_frames, old_frames).values()])
    total = np.maximum(weights.sum(axis=1, keepdims=True), 1e-9)
    blended = (weights / total @ matrices).reshape(-1, 3, 4)

    def place(points):
        return np.einsum("nij,nj->ni", blended[:, :, :3], points) + blended[:, :, 3]

    return place


def motions(frames, others):
    """Bone -> affine motion (4, 4), mm, that carries what rests on it in one hand to the other, stretched as it is."""
    broad = across(others) / across(frames)
    out = {}
    for name, (frame, length) in frames.items():
        other, other_length = others[name]
        out[name] = other @ np.diag([broad, other_length / length, abs(broad), 1.0]) @ _inverse(frame)
    return out


def _inverse(frame):
    """Inverse of a rotation with a place (4, 4); LAPACK's takes 5 ms a matrix where other threads compute."""
    out = np.eye(4)
    out[:3, :3] = frame[:3, :3].T
    out[:3, 3] = -frame[:3, :3].T @ frame[:3, 3]
    return out


def across(frames):
    """How far the index finger's knuckle lies from the little finger's along +x, mm; negative in a left hand."""
    index, little = (frames[f"{finger}_proximal"][0][0, 3] for finger in ("index", "little"))
    return float(index - little)


def _nearest(tree, points):
    find = tree.find_nearest
    return np.array([find(point)[2] for point in points.tolist()])


def _barycentric(surface, faces, points):
    """Shares (n, 3) of the corners of `faces` at the feet of `points` in their planes."""
    a, b, c = (surface[0][surface[1][faces, corner]] for corner in range(3))
    u, v, w = b - a, c - a, points - a
    uu, uv, vv = (np.einsum("ij,ij->i", one, other) for one, other in ((u, u), (u, v), (v, v)))
    wu, wv = np.einsum("ij,ij->i", w, u), np.einsum("ij,ij->i", w, v)
    whole = np.maximum(uu * vv - uv * uv, 1e-12)
    second, third = (vv * wu - uv * wv) / whole, (uu * wv - uv * wu) / whole
    return np.stack([1.0 - second - third, second, third], axis=1)


def _snapped(shares):
    shares = np.where(np.abs(shares) < SNAP, 0.0, shares)
    return shares / shares.sum(axis=-1, keepdims=True)
