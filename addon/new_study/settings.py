"""Blender properties of a study that is being made: its files, columns, protocols with their tools, and its skin."""

from contextlib import contextmanager

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..properties.settings import ThenarText

HAND, FLAT = "HAND", "FLAT"
STATED = "STATED"
"""The unit of a column is the one that the file states."""


def _units(*names):
    stated = (STATED, "in file", "The unit that the file states, in the column's name or in the row below it")
    return (stated, *((name.upper(), name, f"The column is in {name}") for name in names))


TIME_UNITS, LENGTH_UNITS = _units("s", "ms", "min"), _units("mm", "um", "nm", "cm", "m", "in")
FORCE_UNITS = _units("N", "mN", "uN", "kN", "gf", "kgf", "lbf")
ROLES = ("time", "depth", "force")
"""What is needed of every recording, in the order in which it is asked for."""


changed = []
"""Called with the context after the user changed a column or a protocol's number."""
_quiet = []
"""Not empty while the add-on itself fills the properties."""


@contextmanager
def filling():
    """What is set inside is a proposal, and no answer of the user's."""
    _quiet.append(True)
    try:
        yield
    finally:
        _quiet.pop()


def _changed(_self, context):
    if not _quiet:
        for look in changed:
            look(context)


def _regrouped(_self, context):
    if not _quiet:
        context.scene.thenar_new_study.is_own_grouping = True
        _changed(_self, context)


MOST_PROTOCOLS = 99
"""Protocols of a study that the panel shows."""
MOST_FILES = 999
"""Recordings of a study in the panel; each may be a protocol of its own until its columns are known."""
NO_TOOL = "SPHERE 0.0 0.0"
"""The tool of which nothing was said; its size is never guessed."""


def set_tool(protocol, text):
    """Give a protocol the tool of a text as `ThenarStudyFile.tool` holds it."""
    shape, diameter_mm, turn_deg = text.split()
    protocol.shape, protocol.diameter_mm, protocol.turn_deg = shape, float(diameter_mm), float(turn_deg)


def _tool_given(protocol, _context):
    """The recordings of a protocol keep the tool that the user gave it, wherever they are moved."""
    if _quiet:
        return
    state = protocol.id_data.thenar_new_study
    number = next(k for k, each in enumerate(state.protocols, 1) if each == protocol)
    for item in state.files:
        if item.protocol == number:
            item.tool = f"{protocol.shape} {protocol.diameter_mm!r} {protocol.turn_deg!r}"


def _site_given(state, _context):
    """The vertex's number means something on this hand alone, and as long as it has as many vertices."""
    hand = state.id_data.thenar.hand
    state.site_hand = hand
    state.site_count = len(hand.data.vertices) if hand is not None and hand.type == "MESH" else 0


class ThenarStudyColumns(bpy.types.PropertyGroup):
    """Columns of files of one head, as the user names them; `name` is the head, `asks` the roles that are open."""

    headers: CollectionProperty(type=ThenarText)
    asks: StringProperty()
    time: StringProperty(name="Time", description="Column that holds the time", update=_changed)
    time_unit: EnumProperty(name="Unit", description="Unit of the times", items=TIME_UNITS, update=_changed)
    depth: StringProperty(
        name="Depth", description="Column that says how deep the tool stands, or how far it has moved", update=_changed
    )
    depth_unit: EnumProperty(name="Unit", description="Unit of the depths", items=LENGTH_UNITS, update=_changed)
    force: StringProperty(name="Force", description="Column that holds the force of the tool", update=_changed)
    force_unit: EnumProperty(name="Unit", description="Unit of the forces", items=FORCE_UNITS, update=_changed)
    depth_zero: EnumProperty(
        name="Depth 0 is",
        description="Where the depth is zero",
        items=(
            ("ANY", "Anywhere", "The travel of the tool from any zero; first touch is found from the force"),
            ("TOUCH", "First Touch", "The depth counts from the first touch of the skin, as the operator judged it"),
        ),
        update=_changed,
    )
    depth_reversed: BoolProperty(
        name="Depth grows away from the skin",
        description="Reverse the sign, so that the depth grows into the skin",
        update=_changed,
    )
    force_reversed: BoolProperty(
        name="Pressing is negative", description="Reverse the sign, so that pressing is positive", update=_changed
    )


