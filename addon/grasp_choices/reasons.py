"""Why a grasp ranks lower than the best one, in words. Knows nothing of Blender but its language."""

import json

from ..languages import iface

_LEAST = 0.02
"""Difference of scores below which nothing is said of a cause."""
KINDS = {"POWER": "Power", "PINCH": "Pinch", "LATERAL": "Lateral", "HOOK": "Hook"}


def title(row, number):
    """Number, kind and score of a row of the scene; the score counts against a grasp."""
    if row.kind not in KINDS:
        return iface("{number}: score {score:.1f}", number=number, score=row.score)
    return iface("{number}: {kind}, score {score:.1f}", number=number, kind=iface(KINDS[row.kind]), score=row.score)


def numbers(row):
    """What a row carries."""
    return iface("{force_n:.0f} N, {net_n:.0f} N left over", force_n=row.total_n, net_n=row.net_n)


def friction_of(row):
    """The friction that holds what a row leaves over."""
    held = iface("Friction {friction:.2f}", friction=row.friction)
    return held if row.friction < 10.0 else iface("No friction holds it")


def why(row, best, friction):
    """Why `row` ranks below `best`, rows of the scene; `friction`: what is there. Empty where nothing is kept."""
    if not row.facts or not best.facts:
        return ""
    if row.kind != best.kind and row.score < best.score:
        kind = iface(KINDS.get(best.kind, "Power"))
        return iface("Scores of two kinds differ in what they ask: {kind} goes first", kind=kind)
    own, other = (json.loads(each.facts) for each in (row, best))
    own_counts, counts = own["counted"], other["counted"]
    more = {name: own_counts.get(name, 0.0) - counts.get(name, 0.0) for name in {**counts, **own_counts}}
    cause = max(more, key=more.get)
    if more[cause] < _LEAST:
        return iface("About as good")
    return _words(cause, (row, own), other, friction)


def _words(cause, own, other, friction):
    row, facts = own
    share, best = facts["net_share"], other["net_share"]
    if cause == "touch" and facts["clear"] * other["pads"] > other["clear"] * facts["pads"]:
        counts = {"clear": facts["clear"], "pads": facts["pads"], "best": other["clear"], "of": other["pads"]}
        return iface("{clear} of {pads} pads hang clear (best: {best} of {of})", **counts)
    if cause == "balance":
        return iface("Leaves {share:.0%} of its forces over (best: {best:.0%}), or a moment", share=share, best=best)
    if cause == "sum":
        return iface("Carries {force_n:.0f} of {asked_n:.0f} N", force_n=row.total_n, asked_n=facts["asked_n"] or 0.0)
    if cause == "peak":
        peaks = {"peak": facts["peak_kpa"], "best": other["peak_kpa"]}
        return iface("Presses up to {peak:.0f} kPa (best: {best:.0f})", **peaks)
    if cause == "slips":
        words = "Slips: needs a friction of {needed:.2f} where {friction:.2f} is there"
        return iface(words, needed=row.friction, friction=friction)
    return iface(_PLAIN[cause])


_PLAIN = {
    "touch": "Its pads lie less deep than wanted",
    "deep": "Presses skin or bone too deep",
    "settled": "Not balanced to the end, as the best one is",
    "refused": "Its result is not to be used",
    "thumb": "The thumb's pad faces away from the index finger's",
    "bare": "Leaves thumb and palm out",
    "place": "Holds a part that suits the hand less",
}
