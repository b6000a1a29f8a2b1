"""Where a spot was said to lie against where it is: the miss in pitches, the 90 % set, the overlap. mm."""

import math


def of_spots(verdict):
    """Findings that name an inclusion and its place."""
    found = (one for one in verdict.get("findings", []) if one["effect"] == "inclusion")
    return [one for one in found if (one.get("where") or {}).get("center_mm")]


def miss(label, where):
    """Distance of the stated center from the true one, in pitches of the mat."""
    return math.dist(where["center_mm"], label["center_mm"]) / label["pitch_mm"]


def has_set(where):
    """Whether a set is told that holds the center at 90 %."""
    return bool(where.get("area_90_mm2"))


def is_in_set(label, where):
    """Whether the true center lies in the disc of the set's area around the stated one."""
    return math.dist(where["center_mm"], label["center_mm"]) <= math.sqrt(where["area_90_mm2"] / math.pi)


def overlap(label, where):
    """Area that the stated and the true disc share over the area that either covers."""
    away, first, second = math.dist(where["center_mm"], label["center_mm"]), where["radius_mm"], label["radius_mm"]
    both = _lens(away, first, second)
    return both / (math.pi * (first**2 + second**2) - both)


def _lens(away, first, second):
    """Area that two discs share."""
    if away >= first + second:
        return 0.0
    if away <= abs(first - second):
        return math.pi * min(first, second) ** 2
    one = (away**2 + first**2 - second**2) / (2.0 * away)
    two = away - one
    return sum(r * r * math.acos(x / r) - x * math.sqrt(r * r - x * x) for r, x in ((first, one), (second, two)))
