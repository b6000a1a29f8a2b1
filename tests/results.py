"""RESULTS.md files: figures with date, commit and machine, written by the commands that measured them.

    python tests/results.py              # every row: when it was measured, by which command
    python tests/results.py run WORDS    # runs the commands of the rows that hold all WORDS, and keeps what they say

A table row is replaced by the program that measures it (`record`). What a command prints is kept in a block of its own
(`write_block`), with its verdict. Nothing is written unless THENAR_RESULTS is 1: `run`, `cargo xtask bench` and
`cargo xtask prove` set it, so that a test in CI changes no file.
"""

import datetime
import os
import platform
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

TESTS = Path(__file__).parent
PARTS = ("proof", "bench", "trial")
ASKED = "THENAR_RESULTS"
HEAD = "| what | wanted | measured | when, version | command |"
_NOISE = re.compile(
    r"^(running \d|test |test result|\s*(Compiling|Finished|Running|Doc-tests|Blocking)\b|[=.sx]+(\s*\[|$)|\d+ passed)"
)
_LONGEST_BLOCK = 60


@dataclass(frozen=True)
class Figure:
    """A row: `measured` is text, `is_met` whether it is what was wanted (None: nothing is asked)."""

    what: str
    wanted: str
    measured: str
    is_met: bool | None = None

    def cells(self, command):
        """The row's cells, stamped with now, this commit and this machine."""
        verdict = ": **not met**" if self.is_met is False else ""
        return [_cell(text) for text in (self.what, self.wanted, self.measured + verdict, stamp(), f"`{command}`")]


def is_asked():
    """Whether figures are to be written."""
    return os.environ.get(ASKED) == "1"


def record(part, command, figures, tests=TESTS):
    """Put these figures into the part's table: a row of the same name is replaced, a new one is added at the end."""
    if not is_asked() and tests == TESTS:
        return
    path = tests / part / "RESULTS.md"
    lines = path.read_text().splitlines()
    for figure in figures:
        cells = figure.cells(command)
        row = "| " + " | ".join(cells) + " |"
        at = next((k for k, line in enumerate(lines) if _cells(line)[:1] == cells[:1]), None)
        if at is not None:
            lines[at] = row
        else:
            lines.insert(max(k for k, line in enumerate(lines) if _is_row(_cells(line))) + 1, row)
    path.write_text("\n".join(lines) + "\n")


def write_block(part, title, printed, tests=TESTS):
    """Keep what a command printed under the heading `title`, in place of what stood there."""
    if not is_asked() and tests == TESTS:
        return
    path = tests / part / "RESULTS.md"
    text = path.read_text()
    block = f"### {title}\n\n{stamp()}\n\n```text\n{printed.rstrip()}\n```\n"
    old = re.compile(rf"^### {re.escape(title)}\n.*?^```text\n.*?^```\n", re.M | re.S)
    if old.search(text):
        path.write_text(old.sub(lambda _: block, text))
    else:
        path.write_text(f"{text.rstrip()}\n\n{block}")


def rows(part, tests=TESTS):
    """The table rows of a part: lists of five cells."""
    listed = [_cells(line) for line in (tests / part / "RESULTS.md").read_text().splitlines()]
    return [cells for cells in listed if _is_row(cells)]


def stamp():
    """Date, commit and machine of a figure that is measured now."""
    return f"{datetime.date.today()}, {commit()}, {machine()}"


def commit():
    """The commit that is checked out; "and changes" where files other than results differ from it."""
    run = lambda *words: subprocess.run(["git", *words], cwd=TESTS, capture_output=True, text=True).stdout  # noqa: E731
    short = run("rev-parse", "--short", "HEAD").strip() or "no repository"
    changed = [line for line in run("status", "--porcelain").splitlines() if not line.endswith("RESULTS.md")]
    return f"{short} and changes" if changed else short


def machine():
    """Processor and number of cores."""
    try:
        named = re.search(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(), re.M)
    except OSError:
        named = None
    return f"{named[1] if named else platform.machine()}, {os.cpu_count()} cores"


def run(words):
    """Run each command once whose row holds all words; a block for each. Returns how many failed."""
    failed, seen = 0, set()
    for part in PARTS:
        for cells in rows(part):
            command = cells[4].strip("`")
            if command in seen or not all(word.lower() in " ".join(cells).lower() for word in words):
                continue
            seen.add(command)
            code, printed = _printed(command)
            failed += code != 0
            verdict = "passed" if code == 0 else f"FAILED, exit code {code}"
            write_block(part, command, f"{verdict}\n{printed}")
            print(f"{verdict}: {command}", flush=True)
    if not seen:
        print("no row holds all of:", *words)
    return failed


def _printed(command):
    """Exit code and what the command prints of figures, without the test runners' own lines."""
    words = shlex.split(command)
    environment = dict(os.environ, **{ASKED: "1"})
    path = environment.get("PYTHONPATH")
    while re.fullmatch(r"[A-Z_]+=.*", words[0]):
        name, _, value = words.pop(0).partition("=")
        environment[name] = os.pathsep.join([value, path]) if name == "PYTHONPATH" and path else value
    words = _shown(words)
    done = subprocess.run(words, cwd=TESTS.parent, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    lines = done.stdout.decode(errors="replace").splitlines()
    told = [line for line in (line.lstrip(".") for line in lines) if line.strip() and not _NOISE.match(line)]
    return done.returncode, "\n".join(told[-_LONGEST_BLOCK:])


def _shown(words):
    """The command as it is run: this Python where a bare one is named, and the tests' own output in view."""
    if words[0] == "pytest":
        return [sys.executable, "-m", "pytest", "-q", "-s", *words[1:]]
    if words[:2] == ["cargo", "test"]:
        return [*words, *([] if "--" in words else ["--"]), "--nocapture"]
    if words[0] in ("python", "target/venv/bin/python"):
        return [sys.executable, *words[1:]]
    return words


def _is_row(cells):
    return len(cells) == 5 and cells[4].startswith("`")


def _cell(text):
    return " ".join(text.replace("|", "/").split())


def _cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split(" | ")] if line.startswith("| ") else []


def main(arguments):
    """The command line. Returns the exit code."""
    if arguments[:1] == ["run"] and len(arguments) > 1:
        os.environ[ASKED] = "1"
        return int(run(arguments[1:]) > 0)
    if arguments:
        print(__doc__)
        return 2
    for part in PARTS:
        for what, _, measured, when, command in rows(part):
            print(f"{part}: {what}\n    {measured}\n    {when}; {command}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
