"""The extension's preferences: what is loaded, or why it is not."""

import re

import bpy

from .. import names, status

_UNIT = re.compile(r"(?<=\d) (?=(?:%|[kM]?Pa|mm²?|cm²|s|N|min|Hz)(?:\W|$))")
"""The blank between a number and its unit, at which no line ends."""


class ThenarPreferences(bpy.types.AddonPreferences):
    """State of the native module, for support."""

    bl_idname = __package__.rpartition(".")[0]

    def draw(self, context):
        draw_state(self.layout, context)


def draw_state(layout, context):
    """Version and platform; the reason where the native module cannot be used."""
    problem = status.native_problem
    if problem:
        box = layout.box().column(align=True)
        box.alert = True
        for line in wrapped(problem[:1].upper() + problem[1:], context):
            box.label(text=line)
    column = layout.column(align=True)
    column.label(text=f"Thenar {names.VERSION}", icon="ERROR" if problem else "CHECKMARK")
    column.label(text=status.where(), icon="BLANK1")


def text_width(context):
    """How many letters fit on a line of the region."""
    return max(20, int((context.region.width / context.preferences.system.ui_scale - 50) / 6.6))


def wrapped(text, context):
    """Lines that fit the region: panels do not wrap."""
    width = text_width(context)
    lines = [""]
    for word in _UNIT.sub("\u00a0", " ".join(text.split())).split(" "):
        if lines[-1] and len(lines[-1]) + len(word) + 1 > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return [line.replace("\u00a0", " ") for line in lines]


CLASSES = (ThenarPreferences,)
