"""Blender properties of a diagnosis: the findings as text, which study they are of, and what of them was taken over."""

import bpy
from bpy.props import BoolProperty, CollectionProperty, PointerProperty, StringProperty

from .. import names


class ThenarModelEffect(bpy.types.PropertyGroup):
    """An effect taken into the study's model; `name` is the library's, `parameters` its numbers as JSON."""

    kind: StringProperty()
    parameters: StringProperty()


class ThenarDiagnosis(bpy.types.PropertyGroup):
    """`scene.thenar_diagnosis`: the last diagnosis of the scene. `findings` is the text of findings.json.

    `curves` is a text of `curves.py`: measured force, before and after.
    """

    is_valid: BoolProperty()
    stamp: StringProperty()
    study: StringProperty()
    path: StringProperty(subtype="FILE_PATH")
    study_hash: StringProperty()
    findings: StringProperty()
    curves: StringProperty()
    made_with: StringProperty()
    model: CollectionProperty(type=ThenarModelEffect)


CLASSES = (ThenarModelEffect, ThenarDiagnosis)


def fill(state, told, about):
    """Write findings (text) into the scene's diagnosis; `about`: the study's title, folder and digest."""
    title, path, study_hash = about
    if state.path != path:
        state.model.clear()
    state.is_valid, state.findings = True, told
    state.study, state.path, state.study_hash = title, path, study_hash
    state.made_with = f"Thenar {names.VERSION}"


def register_properties():
    """Hang the diagnosis on scenes."""
    bpy.types.Scene.thenar_diagnosis = PointerProperty(type=ThenarDiagnosis)


def unregister_properties():
    """Take it off again."""
    del bpy.types.Scene.thenar_diagnosis
