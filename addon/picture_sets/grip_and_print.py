"""The picture *Grip and print*: the hand on the product, and the same hand opened with its print, in one scale."""

import numpy as np

from ..picture_stage import facts, page, stage, views
from . import order as orders

WIDTH, HEIGHT = 1920.0, 1080.0
MARGIN = 64.0
LEGEND = (WIDTH - MARGIN - 420.0, 52.0, 420.0, 18.0)
"""Box of the legend's colors."""
_GRIP, _PRINT = (60.0, 128.0, 1020.0, 750.0), (1100.0, 128.0, 760.0, 750.0)
"""Boxes (x, y, width, height) of the two parts, in units of a page 1080 high."""


def draw(order, subject, context):
    """The page, whose units are 1/1080 of its height. `order`: as in `drawing.draw`."""
    sheet = page.Page(WIDTH, HEIGHT, stage.PAGE)
    parts = (
        (_GRIP, subject.gripped(), views.of_grip(context, subject)),
        (_PRINT, [subject.opened], views.of_print(context, subject)),
    )
    mm = lay(sheet, (subject, context), parts, orders.Progress(order))
    for part, caption in zip(parts, ("Grip", "The same hand, opened"), strict=True):
        box = part[0]
        sheet.text((box[0] + box[2] / 2.0, box[1] + 2.0, "center"), 22.0, caption, page.FAINT)
    head(sheet, context, order.is_stale)
    page.add_scale_bar(sheet, (MARGIN, 52.0), mm * order.factor, 220.0)
    page.add_legend(sheet, context.scene.thenar, LEGEND)
    return sheet


def lay(sheet, scene, parts, progress):
    """Lay pictures of `parts` (box, solids, view) on the sheet, all in one scale. Returns mm a pixel.

    `scene`: the subject and the context.
    """
    (subject, context), factor = scene, progress.order.factor
    mm = max(_window(subject, part, factor).mm for part in parts)
    for number, part in enumerate(parts):
        box, solids, view = part
        window = stage.Window(_window(subject, part, factor).middle, mm, _pixels(box, factor))
        shot = stage.Shot(context.scene.thenar, solids, view, window, subject.scale, samples=progress.order.samples)
        shot.on_progress = progress.part(number, len(parts))
        sheet.picture(box, stage.take(shot))
    return mm


def head(sheet, context, is_stale, top=None):
    """Title, totals and cautions along the page's top."""
    settings, top = context.scene.thenar, sheet.height - MARGIN if top is None else top
    result = settings.result
    title = facts.product_title(result)
    sheet.text((MARGIN, top - 78.0), 25.0, facts.hand_title(settings.hand), page.FAINT)
    columns = [*facts.numbers(result), *([("Grade", facts.grade_title(result))] if result.grade else [])]
    x = sheet.width - MARGIN
    for caption, value in reversed(columns):
        color = facts.COLORS.get(result.grade, page.INK) if caption == "Grade" else page.INK
        sheet.text((x, top - 38.0, "right"), 40.0, value, color)
        sheet.text((x, top - 72.0, "right"), 20.0, caption, page.FAINT)
        x -= max(page.width_of(value, 40.0), page.width_of(caption, 20.0)) + 56.0
    sheet.text((MARGIN, top - 38.0), page.fitting(title, 50.0, x - MARGIN), title)
    y = top - 112.0
    for text, color in facts.cautions(result, is_stale):
        for line in page.wrapped(text, 20.0, sheet.width - 2.0 * MARGIN):
            sheet.text((MARGIN, y), 20.0, line, color)
            y -= 26.0


def near(subject, solids, view):
    """Corners (n, 3), world mm, of the hand, and of the product as far as it is near the hand as seen in `view`."""
    none = np.empty((0, 3))
    hand = np.concatenate([none, *(solid.points_mm(subject.scale) for solid in solids if solid.kind == "hand")])
    product = [solid.points_mm(subject.scale) for solid in solids if solid.kind == "product"]
    if not product or not len(hand):
        return np.concatenate([hand, *product])
    product = np.concatenate(product)
    low, high = (hand @ view.T).min(axis=0)[:2], (hand @ view.T).max(axis=0)[:2]
    reach = 0.5 * (high - low).max()
    found = (product @ view.T)[:, :2]
    return np.concatenate([hand, product[((found > low - reach) & (found < high + reach)).all(axis=1)]])


def _window(subject, part, factor):
    box, solids, view = part
    return stage.framing(near(subject, solids, view), view, _pixels(box, factor), fill=0.86)


def _pixels(box, factor):
    return round(box[2] * factor), round(box[3] * factor)
