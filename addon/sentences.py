"""What the native module says of a press, in sentences with the objects' names. Knows nothing of Blender."""

import re
from functools import lru_cache, partial

SENTENCES_KEPT = 256
"""Notes whose wording is kept: from frame to frame most of them are the same."""
_REGION = re.compile(r"region (\d+)\b")
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
    objects = (hand_name, ", ".join(part_names))
    return lru_cache(maxsize=SENTENCES_KEPT)(partial(_named, objects=objects, region_names=region_names))


def _named(text, objects, region_names):
    for role, name in zip(("hand", "product"), objects, strict=True):
        if f"he {role}" in text:
            text = re.sub(rf"\b([Tt]he {role})\b(?! ')", rf"\1 '{name}'", text, count=1)
    if not _REGION.search(text):
        return text
    regions = dict(enumerate(region_names))
    return _REGION.sub(lambda found: f"region '{regions.get(int(found[1]), found[1])}'", text)


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
