"""Reads and writes tables of translations as PO files (GNU gettext). Knows nothing of Blender."""

import re

_LINE = re.compile(r'(msgctxt|msgid|msgstr)?\s*("(?:[^"\\]|\\.)*")$')
_ESCAPES = {"n": "\n", "t": "\t", '"': '"', "\\": "\\"}


class PoError(ValueError):
    """A line that is no entry of a PO file; the message names file, line and what is wrong."""


def read(path):
    """The table at `path`: (context, English) -> translation; no context is "". The head (English "") is left out.

    Raises `PoError` for a line that cannot be read, an entry without translation line, and an entry given twice.
    """
    out, entry, field = {}, {}, ""
    for number, line in enumerate(path.read_text("utf-8").splitlines(), 1):
        line = line.strip()
        if not line or line.startswith("#"):
            continue
        match = _LINE.match(line)
        if match is None or not (match[1] or field):
            raise PoError(f'{path.name}, line {number}: not a line of a PO file; write msgid "...", msgstr "..."')
        if match[1] in {"msgctxt", "msgid"} and "msgstr" in entry:
            _keep(out, entry, f"{path.name}, line {number}")
            entry = {}
        field = match[1] or field
        if match[1] in entry:
            raise PoError(f"{path.name}, line {number}: a second {field} before the entry has ended")
        entry[field] = entry.get(field, "") + _plain(match[2][1:-1])
    if entry:
        _keep(out, entry, f"{path.name}, last line")
    return out


def write(path, head, entries):
    """Write `head` (lines of comment) and `entries` as `read` returns them to `path`, in their order."""
    out = [f"# {line}".rstrip() for line in head]
    out += ['msgid ""', 'msgstr "Content-Type: text/plain; charset=UTF-8\\n"']
    for (context, english), text in entries.items():
        out += ["", *lines(context, english, text)]
    path.write_text("\n".join(out) + "\n", "utf-8")


def lines(context, english, text):
    """The lines of one entry."""
    own = [f"msgctxt {_quoted(context)}"] if context else []
    return [*own, f"msgid {_quoted(english)}", f"msgstr {_quoted(text)}"]


def _keep(out, entry, place):
    if set(entry) - {"msgctxt"} != {"msgid", "msgstr"}:
        raise PoError(f"{place}: an entry before it has no msgid or no msgstr; give both")
    key = (entry.get("msgctxt", ""), entry["msgid"])
    if key in out:
        raise PoError(f"{place}: {entry['msgid']!r} is given twice; keep one entry")
    if entry["msgid"]:
        out[key] = entry["msgstr"]


def _plain(text):
    return re.sub(r"\\(.)", lambda match: _ESCAPES.get(match[1], match[1]), text)


def _quoted(text):
    for letter, escaped in (("\\", "\\\\"), ('"', '\\"'), ("\n", "\\n"), ("\t", "\\t")):
        text = text.replace(letter, escaped)
    return f'"{text}"'
