"""What the native module says of a press: its own sentences, unchanged, one per kind. Knows nothing of Blender."""

from collections.abc import Iterable, Sequence
from functools import cache
from typing import Any, Protocol

SAME_KIND_IS_SAME_TEXT = "note"
"""The kind of notes on meshes: two of them are alike only where they say the same."""


class Named(Protocol):
    """A press whose objects and regions have names."""

    hand_name: str
    part_names: tuple[str, ...]
    region_names: tuple[str, ...]


@cache
def region_title(name: str) -> str:
    """A region's name in words: `Index distal pad`. What is not a name in lower case and underscores stays as it is."""
    return name.replace("_", " ").capitalize() if name.isidentifier() and name.islower() else name


def titles(region_names: Iterable[str]) -> list[str]:
    """The names in words of all regions, as the native module puts them into its sentences."""
    return [region_title(name) for name in region_names]


def named(error: Exception, job: Named) -> Exception:
    """The native module's error with the objects that it is about in front of its own sentence."""
    about = " on ".join(f"'{name}'" for name in (job.hand_name, ", ".join(job.part_names)) if name)
    told = type(error)(f"{about}: {error}")
    vars(told)["vertices"] = list(getattr(error, "vertices", ()))
    return told


def remarks(contact: Any, job: Named) -> list[str]:
    """The sentences on a contact; of those of one kind the first, with the other regions that it holds for."""
    alike: dict[tuple[str, str], list[Any]] = {}
    for remark in contact.remarks:
        kind = remark.kind
        own = remark.text if kind == SAME_KIND_IS_SAME_TEXT else ""
        alike.setdefault((kind, own), []).append(remark)
    return [_with_others(group, job.region_names) for group in alike.values()]


def _with_others(group: list[Any], region_names: Sequence[str]) -> str:
    first, *others = group
    regions = (other.region for other in others)
    places = [region_title(region_names[region]) for region in regions if region is not None]
    text, listed = str(first.text), ", ".join(places)
    return f"{text} (also: {listed})" if places else text
