"""What a findings.json must look like: names, types, ranges, and that its parts do not contradict each other."""

import math

TISSUE = {
    "relaxation",
    "drainage",
    "bone",
    "stiff_skin",
    "inclusion",
    "stiffening_law",
    "region_coupling",
    "friction",
    "adhesion",
    "cycle_softening",
    "compressibility",
    "rate_independent_loss",
}
INSTRUMENT = {
    "gain",
    "offset",
    "drift",
    "saturation",
    "threshold",
    "crosstalk",
    "misregistration",
    "fixture_compliance",
    "timing",
    "dead_cells",
}
EFFECTS = TISSUE | INSTRUMENT
VERDICTS = {
    "nothing_missing",
    "parameters",
    "instrument",
    "missing_physics",
    "cannot_tell",
    "unlisted",
    "insufficient_data",
}
PHASES = {"load", "hold", "unload", "slide", "rest"}
LISTS = ("findings", "names_90", "cannot_tell", "record_next")
ERRORS = ("before", "after", "noise_floor", "reducible_error_removed")


def faults(found):
    """Sentences about what is wrong with a findings.json that was read; empty if nothing is."""
    if not isinstance(found, dict):
        return ["it is no object"]
    wrong = [f"{path} is not finite" for path, value in _leaves(found, "") if _is_not_finite(value)]
    wrong += [] if found.get("schema") == 1 else [f"schema is {found.get('schema')!r}, not 1"]
    wrong += [] if found.get("verdict") in VERDICTS else [f"there is no verdict {found.get('verdict')!r}"]
    if not isinstance(found.get("sentence"), str) or not found["sentence"].strip():
        wrong.append("there is no sentence")
    missing = [name for name in LISTS if not isinstance(found.get(name), list)]
    if missing:
        return [*wrong, f"no list: {', '.join(missing)}"]
    for number, finding in enumerate(found["findings"]):
        wrong += [f"findings[{number}]: {text}" for text in _of_finding(finding)]
    for name in ("names_90", "cannot_tell"):
        wrong += [f"{name}: {text}" for one in found[name] for text in _of_names(one)]
    suspected = found.get("suspected", [])
    wrong += [f"suspected: {text}" for text in _of_names(suspected)] if suspected else []
    wrong += [f"{name} is suspected, and found" for name in _both(found, suspected)]
    for number, advice in enumerate(found["record_next"]):
        wrong += [f"record_next[{number}]: {text}" for text in _of_advice(advice)]
    return wrong + _of_fit(found.get("fit")) + _against_itself(found)


def _both(found, suspected):
    return [one["effect"] for one in found["findings"] if isinstance(one, dict) and one.get("effect") in suspected]


def _leaves(value, path):
    """Every number and text with its path."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _leaves(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            yield from _leaves(inner, f"{path}[{number}]")
    else:
        yield path, value


def _is_not_finite(value):
    return isinstance(value, float) and not math.isfinite(value)


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _of_finding(finding):
    if not isinstance(finding, dict):
        return ["it is no object"]
    effect = finding.get("effect")
    if effect not in EFFECTS:
        return [f"there is no effect {effect!r}"]
    wrong = []
    kind = "tissue" if effect in TISSUE else "instrument"
    if finding.get("kind") != kind:
        wrong.append(f"{effect} is of kind {kind}, not {finding.get('kind')!r}")
    confidence = finding.get("confidence")
    # Null where no frequency is known; the posterior is then all that is.
    known = {"confidence": confidence} if confidence is not None or "posterior" not in finding else {}
    for name, value in (known | {key: finding[key] for key in ("posterior",) if key in finding}).items():
        if not _is_number(value) or not 0.0 <= value <= 1.0:
            wrong.append(f"{name} is {value!r}, not between 0 and 1")
    for name, number in (finding.get("parameters") or {}).items():
        wrong += [f"{name}: {text}" for text in _of_interval(number)]
        wrong += [] if isinstance(number, dict) and isinstance(number.get("unit"), str) else [f"{name} has no unit"]
    phase = (finding.get("when") or {}).get("phase")
    phases = phase if isinstance(phase, list) else [phase]
    return wrong + [f"there is no phase {one!r}" for one in phases if one is not None and one not in PHASES]


def _of_interval(number):
    """A value between its ends; ends may be absent or null."""
    if not isinstance(number, dict) or not _is_number(number.get("value", number.get("rms"))):
        return ["it has no value"]
    value = number.get("value", number.get("rms"))
    low, high = number.get("low"), number.get("high")
    slack = 1e-9 * (1.0 + abs(value))
    is_out = (_is_number(low) and low > value + slack) or (_is_number(high) and high < value - slack)
    return ["its value lies outside its interval"] if is_out else []


def _of_names(names):
    """Unknown names of a set of effects; the empty set means that nothing is missing."""
    if not isinstance(names, list):
        return [f"{names!r} is no list of names"]
    return [f"there is no effect {name!r}" for name in names if name not in EFFECTS]


def _of_advice(advice):
    wrong = []
    if not isinstance(advice, dict) or not isinstance(advice.get("text"), str) or not advice["text"].strip():
        return ["it has no text"]
    if not isinstance(advice.get("protocol"), dict):
        wrong.append("it has no protocol")
    chance, minutes = advice.get("probability"), advice.get("minutes")
    if chance is not None and not (_is_number(chance) and 0.0 <= chance <= 1.0):
        wrong.append(f"probability is {chance!r}, not between 0 and 1")
    if minutes is not None and not (_is_number(minutes) and minutes > 0.0):
        wrong.append(f"minutes is {minutes!r}, not above 0")
    return wrong


def _of_fit(fit):
    """The gain, where one is told."""
    if fit is None:
        return []
    if not isinstance(fit, dict) or not isinstance(fit.get("held_out", []), list):
        return ["fit: it is no object with a list held_out"]
    told = [(name, fit[name]) for name in ERRORS if fit.get(name) and fit[name].get("value", 0.0) is not None]
    return [f"fit.{name}: {text}" for name, value in told for text in _of_interval(value)]


def _against_itself(found):
    """A verdict and its findings must say the same."""
    verdict, kinds = found.get("verdict"), {one.get("kind") for one in found["findings"] if isinstance(one, dict)}
    if verdict in ("nothing_missing", "parameters", "insufficient_data") and kinds:
        return [f"the verdict is {verdict}, and there are findings"]
    if verdict == "missing_physics" and "tissue" not in kinds:
        return ["the verdict is missing_physics, and no finding is of kind tissue"]
    if verdict == "instrument" and kinds != {"instrument"}:
        return ["the verdict is instrument, and the findings are not all of kind instrument, or there is none"]
    if verdict == "cannot_tell" and not found["cannot_tell"]:
        return ["the verdict is cannot_tell, and no names are told that cannot be told apart"]
    return []
