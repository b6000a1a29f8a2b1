"""The tables of translations against the strings of the interface: what is missing, left over, or has other fields."""

import re
import string

from thenar_blender import languages
from thenar_blender.languages import po

PERCENT = re.compile(r"%(?:\.\d+)?[sdfg]\b")


def entries(name):
    """The table of that name as it stands in its file: (own context or "", English) -> translation."""
    return po.read(languages.FOLDER / f"{name}.po")


def place(entry):
    """Where an entry stands in its file: by its English, in the alphabet's order."""
    (context, english), _ = entry
    return english.lower(), english, context


def compared(wanted, table):
    """(missing, unused): entries to add, (context, English) -> where it stands, and keys of `table` that nothing needs.

    `wanted`: (context, English) -> where. An entry without context serves every context that has none of its own.
    """
    missing, used = {}, set()
    for (context, english), where in wanted.items():
        key = (context, english) if (context, english) in table else ("", english)
        used.add(key)
        if not table.get(key):
            missing.setdefault((context if context == languages.SENTENCE else "", english), where)
    return missing, [key for key in table if key not in used]


def fields(text):
    """What a text fills in, sorted: `{name:format}` and `%d`; None where its braces do not close."""
    try:
        braces = [f"{{{name}:{form}}}" for _, name, form, _ in string.Formatter().parse(text) if name is not None]
    except ValueError:
        return None
    return sorted([*braces, *PERCENT.findall(text)])


def changed_fields(table):
    """Entries whose translation fills in something else than the English."""
    return [(key, text) for key, text in table.items() if text and fields(key[1]) != fields(text)]
