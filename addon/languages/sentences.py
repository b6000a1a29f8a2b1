"""Sentences that are kept or raised in English, of the library and of Thenar, as the user's language has them.

A result, a file and an error hold one English sentence. A panel and a report show it by the template it was written
with: the tables hold these templates with the context `SENTENCE`, in which each `{field}` stands for any words. A
sentence may be put together of several: `file: problem; remedy`.
"""

import functools
import re
from dataclasses import dataclass

from . import LANGUAGES, SENTENCE, file_words, iface, kept, table

JOINTS = {"; ": "{first}; {second}", ". ": "{first} {second}", ".": "{first}."}
"""How two sentences follow one another, and how one ends, as templates of their own; `: ` is the same everywhere."""
NAME_JOINTS = {" and ": "{first} and {second}", " from ": "{first} from {second}", ", nor ": "{first}, nor {second}"}
"""How names follow one another."""
_PUT_TOGETHER = {*JOINTS.values(), *NAME_JOINTS.values()}
_PROBE = "no hand is chosen; pick the hand's mesh under Hand"
"""A template whose translations are different in all languages."""
_FIELD = re.compile(r"\{(\w+)\}")
_BETWEEN = re.compile(r"(, nor |, | and | from )")
_SIZED = re.compile(r"(.*\D) (\d[\d.]* \S+)")
"""A name with a number and its unit behind it."""
_QUOTED = re.compile(r"('[^']*')")
_IN_QUOTES = re.compile(r"(?<!\w)'[^']*'(?!\w)|“[^”]*”")
_JOINT = re.compile(r"""(?<=[^\s:;]); |: |(?<=[\w)%”'])\. (?=['"“]?[A-Z0-9])""")
_OWN_NAME = re.compile(r"""(?:(?<!region )['"]|(?<=In )“|(?<=handprint )“)\{(\w+)\}['"”]""")
"""A field in quotes is what an object, a modifier or a file is called in the scene, and stays; of regions Thenar shows
translated titles everywhere."""
_ONE_WORD = {"lower", "key", "line", "row", "byte", "frame"}
"""Fields that hold one word: a template of little more than these would fit any sentence."""
_INNER = str.maketrans(" ", "\ue000")
"""A blank inside quotes while a template is looked for: what stands there is one word."""


_FEW_LETTERS, _FEW_WORDS = 16, 4
"""A template of so few letters, as `region {name}`, is taken for a sentence only if its fields hold so few words."""
_MOST_SEAMS = 60
"""A text of more is another program's report, and would hold up the window; 40 took 0.4 s on one core."""


@dataclass(frozen=True)
class _Template:
    """A template, the fixed `pieces` of it in order, and the pattern of its sentences."""

    text: str
    pieces: tuple
    pattern: re.Pattern

    @property
    def letters(self):
        """How many letters are fixed."""
        return sum(map(len, self.pieces))

    def found(self, sentence):
        """The values of the fields if the sentence was written by it, or None."""
        at = 0
        for piece in self.pieces:
            at = sentence.find(piece, at)
            if at < 0:
                return None
            at += len(piece)
        match = self.pattern.fullmatch(sentence)
        return None if match is None else {name: _plain(value) for name, value in match.groupdict().items()}

    @property
    def as_written(self):
        """Fields that hold a name of the scene or words of a file, which stay as they are."""
        if self.text in file_words.TEMPLATES:
            return {*_FIELD.findall(self.text)}
        return {*_OWN_NAME.findall(self.text), *file_words.FIELDS}


def shown(text):
    """The sentence in the user's language; as it is where no template fits or the language is English."""
    language = kept(_PROBE)
    return text if language == _PROBE or not text else _shown(text, language)


@functools.lru_cache(maxsize=16384)
def _shown(text, _language):
    for look in (_alone, _joined, _around, _partly):
        words = look(text)
        if words is not None:
            return words
    return text


def _alone(text):
    """By one template, no field of which holds more than belongs there; None where there is none."""
    return _translated(text, _is_short)


def _around(text):
    """By one template, whatever its fields hold."""
    return _translated(text, lambda template, value: True)


def _joined(text):
    """Put together of sentences that all have a template or hold no words; None where one has none."""
    return _parts_of(text, is_partial=False)


def _partly(text):
    """The same, with what has no template as it stands."""
    return _parts_of(text, is_partial=True)


def _translated(text, fits):
    one = _as_words(text)
    small, large = one[:1].lower() + one[1:], one[:1].upper() + one[1:]  # it may have been changed since
    for template in _templates():
        for each in dict.fromkeys((one, small, large)):
            fields = template.found(each)
            if fields is None:
                continue
            names, own = {*_OWN_NAME.findall(template.text)}, template.as_written
            if all(name in names or fits(template, value) for name, value in fields.items()):
                filled = {name: value if name in own else _part(value) for name, value in fields.items()}
                return kept(template.text).format(**filled)
    if text.endswith(".") and not text.endswith(".."):
        words = _translated(text[:-1], fits)
        return None if words is None else kept(JOINTS["."]).format(first=words)
    return None


