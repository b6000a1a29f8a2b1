"""Blender properties of Thenar: what to solve, and the result kept in the file."""

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

from .. import names, status
from ..soft_grip import settings as grip_settings
from . import bake_settings, comfort_settings, effect_settings, map_settings
from .material_settings import ThenarMaterial


def _look_changed(_self, context):
    for refresh in status.look_changed:
        refresh(context)


def _live_switched(_self, context):
    for follow in status.live_switched:
        follow(context)


class ThenarRegionResult(bpy.types.PropertyGroup):
    """What one region, or one finger, carries; `name` is the region's."""

    force_n: FloatProperty(name="Force (N)", description="Normal force of the region, N")
    area_mm2: FloatProperty(name="Area (mm²)", description="Contact area of the region, mm²")
    peak_kpa: FloatProperty(name="Peak (kPa)", description="Highest pressure in the region, kPa")
    mean_kpa: FloatProperty(name="Mean (kPa)", description="Mean pressure over the region's contact area, kPa")
    depth_mm: FloatProperty(
        name="Depth (mm)", description="Largest overlap of the region with the product before contact, mm"
    )
    shear_modulus_kpa: FloatProperty(name="G (kPa)", description="Shear modulus of the region under this contact, kPa")
    threshold_kpa: FloatProperty(
        name="Threshold (kPa)", description="Pressure that the region is compared with, kPa; 0: not assessed"
    )
    over_mm2: FloatProperty(name="Over the Threshold (mm²)", description="Area of the region over its threshold, mm²")
    reference_n: FloatProperty(
        name="Reference Force (N)", description="Normal force of the region in the reference solve, N"
    )


class ThenarStage(bpy.types.PropertyGroup):
    """Seconds of one stage of the solve; `name` is the stage."""

    seconds: FloatProperty(name="Seconds", description="Time that the stage took, s")


class ThenarText(bpy.types.PropertyGroup):
    """One line of text, in `name`."""


class ThenarReference(bpy.types.PropertyGroup):
    """What the reference solve found of the same contact."""

    is_valid: BoolProperty(default=False)
    force_n: FloatProperty()
    area_mm2: FloatProperty()
    patch_peak_kpa: FloatProperty()
    note: StringProperty()


class ThenarResult(bpy.types.PropertyGroup):
    """The last contact of the scene, as numbers with units; fields per vertex are attributes on the meshes."""

    schema: IntProperty(default=names.SCHEMA)
    is_valid: BoolProperty(default=False)
    hand_name: StringProperty()
    product_name: StringProperty()
    model: StringProperty()
    effects: StringProperty()
    vertices: IntProperty()
    force_n: FloatProperty()
    force_vector_n: FloatVectorProperty(size=3)
    shear_n: FloatProperty()
    moment_nmm: FloatVectorProperty(size=3)
    center_mm: FloatVectorProperty(size=3)
    area_mm2: FloatProperty()
    peak_kpa: FloatProperty()
    shear_peak_kpa: FloatProperty()
    slipping: FloatProperty()
    over_mm2: FloatProperty()
    comfort: StringProperty()
    comfort_source: StringProperty()
    patch_peak_kpa: FloatProperty()
    mean_kpa: FloatProperty()
    depth_mm: FloatProperty()
    penetration_mm: FloatProperty()
    complementarity: FloatProperty()
    load_balance: FloatProperty()
    write_error_mm: FloatProperty()
    shown_penetration_mm: FloatProperty(default=-1.0)
    shown_between_mm: FloatProperty(default=-1.0)
    shown_place_mm: FloatVectorProperty(size=3)
    shown_vertex: IntProperty(default=-1)
    shown_corrected: IntProperty()
    shown_blame: StringProperty()
    is_held_known: BoolProperty(default=False)
    is_force_closed: BoolProperty()
    held_share: FloatProperty()
    held_n: FloatProperty()
    held_friction: FloatProperty()
    held_arm_mm: FloatProperty()
    offset_mm: FloatProperty()
    grip_mm: FloatProperty()
    grip_share: FloatProperty()
    direction: FloatVectorProperty(size=3)
    input_hash: StringProperty()
    state_hash: StringProperty()
    made_with: StringProperty()
    grade: StringProperty()
    reason: StringProperty()
    reason_kind: StringProperty()
    reason_vertex: IntProperty(default=-1)
    passes_between: BoolProperty()
    regions: CollectionProperty(type=ThenarRegionResult)
    region_index: IntProperty()
    fingers: CollectionProperty(type=ThenarRegionResult)
    reference: PointerProperty(type=ThenarReference)
    stages: CollectionProperty(type=ThenarStage)
    warnings: CollectionProperty(type=ThenarText)


class ThenarRefusal(bpy.types.PropertyGroup):
    """Why the last press gave no result, and at which vertices of the hand, as numbers with commas between."""

    text: StringProperty()
    vertices: StringProperty()


class ThenarSlot(bpy.types.PropertyGroup):
    """A material slot as it was before the pressure was shown."""

    link: StringProperty()
    material: PointerProperty(type=bpy.types.Material)


