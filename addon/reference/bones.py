"""The bone under a posed skin, from the rig that moves it. Knows nothing of the solve."""

from dataclasses import replace

import numpy as np
from bpy.types import Context, Object

from .. import native
from ..hand import pads, skinning
from ..hand_bones import reading, rig_axes, roles
from ..scene import units
from ..scene.units import Floats, Ints


def ways(context: Context, hand: Object, skin: tuple[Floats, Ints, Floats], first: Ints) -> tuple[Floats, str]:
    """From every posed vertex to the bone under it (k, 3), mm, and why the rig's bones are not known, if so.

    `skin`: posed vertices, triangles, thickness; `first`: the vertices of the hand that those are.
    """
    posed_mm, triangles, thickness = skin
    try:
        rig, stored = reading.read_rig(context, hand)
        joints = roles.resolve(rig, stored)
        armature = reading.armature_of(hand)
    except (rig_axes.RigError, roles.RoleError) as error:
        bone = native.module.bone_points(posed_mm, triangles, thickness)
        return np.asarray(bone) - posed_mm, str(error)
    rig = replace(rig.subset(first), normals=None)
    scale = float(np.cbrt(abs(np.linalg.det(rig.world_from_rig[:3, :3]))))
    if units.is_mirrored(rig.world_from_rig):
        triangles = triangles[:, ::-1].copy()  # outward in the rig's own space
    heads, tails = rig.rest[:, :3, 3] * scale, reading.tails(rig, armature) * scale
    palmar, is_last = np.zeros((len(rig.names), 3)), [False] * len(rig.names)
    for role, bone in joints.bones.items():
        if role != roles.WRIST and not role.endswith("metacarpal"):
            palmar[bone], is_last[bone] = pads.palmar(rig, joints, role), role.endswith("distal")
    at_rest = native.module.bone_points(
        rig.vertices * scale, triangles, thickness, heads, tails, palmar, is_last, rig.weights
    )
    posed = np.array([armature.pose.bones[name].matrix for name in rig.names], dtype=np.float64)
    moved = skinning.skin(replace(rig, vertices=np.asarray(at_rest) / scale), posed)
    return moved - skinning.skin(rig, posed), ""
