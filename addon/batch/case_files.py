"""Names of a case's files: from any name, one each, never outside the folder, never cut at a dot."""

import hashlib
import re
import unicodedata
from collections import Counter

LONGEST = 120
"""Most bytes of a name in UTF-8: file systems take 255, and a partial file's name is longer than its own."""
_OURS = {"results", "summary", "sheet"}
"""Files of the whole batch."""
_DEVICES = {"con", "prn", "aux", "nul", *(f"{port}{number}" for port in ("com", "lpt") for number in range(10))}
"""Names that Windows keeps for itself, whatever follows behind a dot."""
_DIGITS = (8, 16, 32)


def stem(name):
    """The file name for `name`, without a suffix. Spaces and signs become `_`; what changes further gets a digest."""
    plain = re.sub(r"[^\w.+-]", "_", unicodedata.normalize("NFC", name))
    kept = _cut(plain.strip("."))
    if kept.partition(".")[0].casefold() in _DEVICES:
        kept = f"_{kept}"
    if not kept or kept != plain or kept.casefold() in _OURS:
        return marked(kept, name, _DIGITS[0])
    return kept


def marked(kept, name, digits):
    """A file name that a digest of the case's own `name` sets apart."""
    digest = hashlib.blake2b(name.encode("utf-8", "surrogatepass"), digest_size=16).hexdigest()
    return f"{kept or 'case'}-{digest[:digits]}"


def stems(wanted):
    """File names for (wanted file name, case's name), none like another even where a file system ignores the case."""
    plain = [stem(text) for text, _ in wanted]
    found = list(plain)
    for digits in _DIGITS:
        count = Counter(each.casefold() for each in found)
        if len(count) == len(found):
            break
        found = [
            each if count[each.casefold()] == 1 else marked(base, name, digits)
            for each, base, (_, name) in zip(found, plain, wanted, strict=True)
        ]
    return found


def file_of(path, suffix):
    """The file of a case at `path`, which has no suffix: dots of its name are part of the name."""
    return path.with_name(path.name + suffix)


def _cut(text):
    return text.encode("utf-8", "replace")[:LONGEST].decode("utf-8", "ignore")
