"""Blender properties of recordings: what was loaded, how its mat lies on the product, and what the comparison found."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..properties.settings import ThenarText

STUDY, MAP, PRINT = "STUDY", "MAP", "PRINT"
AXES = tuple((f"{sign}{axis}", f"{sign}{axis}", f"The product's {sign}{axis} axis") for axis in "XYZ" for sign in "+-")


placed, framed = [], []
"""Called with the context after the place of a mat, and after the frame of a recording, was changed."""


def _was_placed(_self, context):
    for follow in placed:
        follow(context)


def _was_sized(placing, context):
    placing.is_sized = True
    _was_placed(placing, context)


def _was_framed(item, context):
    if item.follows_timeline and item.frame_rule == "NUMBER" and context is not None and context.scene is not None:
        frame = context.scene.frame_start + item.frame - 1
        if context.scene.frame_current != frame and chosen(context) == item:
            context.scene.frame_current = frame
    for follow in framed:
        follow(context)


def _was_followed(item, context):
    """The timeline gets room for every frame of the recording, and the recording its place on it."""
    if item.follows_timeline:
        scene = context.scene
        scene.frame_end = max(scene.frame_end, scene.frame_start + item.frames - 1)
        item.frame_rule = "NUMBER"
        scene.frame_current = scene.frame_start + item.frame - 1


def _position(item):
    return 100.0 * (item.frame - 1) / max(item.frames - 1, 1)


def _set_position(item, percent):
    item.frame_rule, item.frame = "NUMBER", 1 + round(percent / 100.0 * max(item.frames - 1, 0))


class ThenarPlacing(bpy.types.PropertyGroup):
    """How a flat mat lies on the product, about the middle of the product's bounds and in its own axes."""

    on: EnumProperty(
        name="On",
        description="What the mat lies on",
        items=(
            ("CYLINDER", "Cylinder", "Wrapped around: rows count along the axis, columns around it"),
            ("PLANE", "Plane", "Flat on the side of the product that looks along the axis"),
        ),
        update=_was_placed,
    )
    axis: EnumProperty(
        name="Axis",
        description="Axis of the cylinder, or the way the plane looks",
        items=AXES,
        default="+Z",
        update=_was_placed,
    )
    diameter_mm: FloatProperty(
        name="Diameter (mm)",
        description="Diameter on which the sensels lie, mm",
        min=0.0,
        default=48,
        soft_max=200,
        update=_was_sized,
    )
    is_sized: BoolProperty(
        name="Sized", description="The diameter was chosen, or read off the product", options={"HIDDEN"}
    )
    turn_deg: FloatProperty(
        name="Seam (°)",
        description="Where the edge before the first column lies around the axis, or how the mat is turned, degrees",
        soft_min=-180,
        soft_max=180,
        update=_was_placed,
    )
    shift_mm: FloatVectorProperty(
        name="Shift (mm)",
        description="Along the rows and along the columns, from the middle, mm",
        size=2,
        update=_was_placed,
    )
    is_mirrored: BoolProperty(
        name="Reverse columns", description="Columns are numbered in the opposite direction", update=_was_placed
    )


class ThenarPrint(bpy.types.PropertyGroup):
    """How the image of a handprint is read."""

    dpi: FloatProperty(name="Scan (dpi)", description="Dots per inch of the image", min=1.0, default=300, soft_max=1200)
    cell_mm: FloatProperty(
        name="Cell (mm)",
        description="Cells in which contact is compared, mm: about as long as the edges of the hand's mesh",
        min=0.1,
        default=2.5,
        soft_max=10,
    )
    ink: EnumProperty(
        name="Ink",
        description="Whether ink is darker or lighter than the paper",
        items=(
            ("AUTO", "Automatic", "The paper's brightness is taken from the edge of the image"),
            ("DARK", "Dark", "Dark ink on light paper"),
            ("LIGHT", "Light", "Light on dark ground, as paint or dust"),
        ),
    )
    ink_kpa: FloatProperty(
        name="Ink threshold (kPa)", description="Pressure above which skin leaves ink, kPa; 0: any touch", min=0.0
    )
    is_mirrored: BoolProperty(
        name="Mirrored image",
        description="The image is mirrored, as seen through glass or after a transfer",
    )


class ThenarRecording(bpy.types.PropertyGroup):
    """A study, one mat of a measurement file, or a handprint; `name` is shown."""

    kind: StringProperty()
    path: StringProperty(subtype="FILE_PATH")
    mat: StringProperty()
    about: StringProperty()
    frames: IntProperty()
    curves: StringProperty()
    """Force, area and peak over the frames as text, see `over_time.kept`; empty where there are none."""
    frame_rule: EnumProperty(
        name="Frame",
        description="Which frame is compared with the contact",
        items=(
            ("MEAN", "Mean force", "The frame whose force is nearest to the mean over all frames that carry any"),
            ("LARGEST", "Largest force", "The frame of the largest force"),
            ("NUMBER", "Number", "A frame by its number"),
        ),
        update=_was_framed,
    )
    frame: IntProperty(name="Number", description="Number of the frame, from 1", min=1, default=1, update=_was_framed)
    position: FloatProperty(
        name="Position (%)",
        description="Where in the recording the frame is, % of its length",
        min=0.0,
        max=100.0,
        precision=0,
        get=_position,
        set=_set_position,
    )
    follows_timeline: BoolProperty(
        name="Follow Timeline",
        description="The scene's first frame is the recording's first, one frame for each; a shorter timeline grows",
        update=_was_followed,
    )
    placing: PointerProperty(type=ThenarPlacing)
    print: PointerProperty(type=ThenarPrint)


class ThenarMeasure(bpy.types.PropertyGroup):
    """A row of the table of measures; `name` is the measure. Texts, so that what is not known stays empty."""

    group: StringProperty()
    unit: StringProperty()
    measured: StringProperty()
    simulated: StringProperty()


class ThenarWorst(bpy.types.PropertyGroup):
    """A place where measured and simulated differ most; `name` says where, `group` in which of several recordings."""

    group: StringProperty()
    residual: StringProperty()
    vertices: StringProperty()


class ThenarComparison(bpy.types.PropertyGroup):
    """What the last comparison of the scene found."""

    is_valid: BoolProperty()
    recording: StringProperty()
    frame: IntProperty()
    stamp: StringProperty()
    hand_name: StringProperty()
    vertices: IntProperty()
    sentence: StringProperty()
    measures: CollectionProperty(type=ThenarMeasure)
    worst: CollectionProperty(type=ThenarWorst)
    notes: CollectionProperty(type=ThenarText)


class ThenarRecordings(bpy.types.PropertyGroup):
    """`scene.thenar_recordings`: what was loaded and the last comparison."""

    items: CollectionProperty(type=ThenarRecording)
    index: IntProperty()
    comparison: PointerProperty(type=ThenarComparison)


CLASSES = (
    ThenarPlacing,
    ThenarPrint,
    ThenarRecording,
    ThenarMeasure,
    ThenarWorst,
    ThenarComparison,
    ThenarRecordings,
)


def chosen(context):
    """The recording that is selected in the list, or None."""
    return chosen_of(context.scene.thenar_recordings)


def chosen_of(state):
    """The same of a scene's `thenar_recordings`."""
    return state.items[min(max(state.index, 0), len(state.items) - 1)] if len(state.items) else None


def register_properties():
    """Hang the recordings on scenes."""
    bpy.types.Scene.thenar_recordings = PointerProperty(type=ThenarRecordings)


def unregister_properties():
    """Take them off again."""
    del bpy.types.Scene.thenar_recordings