def _is_short(template, value):
    """Whether a field holds no seam between sentences, and of a template of few letters no sentence at all."""
    plain = _IN_QUOTES.sub("X", value)
    is_one = _JOINT.search(plain) is None and not plain.startswith(". ")
    if template.text in file_words.TEMPLATES:  # a list of any length
        return is_one
    return is_one and (len(plain.split()) <= _FEW_WORDS or template.letters > _FEW_LETTERS)


def _parts_of(text, is_partial):
    seams = _seams(text)
    if len(seams) > _MOST_SEAMS:
        return None
    starts, ends = [0, *(end for _, end in seams)], [*(start for start, _ in seams), len(text)]
    out, at, known = "", 0, 0
    while at < len(starts) and seams:
        for last in range(min(len(ends), at + _most_parts()) - 1, at - 1, -1):
            part = text[starts[at] : ends[last]]
            words = None if len(part) == len(text) else _alone(part)
            if words is not None:
                known += 1
                break
            if last == at:
                words = _part_of_names(part)
                if not is_partial and not _is_of_names(part):
                    return None
        out = _seamed(out, text[ends[at - 1] : starts[at]], words) if at else words
        at = last + 1
    return out if known else None


@functools.cache
def _most_parts():
    """The most sentences that one template joins; its fields hold none, so that no more need be tried."""
    return 2 + max(len(_JOINT.findall(template.text)) for template in _templates())


def _seams(text):
    """(start, end) of each seam between sentences outside quotes; a full stop stays with its sentence."""
    spans = [found.span() for found in _IN_QUOTES.finditer(text)]
    found = [seam.span() for seam in _JOINT.finditer(text)]
    outside = [(a, b) for a, b in found if not any(start < a < end for start, end in spans)]
    return [(a + (text[a] == "."), b) for a, b in outside]


def _seamed(first, seam, second):
    joint = JOINTS["; "] if seam == "; " else JOINTS[". "] if seam == " " else None
    return first + seam + second if joint is None else kept(joint).format(first=first, second=second)


def _part(value):
    """What a field holds: a sentence of its own, names from a list, or what stays as it is, as names in quotes do."""
    for inner in dict.fromkeys((value.strip(" ,;."), value.strip())):
        words = shown(inner)
        if words != inner:
            return value.replace(inner, words)
    return _part_of_names(value)


def _part_of_names(value):
    words = "".join(map(_names, _QUOTED.split(value)))
    for joint, template in NAME_JOINTS.items() if words != value else ():
        first, *others = words.split(joint)
        for second in others:
            first = kept(template).format(first=first, second=second)
        words = first
    return words


def _is_of_names(value):
    """Whether all of it that is not in quotes is names with a translation, or no words."""
    words = _BETWEEN.split(_IN_QUOTES.sub("", value))[::2]
    return all(not re.search(r"[a-z]{2}", word) or _name(word) != word for word in words)


def _names(words):
    if not words or words[0] == "'":
        return words
    parts, out = _BETWEEN.split(words), []
    while parts:
        for last in range(len(parts), 0, -2):  # a name may hold what stands between names
            name = "".join(parts[:last])
            if _name(name) != name or last <= 2:
                break
        out += [_name(name), *parts[last : last + 1]]
        parts = parts[last + 1 :]
    return "".join(out)


def _name(word):
    sized = _SIZED.fullmatch(word)
    if sized is not None:
        return f"{_name(sized[1])} {sized[2]}"
    for each in (word, word[:1].upper() + word[1:]):
        for look in (iface, kept):
            if look(each) != each:
                return look(each)
    return (_alone(word) if "“" in word else None) or word


@functools.cache
def _templates():
    """All of them, those with the most fixed letters first."""
    held = {english for name in LANGUAGES for context, english in table(name) if context == SENTENCE}
    return [_template(text) for text in sorted(held - _PUT_TOGETHER, key=_fixed)]


def _fixed(template):
    return -len(_FIELD.sub("", template)), template


def _as_words(text):
    """With no blank inside quotes."""
    return _IN_QUOTES.sub(lambda found: found[0].translate(_INNER), text)


def _plain(words):
    return words.replace("\ue000", " ")


def _template(text):
    parts = _FIELD.split(_as_words(text))
    fields = [_field(parts, place) if place % 2 else re.escape(parts[place]) for place in range(len(parts))]
    return _Template(text, tuple(filter(None, parts[::2])), re.compile("".join(fields)))


def _field(parts, place):
    name = parts[place]
    if name in parts[1:place:2]:
        return f"(?P={name})"
    if name == "number":
        return rf"(?P<{name}>[^\s,;:]*\d[^\s,;:]*)"
    if name in _ONE_WORD:
        return rf"(?P<{name}>[^\s,;:]+)"
    before = parts[place - 1]
    if before.endswith("“"):
        return f"(?P<{name}>[^“”]*)"
    if place > 1 and not before:  # what follows a field directly is an addition, or nothing
        return rf"(?P<{name}>(?:(?:[,;:.] | and | \().*?)?)"
    return f"(?P<{name}>.*?)" if before and before[-1] != " " else f"(?P<{name}>.+?)"
