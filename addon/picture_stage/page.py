"""A page of pictures, boxes and text, in units of its own from the lower left, and how it is painted into pixels."""

import functools
from dataclasses import dataclass, field

import blf
import numpy as np

from .. import colormap, maps
from ..views import legend

INK, FAINT, RULE = (0.13, 0.13, 0.15), (0.42, 0.42, 0.45), (0.80, 0.79, 0.78)
ALARM, CAUTION, SOUND = (0.76, 0.10, 0.10), (0.66, 0.40, 0.02), (0.10, 0.45, 0.22)
"""Text in sRGB: usual, behind it, hairlines; and of the three grades."""
_ALIGN = {"left": 0.0, "center": 0.5, "right": 1.0}
_STEPS = 512


@dataclass(frozen=True)
class Text:
    """A line of text: where its baseline is anchored, its size, color and how it is aligned there."""

    place: tuple
    size: float
    text: str
    color: tuple = INK
    align: str = "left"


@dataclass(frozen=True)
class Box:
    """A filled rectangle: (x, y, width, height) and its color."""

    box: tuple
    color: tuple


@dataclass(frozen=True)
class Picture:
    """Pixels (rows from below, columns, 3), sRGB, that fill (x, y, width, height)."""

    box: tuple
    pixels: object


@dataclass
class Page:
    """What stands on a page of `width` by `height`; later items cover earlier ones."""

    width: float
    height: float
    color: tuple
    items: list = field(default_factory=list)

    def text(self, place, size, text, color=INK):
        """Write a line from (x, y) on, or from (x, y, align) with `left`, `center` or `right`."""
        self.items.append(Text(place[:2], size, text, color, *place[2:]))

    def box(self, box, color):
        """Fill a rectangle."""
        self.items.append(Box(box, color))

    def picture(self, box, pixels):
        """Lay a picture down."""
        self.items.append(Picture(box, pixels))


def painted(page, factor):
    """The page as (height, width, 3), sRGB, rows from below, `factor` pixels per unit."""
    canvas = np.empty((round(page.height * factor), round(page.width * factor), 3))
    canvas[:] = page.color
    for item in page.items:
        if isinstance(item, Text):
            _write(canvas, item, factor)
        else:
            x, y, width, height = (value * factor for value in item.box)
            rows, columns = _span(y, height, canvas.shape[0]), _span(x, width, canvas.shape[1])
            if isinstance(item, Box):
                canvas[rows, columns] = item.color
            else:
                shape = rows.stop - rows.start, columns.stop - columns.start
                canvas[rows, columns] = _fitted(item.pixels, shape)
    return canvas


def share_left(align):
    """Share of a line that stands left of its anchor."""
    return _ALIGN[align]


def width_of(text, size):
    """Width of a line in units, by the font that paints it."""
    blf.size(0, 100.0)
    return blf.dimensions(0, text)[0] * size / 100.0


def fitting(text, size, width):
    """The size at which a line is at most `width` wide, at most `size`."""
    return min(size, size * width / max(width_of(text, size), 1e-9))


def wrapped(text, size, width):
    """The lines of a text that are at most `width` wide, where its words allow it."""
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and width_of(longer, size) > width:
            lines.append(word)
        else:
            lines[-1] = longer
    return [line for line in lines if line]


def add_legend(page, look, box):
    """The colors of the pressure as a bar in (x, y, width, height), with ticks below and its unit above."""
    x, y, width, height = box
    view = maps.MAPS[maps.PRESSURE]
    scale = maps.scale(view, look)
    colors = colormap.srgb(scale.palette, (np.arange(_STEPS) + 0.5) / _STEPS)
    page.picture((x, y, width, height), np.broadcast_to(colors, (4, _STEPS, 3)))
    page.text((x, y + height + 0.6 * height), 0.95 * height, f"{view.title}, {view.unit}", FAINT)
    more = look.result.is_valid and look.result.peak_kpa > scale.high * 1.0005
    for tick in range(4):
        share = tick / 3.0
        label = legend.number(scale.value(share)) + ("+" if more and tick == 3 else "")
        align = ("left", "center", "center", "right")[tick]
        page.text((x + share * width, y - 1.15 * height, align), 0.9 * height, label, INK)


def add_scale_bar(page, place, mm_per_unit, longest):
    """A bar of a round length, at most `longest` units, from `place` to the right. Returns its length, mm."""
    length = round_length(longest * mm_per_unit)
    x, y = place
    width = length / mm_per_unit
    page.box((x, y, width, 4.0), INK)
    for end in (x, x + width - 3.0):
        page.box((end, y - 5.0, 3.0, 14.0), INK)
    page.text((x + width / 2.0, y + 18.0, "center"), 20.0, f"{length:g} mm", INK)
    return length


def round_length(most_mm):
    """The largest of 1, 2 and 5 times a power of ten that is at most `most_mm`."""
    power = 10.0 ** np.floor(np.log10(most_mm))
    return float(next(factor * power for factor in (5.0, 2.0, 1.0) if factor * power <= most_mm * (1.0 + 1e-9)))


def _span(start, length, most):
    """The pixels from `start` on, one at least; cut where the page ends."""
    first = min(max(round(start), 0), most)
    return slice(first, min(max(round(start + length), first + 1), most))


def _fitted(pixels, shape):
    """The pixels at that size, each the nearest one; unchanged where the size is theirs."""
    if pixels.shape[:2] == shape:
        return pixels
    rows = (np.arange(shape[0]) + 0.5) * pixels.shape[0] / shape[0]
    columns = (np.arange(shape[1]) + 0.5) * pixels.shape[1] / shape[1]
    return pixels[rows.astype(int)][:, columns.astype(int)]


def _write(canvas, item, factor):
    if not item.text:
        return
    size = item.size * factor
    cover, below = _stamp(item.text, round(size, 3))
    x = item.place[0] * factor - _ALIGN[item.align] * _inked(item.text, size) - 2.0
    left, bottom = round(x), round(item.place[1] * factor) - below
    rows = slice(max(bottom, 0), min(bottom + cover.shape[0], canvas.shape[0]))
    columns = slice(max(left, 0), min(left + cover.shape[1], canvas.shape[1]))
    if rows.start >= rows.stop or columns.start >= columns.stop:
        return
    part = cover[rows.start - bottom : rows.stop - bottom, columns.start - left : columns.stop - left, None]
    canvas[rows, columns] = canvas[rows, columns] * (1.0 - part) + np.array(item.color) * part


def _inked(text, size):
    """Width of a line in pixels as the legend's font draws it: letters of whole pixels, three of them to one shown."""
    blf.size(0, size * legend.FINER)
    return blf.dimensions(0, text)[0] / legend.FINER


@functools.lru_cache(maxsize=256)
def _stamp(text, size):
    """How far a line covers each pixel around it, and how many of the rows lie below its baseline."""
    below = int(0.35 * size) + 2
    width, height = int(_inked(text, size)) + 8, below + int(1.1 * size) + 2
    return legend.ink([(2.0, float(below), size, text)], width, height), below
