"""The panel of the diagnosis: a letter with buttons. Layout only; the words stand in letter.py."""

from functools import lru_cache

import bpy

from .. import status, tabs
from ..languages import iface
from ..panels import start, text
from ..panels.main import Tab
from ..recordings import settings as recordings
from ..scene.checks import Refusal
from . import applying, curves, freshness, letter, reading

ICONS = {
    "nothing_missing": "CHECKMARK",
    "parameters": "OPTIONS",
    "instrument": "TOOL_SETTINGS",
    "missing_physics": "ZOOM_ALL",
    "cannot_tell": "QUESTION",
    "unlisted": "HELP",
    "insufficient_data": "INFO",
}


@lru_cache(maxsize=8)
def written(findings):
    """The letter of findings.json; None with the reason if it cannot be read."""
    try:
        return letter.write(reading.parse(findings)), ""
    except Refusal as refusal:
        return None, str(refusal)


def _letter(context):
    state = context.scene.thenar_diagnosis
    return written(state.findings)[0] if state.is_valid else None


class THENAR_PT_diagnosis(Tab, bpy.types.Panel):
    """The question, and the answer in one sentence."""

    bl_label = "Diagnosis"
    bl_parent_id = "THENAR_PT_main"
    bl_order = 7

    @classmethod
    def poll(cls, context):
        is_loaded = context.scene.thenar_recordings.items or context.scene.thenar_diagnosis.is_valid
        is_asked = is_loaded or context.scene.thenar.hand is not None
        return not status.native_problem and bool(is_asked) and tabs.shows(context, tabs.DIAGNOSE)

    def draw(self, context):
        layout, state = self.layout, context.scene.thenar_diagnosis
        item = recordings.chosen(context)
        if item is None or item.kind != recordings.STUDY:
            text.paragraph(layout, context, "A diagnosis needs a study: load one, and select it in the list", "INFO")
            start.draw_studies(layout.box().column())
        else:
            text.faint(layout, context, f"{item.name}: {item.about}")
        _draw_button(layout)
        if not state.is_valid:
            return
        told, problem = written(state.findings)
        if told is None:
            text.alert(layout, context, problem)
            return
        doubt = freshness.problem(state)
        if doubt:
            text.alert(layout, context, doubt)
        box = layout.box().column(align=True)
        box.label(text=text.spoken(told.heading), icon=ICONS[told.verdict])
        box.separator(factor=0.5)
        text.paragraph(box, context, told.sentence)
        if item is None or item.path != state.path:
            text.faint(layout, context, iface("Of the study '{title}'", title=state.study))
        layout.operator("thenar.report", text="Write Report", icon="TEXT").kind = "DIAGNOSIS"


class _Part(Tab):
    """A part of the letter; there if it has something to say."""

    bl_parent_id = "THENAR_PT_diagnosis"

    @classmethod
    def poll(cls, context):
        told = _letter(context)
        return told is not None and bool(cls.said(told))


class THENAR_PT_findings(_Part, bpy.types.Panel):
    """What was found: how sure, how large, where, when."""

    bl_label = "Findings"

    @staticmethod
    def said(told):
        """The findings."""
        return told.entries

    def draw(self, context):
        for entry in _letter(context).entries:
            _draw_entry(self.layout, context, entry)


class THENAR_PT_depends(_Part, bpy.types.Panel):
    """What something without a name goes with."""

    bl_label = "Dependence"

    @staticmethod
    def said(told):
        """A bar for each variable."""
        return told.depends

    def draw(self, context):
        told = _letter(context)
        _draw_bars(self.layout, told.depends, 0.5)
        text.faint(self.layout, context, told.depends_note)


class THENAR_PT_phases(_Part, bpy.types.Panel):
    """In which phase of the recordings the evidence stands."""

    bl_label = "Evidence by Phase"

    @staticmethod
    def said(told):
        """A bar for each phase."""
        return told.phases

    def draw(self, context):
        _draw_bars(self.layout, _letter(context).phases, 0.5)


class THENAR_PT_gain(_Part, bpy.types.Panel):
    """The error on recordings held out, before and after."""

    bl_label = "Held-Out Error"

    @staticmethod
    def said(told):
        """Bars and sentences."""
        return told.bars or told.gain

    def draw(self, context):
        layout, told = self.layout, _letter(context)
        if told.bars:
            text.faint(layout, context, "RMS error on held-out recordings; σ: standard deviation of the noise")
        _draw_bars(layout, told.bars, 0.34)
        for sentence in told.gain:
            text.paragraph(layout, context, sentence)
        kept = context.scene.thenar_diagnosis.curves
        for number, curve in enumerate(curves.read(kept)):
            text.paragraph(layout, context, iface("Force over time in '{recording}'", recording=curve["recording"]))
            layout.template_icon(icon_value=curves.icon(kept, number), scale=9.0)
        if kept:
            text.faint(layout, context, "White: measured. Orange: before. Blue: after")


