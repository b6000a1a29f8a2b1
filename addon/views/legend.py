"""The legend of the map on the skin: one layout, drawn by the viewport and painted into renders."""

import os
import tempfile
from dataclasses import dataclass

import blf
import bpy
import numpy as np

from .. import colormap, maps
from . import pixel_font

TICKS = 5
PLATE = (0.09, 0.09, 0.10, 0.78)
"""Colour behind the legend, sRGB with alpha."""
FINER = 3
"""How much larger letters are drawn than shown: Blender's own edges are hard at the sizes of a legend."""


@dataclass(frozen=True)
class Layout:
    """Where the legend's parts stand, in pixels from the lower left: boxes are (x, y, width, height)."""

    plate: tuple
    bar: tuple
    texts: tuple
    """(x, y, size, text), from the baseline's left end."""


def layout(look, result, height, left):
    """The legend for an image or region of `height` pixels, its plate's left edge at `left`."""
    view, scale = maps.shown(look), maps.scale(maps.shown(look), look)
    unit = max(height / 540.0, 0.6)
    size, bar_width, bar_height = 13 * unit, 16 * unit, 200 * unit
    x, y = left + 14 * unit, 22 * unit
    plate = (left, 10 * unit, 128 * unit, bar_height + 70 * unit)
    texts = [
        (x, y + bar_height + 36 * unit, size * 1.15, view.title),
        (x, y + bar_height + 18 * unit, size * 0.85, view.unit),
    ]
    for tick in range(TICKS):
        fraction = tick / (TICKS - 1)
        label = number(scale.value(fraction)) + (" +" if tick == TICKS - 1 and exceeds(look, result) else "")
        texts.append((x + bar_width + 9 * unit, y + fraction * bar_height - size * 0.35, size, label))
    return Layout(plate, (x, y, bar_width, bar_height), tuple(texts))


def raised(plan, height):
    """The same layout, `height` pixels further up."""

    def lift(box):
        return box[0], box[1] + height, *box[2:]

    return Layout(lift(plan.plate), lift(plan.bar), tuple(lift(text) for text in plan.texts))


def exceeds(look, result):
    """Whether something lies above the top of the colours."""
    view = maps.shown(look)
    peak = maps.peak(view, result)
    if view.kind == maps.PRESSURE and look.hand is not None and look.hand.thenar.bake_path:
        peak = look.hand.thenar.bake.frame_peak_kpa  # keyed: that of the frame that plays
    return peak > maps.scale(view, look).high * 1.0005


def number(value):
    """A tick's number: as few digits as say it."""
    return f"{value:.4g}"


def column_on_plate(look, steps):
    """The bar's colours (steps, 3), sRGB, from the lowest value upwards."""
    scale = maps.scale(maps.shown(look), look)
    return colormap.srgb(scale.palette, (np.arange(steps) + 0.5) / steps)


def pixels(look, result, width, height):
    """The legend as RGBA (height, width, 4) float32, sRGB, straight alpha, rows from below; transparent elsewhere."""
    image = np.zeros((height, width, 4), np.float32)
    plan = layout(look, result, height, left=width * 0.02)
    _fill(image, plan.plate, PLATE)
    rows, columns = _span(plan.bar, image)
    image[rows, columns, :3] = column_on_plate(look, rows.stop - rows.start)[:, None, :]
    image[rows, columns, 3] = 1.0
    text = ink(plan.texts, width, height)[..., None]
    image[..., :3] = image[..., :3] * (1.0 - text) + 0.95 * text
    image[..., 3:] = np.maximum(image[..., 3:], text)
    return image


def _span(box, image):
    x, y, width, height = (round(value) for value in box)
    return slice(max(y, 0), min(y + height, image.shape[0])), slice(max(x, 0), min(x + width, image.shape[1]))


def _fill(image, box, color):
    rows, columns = _span(box, image)
    image[rows, columns] = color


def ink(texts, width, height):
    """How far text covers each pixel (height, width), by Blender's own font on a buffer of its own."""
    if not hasattr(blf, "bind_imbuf"):  # Blender before 4.4
        return pixel_font.ink(texts, width, height)
    import imbuf

    fine = (width * FINER, height * FINER)
    buffer = imbuf.new(fine)
    with blf.bind_imbuf(0, buffer):
        for x, y, size, text in texts:
            blf.size(0, size * FINER)
            blf.color(0, 1.0, 1.0, 1.0, 1.0)
            blf.position(0, x * FINER, y * FINER, 0)
            blf.draw_buffer(0, text)
    handle, path = tempfile.mkstemp(suffix=".png")
    os.close(handle)
    try:
        imbuf.write(buffer, filepath=path)
        return _red(path, *fine).reshape(height, FINER, width, FINER).mean(axis=(1, 3))
    finally:
        os.unlink(path)


def _red(path, width, height):
    image = bpy.data.images.load(path)
    try:
        image.colorspace_settings.name = "Non-Color"
        flat = np.empty(width * height * 4, np.float32)
        image.pixels.foreach_get(flat)
        return flat.reshape(height, width, 4)[..., 0]
    finally:
        bpy.data.images.remove(image)
