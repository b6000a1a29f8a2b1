"""Follows "record this next": which protocol that a case holds back is the one asked for, and one at random."""

import hashlib
import math

from trial import cases, protocols

UNLIKE = 1.0  # away by more than this, none of those held back is what was asked for


def is_open(case, verdict):
    """Whether it cannot tell, asks for a recording, and the case holds one back."""
    asks = verdict.get("verdict") == "cannot_tell" and bool(verdict.get("record_next"))
    return asks and bool(cases.held_back(case))


def asked_for(case, verdict):
    """The protocol held back that comes closest to the first advice that any of them meets; None if none does."""
    if not is_open(case, verdict):
        return None
    held = cases.held_back(case)
    for advice in verdict.get("record_next", []):
        away = {name: distance(case, name, advice.get("protocol", {})) for name in held}
        if away and min(away.values()) <= UNLIKE:
            return min(away, key=away.get)
    return None


def at_random(case):
    """One of the protocols held back, by the case's name alone; None if there is none."""
    held = cases.held_back(case)
    return held[int(hashlib.sha256(case.encode()).hexdigest(), 16) % len(held)] if held else None


def distance(case, name, wanted):
    """How far a protocol is from the one wanted: octaves of radius, a quarter of speed's, hold, cycles."""
    about = described(case, name)
    wanted = wanted | (wanted.get("indenter") if isinstance(wanted.get("indenter"), dict) else {})
    away = 0.0
    if wanted.get("shape", "sphere") != "sphere":
        return math.inf
    for key, weight in (("radius_mm", 1.0), ("speed_mm_s", 0.25)):
        if wanted.get(key):
            away += weight * abs(math.log2(about[key] / wanted[key]))
    if wanted.get("hold_s") is not None:
        away += float((wanted["hold_s"] > 0.0) != (about["hold_s"] > 0.0))
    if wanted.get("cycles"):
        away += float((wanted["cycles"] > 1) != (about["cycles"] > 1))
    return away


def described(case, name):
    """A protocol of a case in numbers."""
    pad, how = cases.index()[case]["pad"], protocols.PROTOCOLS[name]
    return {
        "radius_mm": protocols.radius(pad, how.tool),
        "speed_mm_s": protocols.SPEEDS[protocols.PADS[pad][0]][how.speed],
        "hold_s": how.hold_s,
        "cycles": how.cycles,
    }
