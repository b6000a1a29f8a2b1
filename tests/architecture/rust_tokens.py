"""Splits Rust into tokens, without comments, the insides of strings, and code under `#[cfg(test)]`."""

import functools
import re

_TOKEN = re.compile(
    r"""
    (?P<blank>\s+|//[^\n]*)
  | (?P<block>/\*)
  | (?P<raw>b?r(?P<hashes>\#*)")
  | (?P<string>b?"(?:\\.|[^"\\])*")
  | (?P<char>b?'(?:\\(?:u\{[0-9a-fA-F_]+\}|x..|.)|[^'\\\n])')
  | (?P<lifetime>'[A-Za-z_]\w*)
  | (?P<word>(?:r\#)?[A-Za-z_]\w*)
  | (?P<number>\d\w*(?:\.\d\w*)?)
  | (?P<mark>::|->|=>|\.\.=|\.\.|.)
    """,
    re.VERBOSE | re.DOTALL,
)
_OPEN = {"(": ")", "[": "]", "{": "}"}
_CLOSE = set(_OPEN.values())


@functools.cache
def tokens(text):
    """The tokens of `text` in order; a string becomes `""`, a character `''`. Not to be changed: it is kept."""
    found, at = [], 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        at = match.end()
        if match["block"]:
            at = _after_block(text, at)
        elif match["raw"] is not None:
            at = text.index('"' + match["hashes"], at) + 1 + len(match["hashes"])
            found.append('""')
        elif match["string"]:
            found.append('""')
        elif match["char"]:
            found.append("''")
        elif not match["blank"]:
            found.append(match.group())
    return found


def without_tests(found):
    """The tokens without each item that stands under `#[cfg(test)]`, and the names of the file modules among them."""
    kept, left_out, at = [], [], 0
    while at < len(found):
        if found[at : at + 7] == ["#", "[", "cfg", "(", "test", ")", "]"]:
            end = _after_item(found, at + 7)
            item = found[at + 7 : end]
            if "mod" in item and item[-1] == ";":
                left_out.append(item[item.index("mod") + 1])
            at = end
        else:
            kept.append(found[at])
            at += 1
    return kept, left_out


def closing(found, start):
    """Where the bracket that opens at `start` closes."""
    depth = 0
    for at in range(start, len(found)):
        if found[at] in _OPEN:
            depth += 1
        elif found[at] in _CLOSE:
            depth -= 1
            if depth == 0:
                return at
    return len(found) - 1


def _after_item(found, at):
    """Behind the item that begins at `at`: its further attributes, then up to `;` or its closing brace."""
    while at < len(found):
        if found[at] == ";":
            return at + 1
        if found[at] in _OPEN:
            end = closing(found, at)
            if found[at] == "{":
                return end + 1
            at = end
        at += 1
    return at


def _after_block(text, at):
    depth = 1
    while depth and at < len(text):
        step = re.compile(r"/\*|\*/").search(text, at)
        if not step:
            return len(text)
        depth += 1 if step.group() == "/*" else -1
        at = step.end()
    return at
