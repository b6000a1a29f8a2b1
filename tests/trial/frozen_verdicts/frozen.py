"""Verdicts held by name, never by number, so that the diagnosis may be moved about: `frozen.json`, and how it is read.

As the hashes of `rust/contact/tests/frozen` they say that nothing changed, not that it is right: that is for the table
of `cargo xtask prove`. A commit that means to change verdicts rewrites them and says so in its message:

    THENAR_FREEZE=1 python -m pytest tests/trial/frozen_verdicts/test_frozen_verdicts.py  # held cases; more with
    THENAR_FREEZE="case_001 case_002" ...
"""

import functools
import json
import os
import tempfile
from pathlib import Path

import thenar
from trial import cases

TABLE = Path(__file__).with_name("frozen.json")


@functools.cache
def said(case):
    """What `thenar.diagnose` says of a case; asked once in a process. Not to be changed."""
    with tempfile.TemporaryDirectory() as folder:
        cases.write(case, Path(folder))
        return json.loads(thenar.diagnose(thenar.Study.load(folder)).to_json())


def names(verdict):
    """What is held of a verdict."""
    return {
        "verdict": verdict["verdict"],
        "findings": [one["effect"] for one in verdict["findings"]],
        "cannot_tell": verdict["cannot_tell"],
    }


def table():
    return json.loads(TABLE.read_text())


def write(found):
    lines = [f'  "{case}": {json.dumps(found[case])}' for case in sorted(found)]
    TABLE.write_text("{\n" + ",\n".join(lines) + "\n}\n")


def asked():
    """Cases to freeze anew; None unless THENAR_FREEZE is set."""
    wanted = os.environ.get("THENAR_FREEZE")
    if not wanted:
        return None
    more = set(wanted.split()) & set(cases.index())
    return sorted({*table(), *more})
