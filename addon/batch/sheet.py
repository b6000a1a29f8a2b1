"""The contact sheet: the pictures of a batch side by side, each with its case's name and numbers below."""

import math

import bpy
import numpy as np

from ..views import legend

_WIDTH, _CAPTION, _GAP = 320, 38, 10
"""Pixels of one picture's width, of the height of the text below it, and of the paper around both."""
_LONGEST = (46, 54)
"""Letters of a name, and of the line below it, that fit."""
_PAPER, _INK = 0.97, 0.12
MOST_PICTURES = 400
"""The sheet shows the first so many: a picture larger than 32,000 pixels opens nowhere."""


def make(out, table):
    """Write `sheet.png` into `out` from the pictures of (file's stem, row) in order; nothing where there is none."""
    shown = [(out / f"{stem}.png", row["name"], row) for stem, row in table if row is not None]
    shown = [each for each in shown if each[0].is_file()][:MOST_PICTURES]
    if not shown:
        return
    tiles = [tile for tile in (_tile(path, name, row) for path, name, row in shown) if tile is not None]
    if not tiles:
        return
    height, width = max(tile.shape[0] for tile in tiles) + _GAP, _WIDTH + _GAP
    columns = math.ceil(math.sqrt(len(tiles) * height / width))
    lines = math.ceil(len(tiles) / columns)
    page = np.full((lines * height + _GAP, columns * width + _GAP, 4), _PAPER, np.float32)
    page[..., 3] = 1.0
    for place, tile in enumerate(tiles):
        line, column = divmod(place, columns)
        top, left = page.shape[0] - _GAP - line * height, _GAP + column * width
        page[top - tile.shape[0] : top, left : left + _WIDTH] = tile
    _save(page, out / "sheet.png")


def _tile(path, name, row):
    """A picture (rows from below) shrunk to the sheet's width, on its caption; None for what is no picture."""
    image = bpy.data.images.load(str(path))
    try:
        if 0 in image.size:
            return None
        image.scale(_WIDTH, max(1, round(image.size[1] * _WIDTH / image.size[0])))
        flat = np.empty(image.size[0] * image.size[1] * 4, np.float32)
        image.pixels.foreach_get(flat)
        picture = flat.reshape(image.size[1], image.size[0], 4)
    finally:
        bpy.data.images.remove(image)
    numbers = row["message"] if row["status"] == "failed" else _told(row)
    words = [_cut(text, longest) for text, longest in zip((name, numbers), _LONGEST, strict=True)]
    texts = [(0, y, size, text) for y, size, text in zip((22, 7), (13, 11), words, strict=True)]
    ink = legend.ink(texts, _WIDTH, _CAPTION)[..., None]
    caption = np.ones((_CAPTION, _WIDTH, 4), np.float32)
    caption[..., :3] = _PAPER * (1.0 - ink) + _INK * ink
    return np.concatenate([caption, picture])


def _cut(text, longest):
    return text if len(text) <= longest else text[: longest - 3].rstrip() + "..."


def _told(row):
    return f"{row['force_n']:.1f} N, peak {row['peak_pressure_kpa']:.0f} kPa, {row['contact_area_mm2'] / 100:.1f} cm2"


def _save(page, path):
    sheet = bpy.data.images.new("Thenar Sheet", page.shape[1], page.shape[0], alpha=True)
    partial = path.with_name(f".{path.name}.partial.png")
    try:
        sheet.pixels.foreach_set(np.ascontiguousarray(page).ravel())
        sheet.filepath_raw, sheet.file_format = str(partial), "PNG"
        sheet.save()
        partial.replace(path)
    finally:
        bpy.data.images.remove(sheet)
        partial.unlink(missing_ok=True)
