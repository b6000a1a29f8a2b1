"""Fields of a preset against the properties they set: every value is checked before any is written."""

from dataclasses import dataclass
from math import isfinite

from ..scene.checks import Refusal


@dataclass(frozen=True)
class Place:
    """Where in a file a value is: the file's name and the keys down to it."""

    file: str
    keys: tuple = ()

    def at(self, key):
        """The place of a value within."""
        return Place(self.file, (*self.keys, key))

    def refuse(self, problem, remedy):
        """Raise a `Refusal` that names the place."""
        raise Refusal(f"'{self.file}', {'.'.join(map(str, self.keys))}: {problem}; {remedy}")


def read(owner, names):
    """Values of properties of `owner` as a preset holds them; `names`: key in the file -> property."""
    return {key: _plain(getattr(owner, prop)) for key, prop in names.items()}


def check(content, owner, names, place):
    """The values of a part of a file by property, each within the limits of its property of `owner`.

    Raises `Refusal` for what is missing, unknown, of another type or out of its limits.
    """
    group = mapping(content, place)
    unknown = next((key for key in group if key not in names), None)
    if unknown is not None:
        place.at(unknown).refuse("is not known here", f"known are {', '.join(names)}")
    out = {}
    for key, prop in names.items():
        if key not in group:
            place.at(key).refuse("is missing", "add it, or save the preset again")
        out[prop] = _value(group[key], owner.bl_rna.properties[prop], place.at(key))
    return out


def mapping(content, place):
    """`content` if it is a group of keys; else a `Refusal`."""
    if not isinstance(content, dict):
        place.refuse("is no group of values", "write { ... }, or save the preset again")
    return content


def number(value, low, high, place):
    """A number within its limits; else a `Refusal`."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        place.refuse(f"{_short(value)} is no number", "write a number")
    if not low * (1 - 1e-6) - 1e-12 <= value <= high * (1 + 1e-6) + 1e-12:
        place.refuse(f"{value:g} is not between {low:g} and {high:g}", "write a number within")
    return float(value)


def choice(value, known, place):
    """One of the words `known`; else a `Refusal`."""
    if value not in known:
        place.refuse(f"{_short(value)} is not known", f"write one of {', '.join(known)}")
    return value


def _value(value, prop, place):
    if prop.type == "BOOLEAN":
        if not isinstance(value, bool):
            place.refuse(f"{_short(value)} is neither true nor false", "write one of them")
        return value
    if prop.type == "ENUM":
        return choice(value, [item.identifier for item in prop.enum_items], place)
    return number(value, prop.hard_min, prop.hard_max, place)


def _plain(value):
    """Six digits of Blender's single precision."""
    return float(f"{value:.6g}") if isinstance(value, float) else value


def _short(value):
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
