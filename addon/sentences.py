"""What the native module says of a press, in sentences with the objects' names. Knows nothing of Blender."""

import re
from functools import lru_cache, partial

SENTENCES_KEPT = 256
"""Notes whose wording is kept: from frame to frame most of them are the same."""
_PLACES = r"\b[Tt]he (?P<role>hand|product)\b(?! ')|\bregion (?P<region>\d+)\b"
"""Where a name belongs; names of regions that the native module already put are found first, and left as they are."""
_NUMBERS = dict.fromkeys(map(ord, "0123456789."))


def named(text, job):
    """A sentence of the native module with the objects' names: it knows them as "the hand" and "the product" only."""
    return _namer(job.hand_name, job.part_names, job.region_names)(text)


def remarks(contact, job):
    """The notes of the native module on a contact, with the objects' names, `joined`."""
    return list(joined(map(_namer(job.hand_name, job.part_names, job.region_names), contact.warnings)))


@lru_cache(maxsize=4)
def _namer(hand_name, part_names, region_names):
    """What does this for one hand and product: it remembers sentences without looking at all these names each time."""
    objects = {"hand": hand_name, "product": ", ".join(part_names)}
    by_name = "|".join(re.escape(f"'{name}'") for name in sorted(region_names, key=len, reverse=True))
    places = re.compile(rf"{by_name}|{_PLACES}" if by_name else _PLACES)
    return lru_cache(maxsize=SENTENCES_KEPT)(partial(_named, places=places, names=(objects, region_names)))


def _named(text, places, names):
    """One pass, so that a name is never looked into, whatever stands in it; each role is named once."""
    objects, regions = dict(names[0]), dict(enumerate(names[1]))

    def name(found):
        if found["region"]:
            return f"region '{regions.get(int(found['region']), found['region'])}'"
        known = objects.pop(found["role"], None) if found["role"] else None
        return found[0] if known is None else f"{found[0]} '{known}'"

    return places.sub(name, text)


def joined(notes):
    """Notes that differ by names and numbers only become one, which counts the others."""
    alike = {}
    for note in notes:
        alike.setdefault(_kind(note), []).append(note)
    for first, *others in alike.values():
        yield first + (f" ({len(others)} more such)" if others else "")


@lru_cache(maxsize=SENTENCES_KEPT)
def _kind(note):
    """The sentence without the names in quotes and without numbers."""
    parts = note.split("'")
    said = parts[::2] if len(parts) % 2 else parts[::2] + parts[-1:]
    return "#".join(said).translate(_NUMBERS)
