"""Layout of the grasps found: a picture of each, what it carries, why it ranks lower, and a button that takes it."""

import bpy.utils.previews

from . import picture, reasons

_held = {"previews": None}
_SCALE = 4.2
"""Size of a picture in the panel, in buttons."""


def draw(layout, stored):
    """A box for each grasp of the scene's `thenar_grasps`, best first, and a button that looks for others."""
    best = stored.found[0]
    column = layout.column(align=True)
    for index, row in enumerate(stored.found):
        box = column.box().row(align=True)
        number = icon(row.picture)
        if number:
            box.template_icon(icon_value=number, scale=_SCALE)
        words = box.column(align=True)
        holds = row.friction <= stored.friction
        words.label(text=f"{index + 1}: {reasons.title(row)}", icon="CHECKMARK" if holds else "ERROR")
        words.label(text=reasons.numbers(row))
        words.label(text="Best" if index == 0 else reasons.why(row, best, stored.friction))
        is_shown = stored.shown == index
        text = "Taken" if is_shown else "Take"
        words.operator("thenar.use_grasp", text=text, depress=is_shown).index = index
    layout.operator("thenar.more_grasps", icon="VIEWZOOM")


def icon(text):
    """Blender's number of the picture that a text holds, made when it is asked for first; 0 where it holds none."""
    if not text:
        return 0
    if _held["previews"] is None:
        _held["previews"] = bpy.utils.previews.new()
    name = str(hash(text))
    if name not in _held["previews"]:
        preview = _held["previews"].new(name)
        preview.image_size = (picture.SIZE, picture.SIZE)
        preview.image_pixels_float = picture.colored(picture.unpacked(text)).ravel()
    return _held["previews"][name].icon_id


def forget():
    """Drop the pictures."""
    if _held["previews"] is not None:
        bpy.utils.previews.remove(_held["previews"])
        _held["previews"] = None
