"""Why a grasp ranks lower than the best one, in words. Knows nothing of Blender."""

import json

_LEAST = 0.02
"""Difference of scores below which nothing is said of a cause."""
NAMES = {"POWER": "Power", "PINCH": "Pinch", "HOOK": "Hook"}


def title(row):
    """Kind and score of a row of the scene; the score counts against a grasp."""
    kind = NAMES.get(row.kind, row.kind.capitalize() or "Grasp")
    return f"{kind}, score {row.score:.1f}"


def numbers(row):
    """What a row carries."""
    return f"{row.total_n:.0f} N, {row.net_n:.0f} N left over"


def friction_of(row):
    """The friction that holds what a row leaves over."""
    return f"Friction {row.friction:.2f}" if row.friction < 10.0 else "No friction holds it"


def why(row, best, friction):
    """Why `row` ranks below `best`, rows of the scene; `friction`: what is there. Empty where nothing is kept."""
    if not row.facts or not best.facts:
        return ""
    if row.kind != best.kind and row.score < best.score:
        return f"scores of two kinds differ in what they ask: {NAMES.get(best.kind, best.kind).lower()} goes first"
    own, other = (json.loads(each.facts) for each in (row, best))
    more = {name: own["counted"].get(name, 0.0) - value for name, value in other["counted"].items()}
    cause = max(more, key=more.get)
    if more[cause] < _LEAST:
        rest = row.score - best.score - sum(more.values())
        return "not balanced to the end, as the best one is" if rest > _LEAST else "about as good"
    return _words(cause, (row, own), other, friction)


def _words(cause, own, other, friction):
    row, facts = own
    if cause == "touch" and facts["clear"] * other["pads"] > other["clear"] * facts["pads"]:
        return f"{facts['clear']} of {facts['pads']} pads hang clear (best: {other['clear']} of {other['pads']})"
    return {
        "touch": "its pads lie less deep than wanted",
        "balance": f"leaves {facts['net_share']:.0%} of its forces over (best: {other['net_share']:.0%}), or a moment",
        "sum": f"carries {row.total_n:.0f} of {facts['asked_n'] or 0.0:.0f} N",
        "peak": f"presses up to {facts['peak_kpa']:.0f} kPa (best: {other['peak_kpa']:.0f})",
        "deep": "presses skin or bone too deep",
        "slips": f"slips: needs a friction of {row.friction:.2f} where {friction:.2f} is there",
        "thumb": "the thumb's pad faces away from the index finger's",
        "place": "holds a part that suits the hand less",
        "bare": "leaves thumb and palm out",
    }[cause]
