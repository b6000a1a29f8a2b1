"""Which bone of an armature plays which part: the settings on the armature object, filled by guess or by hand."""

import bpy
from bpy.props import BoolProperty, EnumProperty, PointerProperty, StringProperty

from . import roles

AXES = (
    ("AUTO", "From the knuckles", "Every finger bends about the line of the knuckles, towards the palm", 0),
    ("X", "X", "Bones bend about their own +X", 1),
    ("NEG_X", "-X", "Bones bend about their own -X", 2),
    ("Z", "Z", "Bones bend about their own +Z", 3),
    ("NEG_Z", "-Z", "Bones bend about their own -Z", 4),
)

SIDES = (
    ("AUTO", "Automatic", "The hand that carries most of the mesh; of two alike the right one", 0),
    ("LEFT", "Left", "The left hand of a body", 1),
    ("RIGHT", "Right", "The right hand of a body", 2),
)


def _properties():
    out = {
        role: StringProperty(
            name=role.replace("_", " ").capitalize(), description="Bone that plays this part; empty if the rig has none"
        )
        for role in roles.ROLES
    }
    out["axis"] = EnumProperty(name="Flexion axis", description="Axis about which the bones flex", items=AXES)
    out["side"] = EnumProperty(
        name="Side", description="Which hand of a body is meant; detect bones after a change", items=SIDES
    )
    out["show_digits"] = BoolProperty(
        name="Show Digits", description="Draw the assigned digits as colored lines in the 3D view"
    )
    out["muted"] = StringProperty()  # what `constrained` muted, as JSON
    return out


class ThenarBoneMap(bpy.types.PropertyGroup):
    """`armature_object.thenar_bones`: role -> bone name, and about which axis the bones flex."""

    __annotations__ = _properties()


def get_map(armature):
    """Role -> bone name of the roles that are filled in."""
    stored = armature.thenar_bones
    return {role: getattr(stored, role) for role in roles.ROLES if getattr(stored, role)}


def side_of(armature):
    """`left`, `right`, or None for the automatic choice."""
    return {"LEFT": "left", "RIGHT": "right"}.get(armature.thenar_bones.side)


def set_map(armature, names, axis="AUTO"):
    """Write role -> bone name to the armature object; roles not named are cleared."""
    for role in roles.ROLES:
        setattr(armature.thenar_bones, role, names.get(role, ""))
    armature.thenar_bones.axis = axis


def register_properties():
    """Hang the bone map on objects; its class is registered with the others."""
    bpy.types.Object.thenar_bones = PointerProperty(type=ThenarBoneMap)


def unregister_properties():
    """Take it off again."""
    del bpy.types.Object.thenar_bones
