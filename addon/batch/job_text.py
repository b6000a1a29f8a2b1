"""The text of a job file to a table, within bounds: size, depth, and what kind of file it is."""

import re
import tomllib

from ..scene.checks import Refusal

MOST_BYTES = 16 << 20
"""Longest job file: 100,000 cases listed one by one take 5 MB."""
MOST_PARTS = 32
"""Most parts of a dotted key: each is a table within a table, and the parser takes memory with their square."""
_QUOTED = re.compile(r"\"(?:[^\"\\\n]|\\.)*+\"|'[^'\n]*+'")
_DOTTED = re.compile(rf"(?:[\w-]++[ \t]*+\.[ \t]*+){{{MOST_PARTS}}}")


def parse(path):
    """The table of a job file. Raises `Refusal` for what is missing, no plain file, too long, too deep or no TOML."""
    try:
        if path.exists() and not path.is_file():
            raise Refusal(f"'{path}' is no file; give the job file, as jobs.toml")
        with path.open("rb") as file:
            data = file.read(MOST_BYTES + 1)
    except (OSError, ValueError):
        raise Refusal(f"there is no job file '{path}'") from None
    if len(data) > MOST_BYTES:
        raise Refusal(f"'{path}' is longer than {MOST_BYTES >> 20} MiB; split it, or use [[sweep]] for lists of values")
    try:
        text = data.decode("utf-8-sig")
        if _DOTTED.search(_QUOTED.sub("q", text)):
            raise Refusal(f"'{path}' has a key of more than {MOST_PARTS} parts; a case is a flat table")
        return tomllib.loads(text)
    except ValueError as error:  # of the parser, of the encoding, and of a number of too many digits
        raise Refusal(f"'{path}' is not TOML: {error}") from None
    except (RecursionError, MemoryError):
        raise Refusal(f"'{path}' is not a job file: its tables or lists are nested too deep") from None
