"""The picture *On Glass*: the hand seen through the plate that it presses, blood pressed out of its skin."""

import bpy
import numpy as np

from .. import names
from ..picture_stage import glass, laying, page, stage, views
from ..scene.checks import Refusal
from . import grip_and_print
from . import order as orders

_GLASS, _MAP = (40.0, 118.0, 1010.0, 790.0), (1070.0, 118.0, 810.0, 790.0)
_FILL = 0.93
_EYE_MM = 520.0
"""Distance of the eye from the glass: an arm's length, at which fingers behind the glass look smaller."""
_ONE_SIDED = 0.8
"""Least share of the forces that points one way: a plate has all, a held cylinder next to none."""
_PANES = ((-92.0, 100.0, 46.0, 66.0), (-40.0, 100.0, 46.0, 66.0))
"""Mirrored windows: middle (x, y) from the middle of what is seen, width and height, mm in the plane of the glass."""


def draw(order, subject, context):
    """The page, in units of 1/1080 of its height. Raises `Refusal` where the product is pressed from several sides."""
    view, plane = _seen(context, subject)
    progress, hand = orders.Progress(order), subject.hand
    for part in subject.product:
        part.mesh.materials.clear()
        part.mesh.materials.append(glass.plate())
        part.has_map = False
    own = glass.own_color(list(hand.mesh.materials))
    skin = laying.Solid(hand.mesh.copy(), hand.matrix, "hand", False)
    glass.dress(skin.mesh)
    sheet = page.Page(grip_and_print.WIDTH, grip_and_print.HEIGHT, stage.PAGE)
    behind = [*subject.product, *subject.others]
    windows = [_window(subject, view, plane, box, order.factor) for box in (_GLASS, _MAP)]
    mm = max(window.mm for window in windows)
    for number, (box, shown) in enumerate(((_GLASS, skin), (_MAP, hand))):
        window = stage.Window(windows[number].middle, mm, windows[number].size)
        panes = [_pane(view, plane, window, subject.scale, place) for place in _PANES] if shown is skin else []
        shot = stage.Shot(context.scene.thenar, [shown, *behind, *panes], view, window, subject.scale)
        shot.samples, shot.perspective = order.samples, (plane, _EYE_MM)
        shot.on_progress = progress.part(number, 2)
        sheet.picture(box, stage.take(shot))
    for box, caption in ((_GLASS, "Seen through the glass"), (_MAP, "The same, with its pressure")):
        sheet.text((box[0] + box[2] / 2.0, box[1] + 2.0, "center"), 22.0, caption, page.FAINT)
    grip_and_print.head(sheet, context, order.is_stale)
    page.add_scale_bar(sheet, (grip_and_print.MARGIN, 52.0), mm * order.factor, 220.0)
    _add_skin_legend(sheet, own, (430.0, 52.0, 420.0, 18.0))
    page.add_legend(sheet, context.scene.thenar, grip_and_print.LEGEND)
    return sheet


def _seen(context, subject):
    """The view (3, 3) through the product on the pressed skin, fingers up, and the height of that skin in it, mm."""
    force, points = subject.hand.field(names.FORCE_N).astype(float), subject.hand.points_mm(subject.scale)
    away = (subject.hand.normals() * force[:, None]).sum(axis=0)
    if np.linalg.norm(away) < _ONE_SIDED * max(force.sum(), 1e-12):
        raise Refusal(
            "the product is pressed from more than one side, so it cannot be seen through as a plate of glass; press "
            "the hand on a flat product, as in the sample 'Hand on glass', or choose Grip and Print"
        )
    start = subject.opened.points_mm(subject.scale)
    count = min(len(start), len(points))
    long = views.rotation(start[:count], points[:count]) @ views.opened_frame(context, subject)[1]
    view = views.turn(away, long)
    return view, float((points @ view[2] * force).sum() / force.sum())


def _window(subject, view, plane, box, factor):
    """What is seen of hand and plate in perspective, framed for a box."""
    hand = subject.hand.points_mm(subject.scale)
    middle = (hand @ view.T)[:, :2].mean(axis=0)
    seen = grip_and_print.near(subject, [subject.hand, *subject.product], view) @ view.T
    seen[:, :2] = middle + (seen[:, :2] - middle) * (_EYE_MM / (_EYE_MM + plane - seen[:, 2:]))
    seen[:, 2] = 0.0
    size = tuple(round(value * factor) for value in box[2:])
    return stage.framing(seen, np.eye(3), size, fill=_FILL)


def _pane(view, plane, window, scale, place):
    """A lit pane in front of the glass that is seen in its mirror alone."""
    x, y, width, height = place
    middle = np.array([*window.middle, plane + 0.6 * _EYE_MM]) + [x * 1.6, y * 1.6, 0.0]
    corners = [middle + [a * width * 0.8, b * height * 0.8, 0.0] for a, b in ((-1, -1), (-1, 1), (1, 1), (1, -1))]
    mesh = bpy.data.meshes.new("Thenar Picture Pane")
    mesh.from_pydata((np.array(corners) @ view / scale).tolist(), [], [(0, 1, 2, 3)])
    mesh.materials.append(glass.softbox(1.6))
    return laying.Solid(mesh, np.eye(4), "other", False)


def _add_skin_legend(sheet, own, box):
    """The skin's color by pressure as a bar, with ticks."""
    x, y, width, height = box
    steps = 256
    linear = glass.color_under(glass.BLOODLESS_KPA * (np.arange(steps) + 0.5) / steps, own)
    sheet.picture(box, np.broadcast_to(stage.colormap_srgb(linear), (4, steps, 3)))
    sheet.text((x, y + 1.6 * height), 0.95 * height, "Color of the skin on the glass, by pressure, kPa", page.FAINT)
    for tick in range(4):
        share, align = tick / 3.0, ("left", "center", "center", "right")[tick]
        label = f"{share * glass.BLOODLESS_KPA:g}" + ("+" if tick == 3 else "")
        sheet.text((x + share * width, y - 1.15 * height, align), 0.9 * height, label, page.INK)
