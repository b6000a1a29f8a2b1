"""Sentences that are kept in English, of the library and of notes, as the user's language has them.

A result, a file and an export hold one English sentence. A panel shows it by the template it was written with: the
tables hold these templates with the context `SENTENCE`, in which each `{field}` stands for any words.
"""

import functools
import re

from . import LANGUAGES, SENTENCE, iface, kept, table

_FIELD = re.compile(r"\{(\w+)\}")
_BETWEEN = re.compile(r"(, | and )")
_SIZED = re.compile(r"(.*\D) (\d[\d.]* \S+)")
"""A name with a number and its unit behind it."""


def shown(text):
    """The sentence in the user's language; as it is where no template fits or the language is English."""
    small = text[:1].lower() + text[1:]  # a capital may have been put there since
    for each in dict.fromkeys((text, small)):
        words = _translated(each)
        if words != each:
            return words
    return text


def _translated(text):
    for pattern, template in _patterns():
        found = pattern.fullmatch(text)
        if found is not None:
            words = kept(template)
            fields = {name: _part(value) for name, value in found.groupdict().items()}
            return text if words == template else words.format(**fields)
    return text


def _part(value):
    """What a field holds: a sentence of its own, names from a list, or what stays as it is."""
    words = shown(value)
    return words if words != value else "".join(map(_name, _BETWEEN.split(value)))


def _name(word):
    sized = _SIZED.fullmatch(word)
    if sized is not None:
        return f"{_name(sized[1])} {sized[2]}"
    for each in (word, word[:1].upper() + word[1:]):
        if iface(each) != each:
            return iface(each)
    return kept(word)


@functools.cache
def _patterns():
    """(pattern, template), those with the most fixed letters first."""
    templates = {english for name in LANGUAGES for context, english in table(name) if context == SENTENCE}
    return [(_pattern(template), template) for template in sorted(templates, key=_fixed)]


def _fixed(template):
    return -len(_FIELD.sub("", template)), template


def _pattern(template):
    parts = _FIELD.split(template)
    fields = [f"(?P<{part}>.+?)" if place % 2 else re.escape(part) for place, part in enumerate(parts)]
    return re.compile("".join(fields))
