"""The picture of a table, by NumPy: a band for each column, and a line at the frame that is shown."""

import bpy.utils.previews
import numpy as np

PAPER, GRID, NOW = (0.13, 0.13, 0.13), (0.30, 0.30, 0.30), (0.95, 0.95, 0.95)
COLORS = ((0.35, 0.65, 1.0), (0.40, 0.80, 0.50), (0.95, 0.55, 0.25))
"""Colours of the bands from above, sRGB."""
INSET = 4
"""Pixels between the picture's side and its first or last frame."""
_GAP, _PEN, _SHADE = 5, 1.0, 0.28
"""Pixels between a band's curve and its border; half the line's width, pixels; how strong the area under it is."""
_FINER = 8
"""Samples of a curve in a column of pixels; more where it has more frames."""
_MOST = 8
"""Pictures that are kept."""
_held = {"previews": None, "curves": {}}


def icon(table, side):
    """Blender's number of the table's picture of `side` x `side` pixels; drawn when it is asked for first."""
    if _held["previews"] is None:
        _held["previews"] = bpy.utils.previews.new()
    previews = _held["previews"]
    name = f"{side} {table.row} {_digest(table)}"
    if name not in previews:
        if len(previews) >= _MOST:
            previews.clear()
        preview = previews.new(name)
        preview.image_size = (side, side)
        preview.image_pixels_float.foreach_set(marked(_curves(table, side), table.shares[table.row]).ravel())
    return previews[name].icon_id


def forget():
    """Drop the pictures."""
    if _held["previews"] is not None:
        bpy.utils.previews.remove(_held["previews"])
        _held["previews"] = None
    _held["curves"].clear()


def _digest(table):
    return hash((table.source, *(np.asarray(part).tobytes() for part in (table.frames, *_values(table)))))


def _values(table):
    return [np.asarray(column.values, float) for column in table.columns]


def _curves(table, side):
    """The picture without its line, drawn once for a table and size."""
    key = side, _digest(table)
    if key not in _held["curves"]:
        _held["curves"] = {key: curves(table, side)}
    return _held["curves"][key]


def curves(table, side):
    """RGBA (side, side, 4) float32, rows from below: each column in its band from 0 (or its least) to its largest."""
    image = np.ones((side, side, 4), np.float32)
    image[..., :3] = PAPER
    edges = np.linspace(side, 0, len(table.columns) + 1).round().astype(int)
    for values, color, top, bottom in zip(_values(table), COLORS, edges[:-1], edges[1:], strict=True):
        _draw(image[bottom:top], (table.shares, values), color)
        image[bottom, :, :3] = GRID
    return image


def marked(image, share):
    """The same with a line at a `share` of the way from the first frame to the last."""
    image = image.copy()
    column = round(INSET + share * (image.shape[1] - 1 - 2 * INSET))
    image[:, column, :3] = NOW
    return image


def _draw(band, curve, color):
    """Draw one curve, (shares, values), and the area under it; largest and least touch the inset of the band."""
    height, width = band.shape[:2]
    shares, values = curve
    least, largest = min(0.0, float(values.min())), float(values.max())
    finer = max(_FINER, -(-len(values) // width))
    places = (np.arange(width * finer) + 0.5) / finer - 0.5
    across = (places - INSET) / (width - 1 - 2 * INSET)
    level = (np.interp(across, shares, values) - least) / max(largest - least, 1e-12)
    level = (_GAP + level * (height - 1 - 2 * _GAP)).reshape(width, finer)
    rows = np.arange(height)[:, None]
    low, high = level.min(axis=1), level.max(axis=1)
    apart = np.maximum(np.maximum(rows - high, low - rows), 0.0)
    drawn = (across.reshape(width, finer).mean(axis=1) >= 0.0) & (across.reshape(width, finer).mean(axis=1) <= 1.0)
    ink = np.clip(_PEN + 0.5 - apart, 0.0, 1.0) * drawn
    zero = _GAP + (0.0 - least) / max(largest - least, 1e-12) * (height - 1 - 2 * _GAP)
    under = (rows > np.minimum(zero, low)) & (rows < np.maximum(zero, high)) & drawn
    for share in (_SHADE * under, ink):
        band[..., :3] = band[..., :3] * (1.0 - share[..., None]) + np.float32(color) * share[..., None]