class ThenarStudyFile(bpy.types.PropertyGroup):
    """A recording of the study; `name` is shown, `run` names one of several in a file, `head` its columns.

    `tool`: what the user said that pressed it, as shape, diameter (mm) and turn (degrees).
    """

    path: StringProperty(subtype="FILE_PATH")
    run: StringProperty()
    head: StringProperty()
    tool: StringProperty(default=NO_TOOL)
    problem: StringProperty()
    about: StringProperty()
    reach_mm: FloatProperty()
    protocol: IntProperty(
        name="Protocol",
        description="Number of the protocol below; repeats of one protocol share it and show the noise",
        min=1,
        max=MOST_FILES,
        default=1,
        update=_regrouped,
    )


class ThenarStudyProtocol(bpy.types.PropertyGroup):
    """What recordings of one protocol share: `name`, and the tool."""

    shape: EnumProperty(
        name="Tool",
        description="Shape of the tool that pressed",
        items=(
            ("SPHERE", "Sphere", "A ball, or a rod with a round end"),
            ("CYLINDER", "Cylinder", "A cylinder lying on the skin"),
            ("PLANE", "Flat Plate", "A flat plate larger than the contact"),
            ("PUNCH", "Flat Rod", "The flat end of a round rod"),
        ),
        update=_tool_given,
    )
    diameter_mm: FloatProperty(
        name="Diameter (mm)", description="Diameter of the tool, mm", min=0.0, soft_max=200.0, update=_tool_given
    )
    turn_deg: FloatProperty(
        name="Axis (°)",
        description="Turn of the cylinder's axis about the direction of travel, degrees; 0: along the mesh's y axis",
        soft_min=-180,
        soft_max=180,
        update=_tool_given,
    )


class ThenarNewStudy(bpy.types.PropertyGroup):
    """`scene.thenar_new_study`: the study that is being made."""

    is_open: BoolProperty()
    folder: StringProperty(subtype="DIR_PATH")
    title: StringProperty(name="Title", description="Title of the study in reports")
    files: CollectionProperty(type=ThenarStudyFile)
    columns: CollectionProperty(type=ThenarStudyColumns)
    protocols: CollectionProperty(type=ThenarStudyProtocol)
    is_own_grouping: BoolProperty()
    skin: EnumProperty(
        name="Pressed",
        description="What the tool pressed",
        items=(
            (HAND, "Hand", "The scene's hand, at a place that is clicked on its skin or at a region"),
            (FLAT, "Flat Skin", "A flat piece of skin or a test body: gel, silicone, a flat part of the body"),
        ),
    )
    site_vertex: IntProperty(
        name="Vertex",
        description="Vertex of the hand at which the tool touches first; -1: none",
        min=-1,
        default=-1,
        update=_site_given,
    )
    site_hand: PointerProperty(type=bpy.types.Object)
    site_count: IntProperty()
    site_region: StringProperty(
        name="Region", description="Region of the hand in whose middle the tool touches, if no place was clicked"
    )
    thickness_mm: FloatProperty(
        name="Thickness (mm)",
        description="Soft tissue, or gel, above what is rigid, mm; 0: so thick that it does not matter",
        min=0.0,
        soft_max=50.0,
    )
    replaces: BoolProperty(
        name="Replace them", description="Write over the study's files that are in the folder already"
    )


CLASSES = (ThenarStudyColumns, ThenarStudyFile, ThenarStudyProtocol, ThenarNewStudy)


def register_properties():
    """Hang the new study on scenes."""
    bpy.types.Scene.thenar_new_study = PointerProperty(type=ThenarNewStudy)


def unregister_properties():
    """Take it off again."""
    del bpy.types.Scene.thenar_new_study
