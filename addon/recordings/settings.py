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

from ..settings import ThenarText

STUDY, MAP, PRINT = "STUDY", "MAP", "PRINT"
AXES = tuple((f"{sign}{axis}", f"{sign}{axis}", f"The product's {sign}{axis} axis") for axis in "XYZ" for sign in "+-")


class ThenarPlacing(bpy.types.PropertyGroup):
    """How a flat mat lies on the product, about the middle of the product's bounds and in its own axes."""

    on: EnumProperty(
        name="On",
        description="What the mat lies on",
        items=(
            ("CYLINDER", "Cylinder", "Wrapped around: rows count along the axis, columns around it"),
            ("PLANE", "Plane", "Flat on the side of the product that looks along the axis"),
        ),
    )
    axis: EnumProperty(
        name="Axis", description="Axis of the cylinder, or the way the plane looks", items=AXES, default="+Z"
    )
    diameter_mm: FloatProperty(
        name="Diameter (mm)", description="Diameter on which the sensels lie, mm", min=0.0, default=48, soft_max=200
    )
    turn_deg: FloatProperty(
        name="Seam (°)",
        description="Where the edge before the first column lies around the axis, or how the mat is turned, degrees",
        soft_min=-180,
        soft_max=180,
    )
    shift_mm: FloatVectorProperty(
        name="Shift (mm)", description="Along the rows and along the columns, from the middle, mm", size=2
    )
    is_mirrored: BoolProperty(name="Reverse columns", description="Columns are numbered in the opposite direction")


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
    frame_rule: EnumProperty(
        name="Frame",
        description="Which frame is compared with the contact",
        items=(
            ("MEAN", "Mean force", "The frame whose force is nearest to the mean over all frames that carry any"),
            ("LARGEST", "Largest force", "The frame of the largest force"),
            ("NUMBER", "Number", "A frame by its number"),
        ),
    )
    frame: IntProperty(name="Number", description="Number of the frame, from 1", min=1, default=1)
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
    state = context.scene.thenar_recordings
    return state.items[min(max(state.index, 0), len(state.items) - 1)] if len(state.items) else None


def register_properties():
    """Hang the recordings on scenes."""
    bpy.types.Scene.thenar_recordings = PointerProperty(type=ThenarRecordings)


def unregister_properties():
    """Take them off again."""
    del bpy.types.Scene.thenar_recordings