class ThenarObject(bpy.types.PropertyGroup):
    """`object.thenar`: materials of a hand by region, and what Thenar changed on an object, so as to undo it."""

    materials: CollectionProperty(type=ThenarMaterial)
    material_index: IntProperty()
    format: IntProperty(options={"HIDDEN"})
    default_material: PointerProperty(type=ThenarMaterial)
    effects: CollectionProperty(type=effect_settings.ThenarEffect)
    effect_index: IntProperty()
    made_basis: BoolProperty()
    home: FloatVectorProperty(size=3, subtype="XYZ")
    is_moved: BoolProperty()
    copy_of: StringProperty()
    shows_pressure: BoolProperty()
    was_hidden: BoolProperty()
    hid_render: BoolProperty()
    added_slot: BoolProperty()
    slots: CollectionProperty(type=ThenarSlot)
    bake_path: StringProperty()
    bake: PointerProperty(type=bake_settings.ThenarBake)
    grip: PointerProperty(type=grip_settings.ThenarGrip)


class ThenarMesh(bpy.types.PropertyGroup):
    """`mesh.thenar`: the names of attributes and shape keys that Thenar made, one a line."""

    owned: StringProperty()


def _is_mesh(_self, obj):
    return obj.type == "MESH"


def _is_surface(_self, obj):
    return obj.type in {"MESH", "CURVE", "SURFACE", "FONT", "META"} or obj.instance_type != "NONE"


class ThenarScene(bpy.types.PropertyGroup):
    """`scene.thenar`: what to solve, how to show it, and the result."""

    hand: PointerProperty(type=bpy.types.Object, name="Hand", description="The posed hand's mesh", poll=_is_mesh)
    product: PointerProperty(
        type=bpy.types.Object, name="Product", description="What the hand presses against", poll=_is_surface
    )
    product_collection: PointerProperty(
        type=bpy.types.Collection,
        name="Parts",
        description="Collection whose objects are the product, in addition to Product",
    )
    model: EnumProperty(
        name="Model",
        description="Contact model of the skin",
        items=(
            ("LAYER", "Layer on bone", "Coupled soft-tissue layer of finite thickness on bone, nearly incompressible"),
            ("PAPER", "Paper", "Xie, Kanai & Date as published: independent regions, half space, swelling"),
        ),
    )
    use_force: BoolProperty(
        name="Force target", description="Move the product until the contact carries the given normal force"
    )
    force_n: FloatProperty(name="Force (N)", description="Target normal force, N", min=0.0, soft_max=500, default=10)
    direction_mode: EnumProperty(
        name="Direction",
        description="Direction in which the product moves to reach the force",
        items=(
            ("AUTO", "Automatic", "The mean normal of the contact as posed"),
            ("OWN", "Custom", "A direction in world axes"),
        ),
    )
    direction: FloatVectorProperty(
        name="Direction",
        description="World direction in which the product moves",
        size=3,
        default=(0, 0, 1),
        subtype="XYZ",
    )
    slide_mm: FloatVectorProperty(
        name="Slide (mm)",
        description="Tangential displacement of the product over the skin, world axes, mm; needs the effect Friction. "
        "A bake uses the product's own motion instead",
        size=3,
        subtype="XYZ",
    )
    range_kpa: FloatProperty(
        name="Range (kPa)",
        description="Pressure at the top of the color map, kPa; shared by hand and product and kept between solves",
        min=0.0,
        soft_max=500,
        default=150,
        update=_look_changed,
    )
    palette: EnumProperty(
        name="Colors",
        description="Color map of the pressure",
        items=(
            ("EMBER", "Ember", "Light where pressure is low; perceptually uniform", 2),
            ("VIRIDIS", "Viridis", "Dark where pressure is low; perceptually uniform", 0),
            ("CIVIDIS", "Cividis", "As Viridis, also with a color-vision deficiency", 1),
        ),
        default="EMBER",
        update=_look_changed,
    )
    show_legend: BoolProperty(
        name="Legend", description="Show the legend in the viewport", default=True, update=_look_changed
    )
    accepted_mm: FloatProperty(
        name="Accepted Size (mm)", description="Longest side of a product whose size was accepted, mm", min=0.0
    )
    added_mm: FloatProperty(
        name="Size as Read (mm)", description="Longest side of the product as its file was read, mm", min=0.0
    )
    live: BoolProperty(
        name="Live",
        description="Update the contact while hand, armature or product move; renders need a bake",
        update=_live_switched,
    )
    maps: PointerProperty(type=map_settings.ThenarMaps)
    comfort: PointerProperty(type=comfort_settings.ThenarComfort)
    preset_before: StringProperty()
    refusal: PointerProperty(type=ThenarRefusal)
    result: PointerProperty(type=ThenarResult)


CLASSES = (
    *effect_settings.CLASSES,
    *map_settings.CLASSES,
    *comfort_settings.CLASSES,
    *bake_settings.CLASSES,
    *grip_settings.CLASSES,
    ThenarMaterial,
    ThenarRegionResult,
    ThenarReference,
    ThenarStage,
    ThenarText,
    ThenarResult,
    ThenarRefusal,
    ThenarSlot,
    ThenarObject,
    ThenarMesh,
    ThenarScene,
)


def register():
    """Register the property groups and hang them on objects and scenes."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.thenar = PointerProperty(type=ThenarObject)
    bpy.types.Mesh.thenar = PointerProperty(type=ThenarMesh)
    bpy.types.Scene.thenar = PointerProperty(type=ThenarScene)


def unregister():
    """Take the properties off again."""
    del bpy.types.Scene.thenar
    del bpy.types.Mesh.thenar
    del bpy.types.Object.thenar
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
