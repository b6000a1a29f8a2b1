"""Small pictures of a hand on a product: points with normals are projected, the nearest one is shaded. Only NumPy."""

import base64
import zlib

import numpy as np

SIZE = 96
"""Pixels to a side."""
HAND, PRODUCT = 1, 65
"""First code of either; `LEVELS` shades follow, 0 is nothing."""
LEVELS = 64
_FILL = 0.92
_COLORS = {HAND: (0.93, 0.68, 0.55), PRODUCT: (0.38, 0.55, 0.66)}
_LIGHT = (-0.45, 0.55, 0.70)
_REACH = 0.35
"""How far the product is shown beyond the hand, as a share of the hand's size."""


def faces(points, triangles):
    """Points spread over triangles, and their unit normals: corners, middles of edges and of faces; (7 m, 3) each."""
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    normal = np.cross(b - a, c - a)
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    spread = np.concatenate([a, b, c, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0])
    return spread, np.tile(normal, (7, 1))


def shaded(hand, product, view):
    """Codes (SIZE, SIZE) uint8, rows from below, of hand and product, each (points, normals); `view`: away and up."""
    turn = _turn(*view)
    low, high = _window(hand[0] @ turn.T, product[0] @ turn.T)
    scale = _FILL * SIZE / max((high - low).max(), 1e-9)
    middle = (low + high) / 2.0
    codes, depths = np.zeros(SIZE * SIZE, np.uint8), np.full(SIZE * SIZE, -np.inf)
    for first, (points, normals), spread in ((PRODUCT, product, 2), (HAND, hand, 1)):
        seen = points @ turn.T
        light = np.abs(normals @ turn.T @ (np.array(_LIGHT) / np.linalg.norm(_LIGHT)))
        code = (first + np.minimum(light * LEVELS, LEVELS - 1)).astype(np.uint8)
        facing = normals @ turn[2] > 0.0
        _lay((codes, depths), (seen[facing], code[facing]), (middle, scale), spread)
    return codes.reshape(SIZE, SIZE)


def _lay(canvas, shown, window, spread):
    """Put points on the canvas, nearest last, each on a square of `spread` + 1 pixels."""
    (codes, depths), (seen, code), (middle, scale) = canvas, shown, window
    order = np.argsort(seen[:, 2], kind="stable")
    pixel = np.floor((seen[order, :2] - middle) * scale + SIZE / 2.0).astype(int)
    depth, code = seen[order, 2], code[order]
    for shift in np.ndindex(spread + 1, spread + 1):
        column, row = (pixel + shift).T
        inside = (column >= 0) & (column < SIZE) & (row >= 0) & (row < SIZE)
        place = row[inside] * SIZE + column[inside]
        nearer = depth[inside] > depths[place]
        place, near, own = place[nearer], depth[inside][nearer], code[inside][nearer]
        codes[place], depths[place] = own, near  # of those on one pixel NumPy keeps the last, which is the nearest


def _window(hand, product):
    """Lowest and highest (x, y): the hand, and the product as far as it is near."""
    low, high = hand[:, :2].min(axis=0), hand[:, :2].max(axis=0)
    reach = _REACH * (high - low).max()
    near = np.clip(product[:, :2], low - reach, high + reach)
    return np.minimum(low, near.min(axis=0)), np.maximum(high, near.max(axis=0))


def _turn(away, up):
    away = np.asarray(away, float) / np.linalg.norm(away)
    up = np.asarray(up, float) - away * (np.asarray(up, float) @ away)
    up /= np.linalg.norm(up)
    return np.stack([np.cross(up, away), up, away])


def packed(codes):
    """A picture as text."""
    return base64.b64encode(zlib.compress(codes.tobytes(), 9)).decode("ascii")


def unpacked(text):
    """The same back, (SIZE, SIZE) uint8. Raises `ValueError` where the text is no picture."""
    try:
        data = zlib.decompress(base64.b64decode(text))
    except zlib.error as error:
        raise ValueError(f"the text holds no picture: {error}") from None
    return np.frombuffer(data, np.uint8).reshape(SIZE, SIZE)


def colored(codes):
    """RGBA (SIZE, SIZE, 4), float32, of the codes of a picture; nothing is clear."""
    out = np.zeros((*codes.shape, 4), np.float32)
    for first, color in _COLORS.items():
        rows = (codes >= first) & (codes < first + LEVELS)
        light = 0.35 + 0.65 * (codes[rows].astype(np.float32) - first) / (LEVELS - 1)
        out[rows, :3], out[rows, 3] = light[:, None] * np.array(color, np.float32), 1.0
    return out
