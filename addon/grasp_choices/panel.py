"""Layout of the grasps found: a picture of each, what it carries, why it ranks lower, and a button that takes it."""

import bpy.utils.previews

from ..languages import iface
from ..panels import text
from . import picture, reasons

_held = {"previews": None}
_SCALE, _SHARE = 4.0, 0.38
"""Size of a picture in the panel, in buttons, and its share of the width."""


def draw(layout, context):
    """A box for each grasp of the scene's `thenar_grasps`, best first, and a button that looks for others."""
    stored = context.scene.thenar_grasps
    best = stored.found[0]
    column = layout.column(align=True)
    for index, row in enumerate(stored.found):
        box = column.box().column(align=True)
        number, words = icon(row.picture), box
        if number:
            head = box.split(factor=_SHARE)
            head.template_icon(icon_value=number, scale=_SCALE)
            words = head.column(align=True)
        words.label(text=reasons.title(row, index + 1))
        words.label(text=reasons.numbers(row))
        words.label(text=reasons.friction_of(row))
        is_shown, holds = stored.shown == index, row.friction <= stored.friction
        taking = iface("Taken") if is_shown else iface("Take")
        words.operator("thenar.use_grasp", text=taking, depress=is_shown).index = index
        why = iface("Holds: the best one") if index == 0 and holds else reasons.why(row, best, stored.friction)
        if why:
            text.paragraph(box, context, why, "CHECKMARK" if holds else "ERROR")
    layout.operator("thenar.more_grasps", icon="VIEWZOOM")


def icon(packed):
    """Blender's number of the picture that a text holds, made when it is asked for first; 0 where it holds none."""
    if not packed:
        return 0
    if _held["previews"] is None:
        _held["previews"] = bpy.utils.previews.new()
    name = str(hash(packed))
    if name not in _held["previews"]:
        preview = _held["previews"].new(name)
        preview.image_size = (picture.SIZE, picture.SIZE)
        preview.image_pixels_float = picture.colored(picture.unpacked(packed)).ravel()
    return _held["previews"][name].icon_id


def forget():
    """Drop the pictures."""
    if _held["previews"] is not None:
        bpy.utils.previews.remove(_held["previews"])
        _held["previews"] = None
