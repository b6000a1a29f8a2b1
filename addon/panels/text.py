"""Text in panels, which do not wrap by themselves: paragraphs that fit the region, plain, faint or in alarm."""

import re

from .. import status

_UNIT = re.compile(r"(?<=\d) (?=(?:%|[kM]?Pa|mm²?|cm²|s|N|min|Hz)(?:\W|$))")
"""The blank between a number and its unit, at which no line ends."""
_ICON = 3
"""Letters that an icon takes the place of."""


def width(context):
    """How many letters fit on a line of the region."""
    return max(20, int((context.region.width / context.preferences.system.ui_scale - 50) / 6.6))


def wrapped(text, letters):
    """Lines of at most so many letters; a longer word (a path) is cut, and a number stays with its unit."""
    lines = [""]
    for word in _UNIT.sub("\u00a0", " ".join(text.split())).split(" "):
        while len(word) > letters:
            lines, word = [*lines, word[:letters]], word[letters:]
        if lines[-1] and len(lines[-1]) + len(word) + 1 > letters:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip(" ")
    return [line.replace("\u00a0", " ") for line in lines if line or len(lines) == 1]


def paragraph(layout, context, text, icon=""):
    """The text on as many lines as it needs, with a capital first, and its icon before it. Returns the column."""
    column = layout.column(align=True)
    letters = width(context) - (_ICON if icon else 0)
    for number, line in enumerate(wrapped(text[:1].upper() + text[1:], letters)):
        if icon:
            column.label(text=line, icon=icon if number == 0 else "BLANK1")
        else:
            column.label(text=line)
    return column


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
        text = f"{run.stage[:1].upper()}{run.stage[1:]} {run.fraction:.0%} · Esc cancels"
        layout.progress(factor=run.fraction, text=text)
    return bool(run.stage)
