"""addon/docs/troubleshooting.md: every message that heads an entry is one that the code still says."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCUMENT = ROOT / "addon/docs/troubleshooting.md"
PLACEHOLDER = "…"
LEAST = 6
"""Letters of a fragment that is looked for; shorter ones occur anywhere."""


@cache
def spoken():
    """What the sources say: the texts of Python with a placeholder for each value, and of Rust as written."""
    parts = []
    for path in sorted((ROOT / "addon").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                parts.append(node.value)
            elif isinstance(node, ast.JoinedStr):
                pieces = [v.value if isinstance(v, ast.Constant) else PLACEHOLDER for v in node.values]
                parts.append("".join(str(piece) for piece in pieces))
    for path in sorted((ROOT / "rust").rglob("src/**/*.rs")):
        text = re.sub(r"\\\n\s*", "", path.read_text()).replace('\\"', '"')
        parts += re.findall(r'"((?:[^"\\]|\\.)*)"', text)
    return "\n".join(re.sub(r"\{[^{}]*\}", PLACEHOLDER, part) for part in parts)


def headings(text):
    """The messages of a document."""
    return re.findall(r"^### (.+)$", text, re.M)


def missing(message):
    """Fragments of a message between its placeholders that nothing says."""
    fragments = [part.strip() for part in message.split(PLACEHOLDER)]
    return [part for part in fragments if len(part) >= LEAST and part not in spoken()]


@pytest.mark.parametrize("message", headings(DOCUMENT.read_text()))
def test_the_message_is_still_said(message):
    assert missing(message) == []


def test_a_message_that_nobody_says_is_found():
    assert missing("no hand is chosen; pick the hand's foot under Hand")


def test_about_thirty_messages_are_listed():
    assert len(headings(DOCUMENT.read_text())) >= 30
