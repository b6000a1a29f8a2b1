"""The film *Turntable*: hand and product turn once in 4 s; the product is drawn clear, so that the map shows."""

import numpy as np

from ..hand_look import studio
from ..picture_stage import page, pixels, stage, views
from . import film, grip_and_print
from . import order as orders

SECONDS = 4
_TURN = (60.0, 128.0, 1800.0, 750.0)
_CLEAR = (0.90, 0.94, 0.95, 1.0)


def draw(order, subject, context):
    """Write the film, or without FFmpeg its frames as numbered PNG. Returns the paths. Raises `Refusal`."""
    return film.written(order, order.rate, lambda folder: _frames(order, subject, context, folder))


def _frames(order, subject, context, folder):
    """The frames as PNG in `folder`. Returns their paths."""
    draw_clear(subject)
    view, number, paths = views.of_grip(context, subject), SECONDS * order.rate, []
    pivot, window, floor = _whole(order, subject, view)
    for frame in range(number):
        turned = _about_up(2.0 * np.pi * frame / number) @ view
        middle = turned @ pivot
        shown = stage.Window((middle[0], window.middle[1]), window.mm, window.size)
        shot = stage.Shot(context.scene.thenar, subject.gripped(), turned, shown, subject.scale, samples=order.samples)
        shot.floor_mm = middle[2] - floor
        shot.on_progress = orders.Progress(order).part(frame, number)
        sheet = page.Page(grip_and_print.WIDTH, grip_and_print.HEIGHT, stage.PAGE)
        sheet.picture(_TURN, stage.take(shot))
        grip_and_print.head(sheet, context, order.is_stale)
        sheet.text((960.0, 52.0, "center"), 22.0, "The product is drawn clear", page.FAINT)
        page.add_scale_bar(sheet, (grip_and_print.MARGIN, 52.0), window.mm * order.factor, 220.0)
        page.add_legend(sheet, context.scene.thenar, grip_and_print.LEGEND)
        paths.append(folder / f"{frame + 1:04}.png")
        pixels.save_png(paths[-1], page.painted(sheet, order.factor))
    return paths


def draw_clear(subject):
    """Let the product be seen through."""
    for part in subject.product:
        part.mesh.materials.clear()
        part.mesh.materials.append(studio.clear("Thenar Picture Clear", _CLEAR))


def _about_up(angle):
    """A turn (3, 3) about the view's up."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])


def _whole(order, subject, view):
    """The pivot (3,), mm, a window that shows the whole turn, and how far the sheet lies behind the pivot, mm."""
    shown = grip_and_print.near(subject, subject.gripped(), view)
    seen = shown @ view.T
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2.0
    around = np.hypot(seen[:, 0] - middle[0], seen[:, 2] - middle[2]).max()
    corners = np.array([[x, y, 0.0] for x in (-around, around) for y in (seen[:, 1].min(), seen[:, 1].max())])
    size = tuple(round(value * order.factor) for value in _TURN[2:])
    window = stage.framing(corners + [middle[0], 0.0, 0.0], np.eye(3), size, fill=0.86)
    depth = max(
        float(np.linalg.norm(solid.points_mm(subject.scale) - view.T @ middle, axis=1).max())
        for solid in subject.gripped()
    )
    return view.T @ middle, window, depth
