"""What a picture says of a result in words and numbers: product, hand, force, area, peak, grade, and if it is stale."""

from ..results import grades
from ..scene.units import cm2
from . import page

_ORDINALS = {1: "st", 2: "nd", 3: "rd"}
STALE = "Out of date: hand, product or settings changed after this result"
COLORS = {grades.GOOD: page.SOUND, grades.READ: page.CAUTION, grades.DO_NOT: page.ALARM}


def product_title(result):
    """The product's name."""
    return result.product_name or "Product"


def hand_title(hand):
    """Side, sex and percentile of a made hand, or the name of another's."""
    shape = getattr(hand, "thenar_hand", None)
    if shape is None or not shape.is_made:
        return hand.name
    whose = f"{shape.side.capitalize()} hand, {shape.sex}"
    if shape.size == "OWN":
        return f"{whose}, {shape.length_mm:.0f} by {shape.breadth_mm:.0f} mm"
    return f"{whose}, {ordinal(round(shape.percentile))} percentile"


def ordinal(number):
    """`1st`, `2nd`, `13th`."""
    suffix = "th" if number % 100 in (11, 12, 13) else _ORDINALS.get(number % 10, "th")
    return f"{number}{suffix}"


def numbers(result):
    """(caption, value with unit) of the totals."""
    return [
        ("Force", f"{result.force_n:.1f} N"),
        ("Area", f"{cm2(result.area_mm2):.1f} cm²"),
        ("Peak", f"{result.peak_kpa:.0f} kPa"),
    ]


def summary(result):
    """Force, area and peak on one line."""
    return " · ".join(value for _, value in numbers(result))


def grade_title(result):
    """The grade as a label; empty for results that have none."""
    return grades.title(result.grade) if result.grade else ""


def cautions(result, is_stale):
    """(sentence, color) of all that a viewer must know before the numbers; the gravest first."""
    found = [(STALE, page.ALARM)] if is_stale else []
    if result.grade in (grades.READ, grades.DO_NOT):
        found.append((f"{grades.title(result.grade)}: {result.reason}", COLORS[result.grade]))
    return found
