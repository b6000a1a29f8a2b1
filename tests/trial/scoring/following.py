"""Follows "record this next": which protocols are the ones asked for and how often, and one at random."""

import hashlib
import math

from trial import cases, protocols

UNLIKE = 1.0  # away by more than this, none of those held back is what was asked for
MOST = 12  # presses of a protocol that can be recorded next


def is_open(case, verdict):
    """Whether it cannot tell, asks for a recording, and the case goes on."""
    asks = verdict.get("verdict") == "cannot_tell" and bool(verdict.get("record_next"))
    return asks and cases.goes_on(case)


def asked_for(case, verdict):
    """How often to record which protocol; None if nothing that is held back was asked for.

    Of those held back the closest to the first advice that any of them meets; with the tool that is pressed in turn
    whatever comes closest.
    """
    advice = met(case, verdict)
    if advice is None:
        return None
    wanted = advice["protocol"]
    often = min(int(wanted.get("presses") or 2), MOST)
    found = {nearest(case, cases.held_back(case), wanted)[1]: often}
    tool = wanted.get("in_turn_with")
    if tool:
        like = [one for one, how in protocols.PROTOCOLS.items() if how.tool == tool]
        found[nearest(case, like, wanted | {"radius_mm": None, "indenter": None})[1]] = often
    return found


def met(case, verdict):
    """The first advice that a protocol meets of those held back; None if there is none."""
    if not is_open(case, verdict):
        return None
    wanted = [advice for advice in verdict["record_next"] if "protocol" in advice]
    close = (one for one in wanted if nearest(case, cases.held_back(case), one["protocol"])[0] <= UNLIKE)
    return next(close, None)


def at_random(case, often=2):
    """One of the protocols held back, by the case's name alone, recorded as often; None if there is none."""
    held = cases.held_back(case)
    if not cases.goes_on(case):
        return None
    return {held[int(hashlib.sha256(case.encode()).hexdigest(), 16) % len(held)]: often}


def nearest(case, names, wanted):
    """(how far, name) of the protocol that comes closest to the one wanted."""
    return min((distance(case, name, wanted), name) for name in names)


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
