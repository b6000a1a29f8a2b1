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
_QUOTED = re.compile(r"('[^']*')")
_OWN_NAME = re.compile(r"(?<!region )'\{(\w+)\}'")
"""A field in quotes is what an object, a modifier or a file is called in the scene, and stays; of regions Thenar shows
translated titles everywhere."""
_ONE_WORD = {"lower"}
"""Fields that hold one word: a template of little more than these would fit any sentence."""


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
            words, own = kept(template), set(_OWN_NAME.findall(template))
            fields = {name: value if name in own else _part(value) for name, value in found.groupdict().items()}
            return text if words == template else words.format(**fields)
    return text


def _part(value):
    """What a field holds: a sentence of its own, names from a list, or what stays as it is, as names in quotes do."""
    words = shown(value)
    return words if words != value else "".join(map(_names, _QUOTED.split(value)))


def _names(words):
    return words if not words or words[0] == "'" else "".join(map(_name, filter(None, _BETWEEN.split(words))))


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
    fields = [_field(part) if place % 2 else re.escape(part) for place, part in enumerate(parts)]
    return re.compile("".join(fields))


def _field(name):
    return rf"(?P<{name}>[^\s,;:]+)" if name in _ONE_WORD else f"(?P<{name}>.+?)"
