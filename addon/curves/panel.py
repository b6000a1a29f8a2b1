"""Layout of the curves: numbers of the shown frame, the picture, and a strip of buttons under it that shows a frame."""

from ..languages import iface
from . import pictures, tables

_SHARE = 0.3
"""Of the width, what the numbers take; the rest is the picture."""
_CELLS = 28
"""Most buttons of the strip: each is about 6 pixels wide in a sidebar of default width."""
_UNIT = 20
"""Pixels of a button's height at interface scale 1."""


def draw(layout, context, source):
    """Draw the curves of a source, `tables.BAKE` or `RECORDING`. Returns whether there are any."""
    table = tables.of(context, source)
    if table is None:
        return False
    box = layout.box()
    units, side = _size(context)
    split = box.split(factor=_SHARE)
    numbers = split.column(align=True)
    for number, column in enumerate(table.columns):
        if number:
            numbers.separator(factor=_gap(units))
        numbers.label(text=column.title)
        numbers.label(text=column.said(table.row))
    split.template_icon(icon_value=pictures.icon(table, side), scale=units)
    split = box.split(factor=_SHARE)
    split.label(text=iface("Frame {number}", number=f"{table.frames[table.row]:g}"))
    _draw_strip(split.row(align=True), table)
    row = box.row(align=True)
    for title, column in (("Max. Force", 0), ("Max. Peak", 2)):
        button = row.operator("thenar.show_frame", text=title, icon="KEYFRAME_HLT")
        button.source, button.frame = table.source, round(float(table.frames[table.columns[column].values.argmax()]))
    return True


def _draw_strip(row, table):
    """Buttons from the first frame to the last, as wide together as the picture; the shown frame's is pressed."""
    count = min(len(table.frames), _CELLS)
    here = min(int(table.shares[table.row] * count), count - 1)
    for cell in range(count):
        at = table.near((cell + 0.5) / count if count < len(table.frames) else cell / (count - 1))
        button = row.operator("thenar.show_frame", text="", depress=cell == here)
        button.source, button.frame = table.source, round(float(table.frames[at]))


def _size(context):
    """Side of the picture: in buttons' heights, and in pixels."""
    scale = context.preferences.system.ui_scale
    units = max(4.0, (context.region.width / scale - 66) * (1.0 - _SHARE) / _UNIT)
    return units, max(64, round(units * _UNIT * scale) - 8)


def _gap(units):
    """What separates the numbers of two bands, so that they stand next to them: a separator is 0.4 of a button high."""
    return max(0.1, (units / 3.0 - 2.0) / 0.4)
