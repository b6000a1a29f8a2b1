"""The interface in other languages: tables brought to Blender, and sentences composed in the user's language."""

import functools
import inspect
import re
from pathlib import Path

import bpy

from . import po

FOLDER = Path(__file__).resolve().parent
LANGUAGES = {"ja": ("ja_JP",), "de": ("de_DE",), "zh": ("zh_HANS", "zh_CN")}
"""Table (`ja.po`) and the names that Blender has for its language; zh_CN is that of scripts from before 4.0."""
OWN = "Thenar"
"""Context of Thenar's own sentences: Blender's translation of the same words does not come first there."""
FORCE = "Thenar: force"
"""Context of words that mean the strength of a grasp: Light is weak there, not bright."""
BONE = "Thenar: bone"
"""Context of the parts of a finger: Middle is the bone between two others there, not the finger."""
LAW = "Thenar: law"
"""Context of the laws of an effect: Power is a power law there, not a power grip."""
SENTENCE = "Thenar: sentence"
"""Context of templates of sentences that are kept in English; see `sentences`."""
CONTEXTS = ("*", "Operator", OWN, FORCE, BONE, LAW)
"""Contexts in which an entry without one holds: Blender's default, its operators, ours."""

_FRAME, _FORCED = re.compile(r"frame (\d+) of (\d+), (.*)"), re.compile(r"Force (\d+) N")
"""Stages with a number."""


def iface(template, **values):
    """A label in the user's language, `values` filled in as by `str.format`; English where there is none."""
    return _filled(bpy.app.translations.pgettext_iface(template, OWN), values)


def tip(template, **values):
    """The same for a tooltip."""
    return _filled(bpy.app.translations.pgettext_tip(template, OWN), values)


def report(template, **values):
    """The same for what an operator reports."""
    return _filled(bpy.app.translations.pgettext_rpt(template, OWN), values)


def reported(error):
    """What an operator reported that was run by another one: the text of its `RuntimeError` without Blender's word for
    an error, which is in the user's language."""
    text = str(error).strip()
    for mark in error_marks():
        text = text.removeprefix(mark)
    return text


def error_marks():
    """What Blender puts before the error that an operator reported, in English and in the user's language."""
    said = bpy.app.translations
    return tuple(f"{word}: " for word in ("Error", said.pgettext_rpt("Error"), said.pgettext_tip("Error")))


def bone(name):
    """A bone of a finger by its capitalized part, `Distal`, in the user's language."""
    return bpy.app.translations.pgettext_iface(name, BONE)


def kept(template):
    """The template of a sentence that is kept in English, in the user's language."""
    return bpy.app.translations.pgettext_iface(template, SENTENCE)


def inside(title):
    """A title as it stands inside a sentence: in lower case where it stays English."""
    words = iface(title)
    return title.lower() if words == title else words


def stage(words):
    """What a computation is doing, a stage's name or `frame 3 of 24, solving`, in the user's language."""
    frame, force = _FRAME.fullmatch(words), _FORCED.fullmatch(words)
    if frame is not None:
        return iface("frame {number} of {last}, {stage}", number=frame[1], last=frame[2], stage=iface(frame[3]))
    return iface(words) if force is None else iface("Force {newtons} N", newtons=force[1])


def _filled(text, values):
    return text.format(**values) if values else text


@functools.cache
def table(name):
    """(context, English) -> translation, of the table of that name, in every context in which an entry holds."""
    entries = po.read(FOLDER / f"{name}.po")
    out = {(context, english): text for (own, english), text in entries.items() if not own for context in CONTEXTS}
    out.update({key: text for key, text in entries.items() if key[0]})
    return {key: text for key, text in out.items() if text}


def register():
    """Read the tables and give them to Blender."""
    claim()
    held = {locale: table(name) for name, locales in LANGUAGES.items() for locale in locales}
    bpy.app.translations.register(__package__, held)


def claim():
    """Give all classes and properties of ours, before they are registered, our context where they name none."""
    for base in (bpy.types.Operator, bpy.types.Panel, bpy.types.Menu):
        for cls in _below(base):
            if not hasattr(cls, "bl_translation_context"):
                cls.bl_translation_context = OWN
    for base in (bpy.types.Operator, bpy.types.PropertyGroup, bpy.types.AddonPreferences):
        for cls in _below(base):
            _claim_properties(cls)


def _below(base):
    """Classes of the add-on below a class of Blender."""
    for cls in base.__subclasses__():
        yield from _below(cls)
        if _is_ours(cls):
            yield cls


def _claim_properties(cls):
    for owner in filter(_is_ours, cls.__mro__):
        for declared in inspect.get_annotations(owner).values():
            if hasattr(declared, "keywords"):
                declared.keywords.setdefault("translation_context", OWN)


def _is_ours(cls):
    return cls.__module__.startswith(__package__.removesuffix("languages"))


def unregister():
    """Take them away again."""
    bpy.app.translations.unregister(__package__)
