"""Findings as the library writes them (findings.json, schema 1): parsed, and refused where they are not that."""

import json
from functools import lru_cache

from ..scene.checks import Refusal

SCHEMA = 1
NAMED = {"missing_physics", "instrument"}
"""Verdicts that name something which can be switched on."""
VERDICTS = NAMED | {"nothing_missing", "parameters", "cannot_tell", "unlisted", "insufficient_data"}
_LISTS = ("findings", "names_90", "cannot_tell", "suspected", "record_next")


@lru_cache(maxsize=8)
def parse(text):
    """The findings as nested dicts and lists, which nobody may change. Raises `Refusal`."""
    try:
        found = json.loads(text)
    except ValueError as error:
        raise Refusal(f"the findings kept in this file cannot be read ({error}); press Diagnose again") from None
    problem = _problem(found)
    if problem:
        raise Refusal(f"the findings kept in this file {problem}; press Diagnose again with this version of Thenar")
    return found


def _problem(found):
    if not isinstance(found, dict) or found.get("schema") != SCHEMA:
        return f"are not of schema {SCHEMA}"
    if found.get("verdict") not in VERDICTS:
        return f"have the unknown verdict '{found.get('verdict')}'"
    if not all(isinstance(found.get(name, []), list) for name in _LISTS):
        return "have another form"
    if not all(isinstance(finding, dict) and "effect" in finding for finding in found.get("findings", [])):
        return "list one without its effect"
    return ""


def finding(found, index):
    """The finding of that number, from 0. Raises `Refusal`."""
    listed = found.get("findings", [])
    if not 0 <= index < len(listed):
        count = len(listed)
        told = "lists no finding" if count == 0 else f"lists {count}, numbered from 0"
        raise Refusal(f"there is no finding {index}; the diagnosis {told}")
    return listed[index]


def switched(found, effect):
    """Amplitude (None if none is told), numbers and choices (by name) that the findings' own model gives an effect."""
    listed = (found.get("model") or {}).get("effects") or ()
    told = dict(next((each for each in listed if each.get("name") == effect), {}))
    told.pop("name", None)
    amplitude = told.pop("amplitude", None)
    choices = {name: value for name, value in told.items() if isinstance(value, str)}
    return amplitude, {name: told[name] for name in told if name not in choices and told[name] is not None}, choices


def by_contact_model(found):
    """Share of the reducible held-out error that the contact model removes with what is named; None if not tried."""
    tried = (found.get("fit") or {}).get("by_contact_model") or {}
    return (tried.get("reducible_error_removed") or {}).get("value")


def rivals(found, effect):
    """Other effects that cannot be told apart from `effect` with these recordings."""
    alike = [names for names in found.get("cannot_tell", []) if effect in names]
    return list(dict.fromkeys(name for names in alike for name in names if name != effect))
