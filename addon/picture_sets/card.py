"""The page *Comfort card*: two views, totals, bars by finger, and hands of three sizes next to each other."""

from .. import names
from ..picture_stage import facts, page, stage, views
from ..results import grades, sentences
from ..scene.units import cm2
from . import grip_and_print, sizes
from . import order as orders

WIDTH, HEIGHT, MARGIN = 1240.0, 1754.0, 80.0
"""A4 at 150 units an inch."""
_VIEWS, _VIEWS_ALONE = 470.0, 700.0
"""Height of the two views with hands of other sizes below them, and without."""
_GAP = 24.0
_VIEWS_SHARE = 0.4
"""Share of the time that the two views take where hands of other sizes follow."""
BAR, _TROUGH = (0.78, 0.30, 0.20), (0.915, 0.91, 0.90)
_FEW = 8
"""Most rows of bars."""


def draw(order, subject, context):
    """The page; hands of other sizes are made last, since that changes the file most."""
    result, sheet = context.scene.thenar.result, page.Page(WIDTH, HEIGHT, stage.PAGE)
    y = _head(sheet, context, order)
    height = _VIEWS if order.with_percentiles else _VIEWS_ALONE
    y -= height + _GAP
    _views(sheet, order, (subject, context), (y, height))
    y = _bars(sheet, result, y - 112.0)
    foot = _foot(result)
    for number, line in enumerate(reversed(foot)):
        sheet.text((MARGIN, 48.0 + 24.0 * number), 17.0, line, page.FAINT)
    if order.with_percentiles:
        _three(sheet, order, context, y - 64.0)
    return sheet


def _head(sheet, context, order):
    settings, top = context.scene.thenar, HEIGHT - MARGIN
    result, width = settings.result, WIDTH - 2.0 * MARGIN
    sheet.text(
        (MARGIN, top - 40.0), page.fitting(facts.product_title(result), 54.0, width), facts.product_title(result)
    )
    sheet.text((MARGIN, top - 80.0), 25.0, f"Comfort card · {facts.hand_title(settings.hand)}", page.FAINT)
    columns = [*facts.numbers(result), ("Mean", f"{result.mean_kpa:.1f} kPa"), ("Grade", facts.grade_title(result))]
    sheet.box((MARGIN, top - 108.0, width, 1.5), page.RULE)
    for number, (caption, value) in enumerate(columns):
        x, color = MARGIN + number * width / len(columns), page.INK
        if caption == "Grade":
            color = facts.COLORS.get(result.grade, page.INK)
        sheet.text((x, top - 158.0), 36.0, value, color)
        sheet.text((x, top - 188.0), 20.0, caption, page.FAINT)
    y = top - 222.0
    for text, color in facts.cautions(result, order.is_stale):
        for line in page.wrapped(text, 20.0, width):
            sheet.text((MARGIN, y), 20.0, line, color)
            y -= 27.0
    return y


def _views(sheet, order, scene, place):
    (subject, context), (y, height) = scene, place
    width = (WIDTH - 2.0 * MARGIN - _GAP) / 2.0
    parts = (
        ((MARGIN, y, width, height), subject.gripped(), views.of_grip(context, subject)),
        ((MARGIN + width + _GAP, y, width, height), [subject.opened], views.of_print(context, subject)),
    )
    progress = orders.Progress(order, 0.0, _VIEWS_SHARE if order.with_percentiles else 1.0)
    mm = grip_and_print.lay(sheet, (subject, context), parts, progress)
    page.add_scale_bar(sheet, (MARGIN, y - 36.0), mm * order.factor, 180.0)
    page.add_legend(sheet, context.scene.thenar, (WIDTH - MARGIN - 380.0, y - 34.0, 380.0, 18.0))


def _bars(sheet, result, y):
    """Force by finger as bars, with force, peak and area. Returns where they end."""
    rows = list(result.fingers) or list(result.regions)
    rows = sorted(rows, key=lambda row: -row.force_n)[:_FEW] if len(rows) > _FEW else rows
    sheet.text((MARGIN, y), 26.0, "By finger" if len(result.fingers) else "By region")
    ends = [WIDTH - MARGIN - 250.0, WIDTH - MARGIN - 120.0, WIDTH - MARGIN]
    for end, caption in zip(ends, ("Force", "Area", "Peak"), strict=True):
        sheet.text((end, y, "right"), 18.0, caption, page.FAINT)
    most = max((row.force_n for row in rows), default=0.0)
    for row in rows:
        y -= 36.0
        sheet.text((MARGIN, y), 21.0, sentences.region_title(row.name))
        _bar(sheet, (MARGIN + 210.0, y - 3.0, 530.0), row.force_n / most if most > 0.0 else 0.0)
        values = (f"{row.force_n:.1f} N", f"{cm2(row.area_mm2):.1f} cm²", f"{row.peak_kpa:.0f} kPa")
        for end, value in zip(ends, values, strict=True):
            sheet.text((end, y, "right"), 21.0, value, page.INK)
    return y


def _bar(sheet, place, share):
    x, y, width = place
    sheet.box((x, y, width, 20.0), _TROUGH)
    if share > 0.0:
        sheet.box((x, y, max(width * share, 1.5), 20.0), BAR)


def _three(sheet, order, context, y):
    """Hands of three sizes: their prints in one scale, and their totals."""
    sheet.text((MARGIN, y), 26.0, "By hand size")
    sheet.text((MARGIN + 190.0, y), 18.0, sizes.how(context), page.FAINT)
    width = (WIDTH - 2.0 * MARGIN - 2.0 * _GAP) / 3.0
    below = 48.0 + 24.0 * len(_foot(context.scene.thenar.result)) + 118.0
    box_height = y - 20.0 - below
    progress = orders.Progress(order, _VIEWS_SHARE, 1.0 - _VIEWS_SHARE)
    found = sizes.drawn(order, context, (width, box_height), progress)
    for number, hand in enumerate(found):
        x = MARGIN + number * (width + _GAP)
        if hand.pixels is not None:
            sheet.picture((x, below, width, box_height), hand.pixels)
        middle = x + width / 2.0
        sheet.text((middle, below - 16.0, "center"), 22.0, f"{facts.ordinal(hand.percentile)} percentile", page.INK)
        rows = [(line, page.ALARM) for line in page.wrapped(hand.problem, 17.0, width)]
        rows = rows or [(hand.summary, page.INK), (grades.title(hand.grade), facts.COLORS.get(hand.grade, page.INK))]
        for row, (line, color) in enumerate(rows[:4]):
            sheet.text((middle, below - 46.0 - 26.0 * row, "center"), 17.0 if hand.problem else 20.0, line, color)


def _foot(result):
    texts = [result.comfort] if result.comfort and result.comfort_source else []
    texts.append(f"{result.made_with or names.VERSION} · model: {result.model} · simulated, not measured")
    return [line for text in texts for line in page.wrapped(text, 17.0, WIDTH - 2.0 * MARGIN)]