class THENAR_PT_rivals(_Part, bpy.types.Panel):
    """What cannot be told, and which recording would tell it."""

    bl_label = "Next Recording"

    @staticmethod
    def said(told):
        """Rivals and advice."""
        return told.rivals or told.advice

    def draw(self, context):
        layout, told = self.layout, _letter(context)
        for sentence in told.rivals:
            text.paragraph(layout, context, sentence, "QUESTION")
        for advice in told.advice:
            box = layout.box().column(align=True)
            text.paragraph(box, context, advice.text, "REC")
            for line in (advice.settles, advice.outlook):
                if line:
                    text.faint(box, context, line)


class THENAR_PT_smallest(_Part, bpy.types.Panel):
    """The smallest of every effect that these recordings would have shown."""

    bl_label = "Detection Limits"
    bl_options = {"DEFAULT_CLOSED"}

    @staticmethod
    def said(told):
        """Rows by effect."""
        return told.smallest

    def draw(self, context):
        column = self.layout.column(align=True)
        for row in _letter(context).smallest:
            _draw_row(column, context, row)


class THENAR_PT_moduli(_Part, bpy.types.Panel):
    """The shear modulus of the study's skin as fitted, from first touch to where it grows no more."""

    bl_label = "Fitted Moduli"
    bl_options = {"DEFAULT_CLOSED"}

    @staticmethod
    def said(told):
        """Rows by region."""
        return told.moduli

    def draw(self, context):
        column = self.layout.column(align=True)
        for row in _letter(context).moduli:
            _draw_row(column, context, row)


class THENAR_PT_reasons(_Part, bpy.types.Panel):
    """What else a reader should know."""

    bl_label = "Notes"
    bl_options = {"DEFAULT_CLOSED"}

    @staticmethod
    def said(told):
        """Sentences."""
        return told.notes

    def draw(self, context):
        for sentence in _letter(context).notes:
            text.paragraph(self.layout, context, sentence, "DOT")


def _draw_bars(layout, bars, share):
    column = layout.column(align=True)
    for bar in bars:
        split = column.split(factor=share)
        split.label(text=bar.label[:1].upper() + bar.label[1:])
        split.progress(factor=bar.share, text=bar.text)


def _draw_button(layout):
    if text.progress(layout):
        return
    row = layout.row()
    row.scale_y = 1.3
    row.operator("thenar.diagnose", icon="VIEWZOOM")


def _draw_entry(layout, context, entry):
    box = layout.box().column(align=True)
    head = box.row()
    head.label(text=entry.title, icon="TOOL_SETTINGS" if entry.is_instrument else "PHYSICS")
    if entry.sureness is None:
        # On a row of its own: next to the name it would cut the name.
        text.faint(box, context, iface("Confidence not measured"))
    else:
        sure = head.row()
        sure.alignment = "RIGHT"
        sure.label(text=iface("{share} confidence", share=letter.wording.share(entry.sureness)))
    if entry.meaning:
        text.faint(box, context, entry.meaning)
    for row in entry.rows:
        _draw_row(box, context, row)
    if entry.story:
        text.paragraph(box, context, entry.story)
    for sign, holds in entry.signs:
        text.paragraph(box, context, sign, "CHECKMARK" if holds else "X")
    box.separator(factor=0.5)
    buttons = box.row(align=True)
    if entry.has_place:
        buttons.operator("thenar.show_finding", text="Show", icon="RESTRICT_SELECT_OFF").index = entry.index
    if applying.is_on(context, entry.effect):
        buttons.label(text="In the model" if entry.is_instrument else "Switched on", icon="CHECKMARK")
    else:
        word = "Into the Model" if entry.is_instrument else "Switch On"
        buttons.operator("thenar.apply_finding", text=word, icon="ADD").index = entry.index


def _draw_row(column, context, row):
    """A word and what stands beside it; below it where the sidebar is too narrow for both."""
    if len(row.label) + len(row.text) + 4 <= text.width(context):
        split = column.split(factor=(len(row.label) + 2) / (len(row.label) + len(row.text) + 4))
        split.label(text=row.label)
        beside = split.row()
        beside.alignment = "RIGHT"
        beside.label(text=row.text)
        return
    column.label(text=row.label)
    for line in text.wrapped(row.text, text.width(context)):
        below = column.row()
        below.alignment = "RIGHT"
        below.label(text=line)


CLASSES = (
    THENAR_PT_diagnosis,
    THENAR_PT_findings,
    THENAR_PT_depends,
    THENAR_PT_phases,
    THENAR_PT_gain,
    THENAR_PT_rivals,
    THENAR_PT_smallest,
    THENAR_PT_moduli,
    THENAR_PT_reasons,
)
