"""Force before and after as small pictures in the panel: kept as text, drawn by NumPy, held by Blender's previews."""

import json
import re
from functools import lru_cache

import bpy.utils.previews
import numpy as np

WIDTH, HEIGHT = 256, 256
"""Pixels of a picture; the panel shows it square."""
_MOST, _POINTS = 2, 80
"""Curves that are kept, and points of each."""
_MARGIN, _PEN = 10, 1.6
_PAPER, _AXIS = (0.13, 0.13, 0.13, 1.0), (0.34, 0.34, 0.34)
MEASURED, BEFORE, AFTER = (0.92, 0.92, 0.92), (0.95, 0.55, 0.25), (0.35, 0.65, 1.0)
"""Colours, sRGB: readings are dots, the model is lines."""
_REPEAT = re.compile(r"\d+\D*$")
_held = {"previews": None}


def kept(curves, recordings):
    """The first of the library's curves in the order of `recordings`, thinned, as text; empty where there are none.

    Of recordings whose names differ in their last number only, one is kept: they repeat each other.
    """
    order = {name: place for place, name in enumerate(dict.fromkeys(recordings))}
    chosen = {}
    for curve in sorted(curves, key=lambda curve: order.get(curve["recording"], len(order))):
        chosen.setdefault(_REPEAT.sub("", curve["recording"]), curve)
    chosen = list(chosen.values())[:_MOST]
    return json.dumps([_thinned(curve) for curve in chosen], separators=(",", ":")) if chosen else ""


@lru_cache(maxsize=8)
def read(text):
    """Kept curves: dictionaries of `recording` and lists `time_s`, `measured_n`, `before_n`, `after_n`."""
    return tuple(json.loads(text)) if text else ()


def icon(text, number):
    """Blender's number of the picture of a kept curve; it is drawn when it is asked for first."""
    if _held["previews"] is None:
        _held["previews"] = bpy.utils.previews.new()
    name = f"{number} {hash(text)}"
    if name not in _held["previews"]:
        preview = _held["previews"].new(name)
        preview.image_size = (WIDTH, HEIGHT)
        preview.image_pixels_float = picture(read(text)[number]).ravel()
    return _held["previews"][name].icon_id


def forget():
    """Drop the pictures."""
    if _held["previews"] is not None:
        bpy.utils.previews.remove(_held["previews"])
        _held["previews"] = None


def picture(curve):
    """RGBA (height, width, 4) float32, rows from below: force over time, from no force at the axis."""
    image = np.empty((HEIGHT, WIDTH, 4), np.float32)
    image[:] = _PAPER
    lines = {name: np.array(curve[name], dtype=np.float64) for name in ("before_n", "after_n", "measured_n")}
    time = np.array(curve["time_s"], dtype=np.float64)
    low = min(0.0, *(np.nanmin(values) for values in lines.values()))
    high = max(np.nanmax(values) for values in lines.values())
    x = _MARGIN + (time - time[0]) / max(np.ptp(time), 1e-12) * (WIDTH - 2 * _MARGIN)
    level = (HEIGHT - 2 * _MARGIN) / max(high - low, 1e-12)
    axis = _MARGIN - low * level
    _stroke(image, np.array([[_MARGIN, axis], [WIDTH - _MARGIN, axis]]), _AXIS)
    for name, color in (("before_n", BEFORE), ("after_n", AFTER)):
        _stroke(image, np.column_stack([x, _MARGIN + (lines[name] - low) * level]), color)
    for place in np.column_stack([x, _MARGIN + (lines["measured_n"] - low) * level]):
        _stroke(image, np.array([place, place]), MEASURED)
    return image


def _thinned(curve):
    count = len(curve["time_s"])
    rows = np.unique(np.linspace(0, count - 1, min(count, _POINTS)).round().astype(int))
    names = ("time_s", "measured_n", "before_n", "after_n")
    thin = {name: [float(f"{value:.4g}") for value in np.asarray(curve[name])[rows]] for name in names}
    return {"recording": curve["recording"], **thin}


def _stroke(image, points, color):
    """Draw a line through `points` (n, 2), pixels, with soft edges; what is not a number is left out."""
    for start, end in zip(points[:-1], points[1:], strict=True):
        if not (np.isfinite(start).all() and np.isfinite(end).all()):
            continue
        low = np.maximum(np.floor(np.minimum(start, end) - 3).astype(int), 0)
        high = np.minimum(np.ceil(np.maximum(start, end) + 4).astype(int), (WIDTH, HEIGHT))
        x, y = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
        along = end - start
        share = ((x - start[0]) * along[0] + (y - start[1]) * along[1]) / max(along @ along, 1e-12)
        share = np.clip(share, 0.0, 1.0)
        apart = np.hypot(x - start[0] - share * along[0], y - start[1] - share * along[1])
        ink = np.clip(_PEN + 0.5 - apart, 0.0, 1.0)[..., None]
        part = image[low[1] : high[1], low[0] : high[0], :3]
        part[:] = part * (1.0 - ink) + np.array(color, np.float32) * ink
