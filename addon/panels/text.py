"""Text in panels, which do not wrap by themselves: paragraphs that fit the region, plain, faint or in alarm."""

import re
import unicodedata

from .. import languages, status
from ..languages import iface, sentences

_UNIT = re.compile(r"(?<=\d) (?=(?:%|[kM]?Pa|mm²?|cm²|s|N|min|Hz)(?:\W|$))")
"""The blank between a number and its unit, at which no line ends."""
_OPENS, _CLOSES = "「『（［〈《“", "、。，．：；？！）」』］〉》”々ー…％"
"""Letters of Chinese and Japanese after which, and before which, no line ends."""
_ICON = 3
"""Letters that an icon takes the place of."""


def width(context):
    """How many letters fit on a line of the region."""
    return max(20, int((context.region.width / context.preferences.system.ui_scale - 50) / 6.6))


def wrapped(text, letters):
    """Lines of at most so many letters; a longer word (a path) is cut, and a number stays with its unit.

    A letter of Chinese or Japanese takes the room of two, and a line may end after it.
    """
    lines = [""]
    for blank, word in _words(_UNIT.sub("\u00a0", " ".join(text.split()))):
        while room(word) > letters:
            lines, word = [*lines, word[:letters]], word[letters:]
        if lines[-1] and room(lines[-1]) + room(word) + len(blank) > letters:
            lines.append("")
        lines[-1] = f"{lines[-1]}{blank}{word}".strip(" ")
    return [line.replace("\u00a0", " ") for line in lines if line or len(lines) == 1]


def room(text):
    """How many Latin letters the text takes the room of."""
    return len(text) if text.isascii() else sum(1 + _is_wide(letter) for letter in text)


def _words(text):
    """(blank before, word) of what a line may end between: words, and letters of Chinese and Japanese."""
    if text.isascii():
        yield from ((" ", word) for word in text.split(" "))
        return
    for word in text.split(" "):
        blank, start = " ", 0
        for end in range(1, len(word) + 1):
            if end == len(word) or _may_end(word[end - 1], word[end]):
                yield blank, word[start:end]
                blank, start = "", end


def _may_end(before, after):
    """Whether a line may end between two letters of one word."""
    return (_is_wide(before) or _is_wide(after)) and before not in _OPENS and after not in _CLOSES


def _is_wide(letter):
    return unicodedata.east_asian_width(letter) in {"W", "F"}


def paragraph(layout, context, text, icon=""):
    """The text on as many lines as it needs, with a capital first, and its icon before it. Returns the column.

    A text, or a sentence of the library, that has a translation is shown in the user's language.
    """
    text = spoken(text)
    column = layout.column(align=True)
    letters = width(context) - (_ICON if icon else 0)
    for number, line in enumerate(wrapped(text[:1].upper() + text[1:], letters)):
        if icon:
            column.label(text=line, icon=icon if number == 0 else "BLANK1")
        else:
            column.label(text=line)
    return column


def spoken(text):
    """A text, or a sentence of the library, in the user's language."""
    words = iface(text)
    return words if words != text else sentences.shown(text)


def faint(layout, context, text):
    """A paragraph that stays behind what is around it."""
    paragraph(layout, context, text).active = False


def alert(layout, context, text):
    """A paragraph in red."""
    paragraph(layout, context, text, "ERROR").alert = True


def progress(layout):
    """The run that is under way, as a bar. Returns whether there is one."""
    run = status.run
    if run.stage:
        stage = languages.stage(run.stage)
        stage = stage[:1].upper() + stage[1:]
        text = iface("{stage} {fraction:.0%} · Esc cancels", stage=stage, fraction=run.fraction)
        layout.progress(factor=run.fraction, text=text)
    return bool(run.stage)
