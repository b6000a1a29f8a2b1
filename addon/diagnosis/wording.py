"""Words and numbers of the letter: effects, values with intervals, places and times, as a reader wants them."""

import re
from math import isfinite

from ..properties import effect_settings
from ..results import sentences

PHASES = {
    "load": "while pressing in",
    "hold": "while holding",
    "unload": "while letting go",
    "slide": "while sliding",
    "rest": "at rest",
}
UNITS = {"1": "", "J/m2": "J/m²", "mm2/s": "mm²/s", "standard deviations of the noise": "σ"}
"""Units that are shown shorter than the library tells them."""
_NUMBERED = re.compile(r"([a-z_]+)_\d+(_|$)")
_SHARE = "share "
"""What the library's unit begins with where a value is a part of something."""
_OUT_OF_REASON = 1e3
"""In every unit in which sizes are told (mm, N, s, mm/N) a hand has none of these."""
DEPENDS = {
    "time": "time",
    "rate": "speed",
    "cycle": "count of presses",
    "direction": "direction of motion",
    "radius": "size of the tool",
    "contact_radius": "size of the contact",
    "skin_position": "position on the skin",
    "sensor_position": "position on the sensor",
}


def title(name):
    """An effect's or number's name for reading."""
    return effect_settings.title(name)


def number_title(key, keys):
    """A number's name for reading; where it is the only one of its list, without its place: `time_3_s` is Time.

    `keys`: the names of all numbers that are shown with it.
    """
    stem = _NUMBERED.match(key)
    alone = stem is not None and sum(each.startswith(stem[1] + "_") for each in keys) == 1
    return title(stem[1]) if alone else title(key)


def name(effect):
    """An effect's name in the middle of a sentence."""
    return effect.replace("_", " ")


def apart(effects):
    """What follows "cannot distinguish": `relaxation from drainage`, `gain, modulus and offset`."""
    words = [name(effect) for effect in effects]
    return " from ".join(words) if len(words) < 3 else listed(words)


def number(value):
    """Three digits, without an exponent where that is readable."""
    if value is None or not isfinite(value):
        return "unknown"
    if value != 0.0 and not 1e-3 <= abs(value) < 1e6:
        return f"{value:.2e}"
    text = f"{value:.3g}"
    return f"{float(text):.0f}" if "e" in text else text


def interval(low, high):
    """`0.31–0.37`; with `to` where a minus sign would be read as a dash. Empty where there is none that is known."""
    if low is None or high is None or low == high or not (isfinite(low) and isfinite(high)):
        return ""
    return f"{number(low)} to {number(high)}" if low < 0.0 else f"{number(low)}–{number(high)}"


def value(told):
    """A value with its unit and, in brackets, its interval: `1.4 s (0.9–2.2)`."""
    if isinstance(told.get("value"), str):
        return told["value"]
    unit = UNITS.get(told.get("unit"), told.get("unit") or "")
    if unit.startswith(_SHARE) and told.get("low") is None and told.get("value") is not None:
        return f"{number(100 * told['value'])} % {unit.removeprefix(_SHARE)}"
    text = number(told.get("value")) + (f" {unit}" if unit else "")
    between = interval(told.get("low"), told.get("high"))
    return f"{text} ({between})" if between else text


def estimate(stated, is_fitted=True):
    """A finding's number: `value`, or the bound where recordings bound it from one side alone: `at least 0.2 MPa`.

    One without a width, among those that are fitted, was taken as known: `3.88 mm (not fitted)`.
    """
    low, high = stated.get("low", 0.0), stated.get("high", 0.0)
    if low is not None and high is not None:
        is_fixed = is_fitted and "low" in stated and low == high and not isinstance(stated.get("value"), str)
        return f"{value(stated)} (not fitted)" if is_fixed else value(stated)
    if low is None and high is None:
        return "not determined"
    word, end = ("at most", high) if low is None else ("at least", low)
    return f"{word} {number(end)} {UNITS.get(stated.get('unit'), stated.get('unit') or '')}".rstrip()


def least(seen):
    """The detection limit of an effect; `not detectable` where it is out of reason or not known."""
    size = seen.get("value")
    whole = 1.0 if (seen.get("unit") or "").startswith(_SHARE) else _OUT_OF_REASON
    return value(seen) if size is not None and size < whole else "not detectable"


def share(part):
    """A share as percent; never 100 % or 0 % where it is not quite that."""
    if part is None or not isfinite(part):
        return "unknown"
    if 0.995 <= part < 1.0:
        return "> 99 %"
    if 0.0 < part < 0.005:
        return "< 1 %"
    return f"{100 * part:.0f} %"


def place(where):
    """Where a finding lies, as a sentence. Empty where it lies everywhere."""
    parts = []
    if where.get("region"):
        parts.append(f"in the region {sentences.region_title(where['region'])}")
    if where.get("site"):
        parts.append(f"at the site {where['site']}")
    if where.get("center_mm") and where.get("radius_mm"):
        parts.append(f"within {number(where['radius_mm'])} mm of one point")
    return f"It lies {', '.join(parts)}." if parts else ""


def moment(when):
    """When a finding shows, as a sentence: phase, time, depth, cycles and recordings. Empty where always."""
    phases = when.get("phase") or []
    phases = phases.replace("|", ",").split(",") if isinstance(phases, str) else phases
    parts = [PHASES.get(phase.strip(), phase.strip()) for phase in phases]
    cycles = [cycle + 1 for cycle in when.get("cycles") or () if cycle is not None]
    parts += [_span(when.get("time_s"), "s"), _span(when.get("depth_mm"), "mm depth")]
    if len(cycles) == 2 and cycles[1] > 1:
        parts.append(f"in presses {cycles[0]}–{cycles[1]}" if cycles[1] > cycles[0] else f"in press {cycles[1]}")
    parts = [part for part in parts if part]
    if when.get("recordings"):
        parts.append(f"in {some(when['recordings'])}")
    return f"It shows {', '.join(parts)}." if parts else ""


def _span(ends, unit):
    """`at 0.8–30 s`, or `up to 2 mm depth` from before first touch. Empty where it is not known."""
    if not ends or len(ends) != 2 or None in ends:
        return ""
    if ends[0] <= 0.0:
        return f"up to {number(ends[1])} {unit}"
    return f"at {number(ends[0]) if ends[0] == ends[1] else interval(*ends)} {unit}"


def depended(word):
    """What something depends on, as a reader says it."""
    return DEPENDS.get(word, name(word))


def depends(words):
    """`It depends on time and on speed.` Empty where that is not known."""
    words = [depended(word) for word in words or ()]
    return f"It depends on {listed(words)}." if words else ""


def listed(words):
    """`a, b and c`."""
    words = list(words)
    return " and ".join(words) if len(words) < 3 else f"{', '.join(words[:-1])} and {words[-1]}"


def some(names, most=3):
    """The first few names in quotes, and how many more."""
    quoted = [f"'{name}'" for name in names or ()]
    more = len(quoted) - most
    return listed([*quoted[:most], f"{more} more"] if more > 0 else quoted)


def meaning(effect):
    """What an effect is, as a sentence; empty for what the library does not list."""
    text = effect_settings.meaning(effect)
    return text[:1].upper() + text[1:] + "." if text else ""
