"""The poses of the library as one-frame actions for the made hand, as Blender's pose assets are."""

import json
from hashlib import sha256

import bpy

from ..hand import build, model
from ..hand.poses import LABELS, POSES
from ..hand_bones import roles

SIDES = ("right", "left")
FRAME = 1


def digest(name):
    """What a picture of the pose is made of: a digest of its angles."""
    return sha256(json.dumps(POSES[name], sort_keys=True).encode()).hexdigest()[:16]


def turns(side):
    """Pose name -> bone name -> turns (flexion, twist, abduction), rad, of a median hand: its bones' Euler angles.

    Raises `Refusal` where no hand can be made.
    """
    made = build.make(side=side, spacing_mm=6.0)  # bones do not depend on the spacing
    rig = model.rig_of(made)
    joints = model.joints_of(made, rig)
    bones = [bone for role, bone in joints.bones.items() if role != roles.WRIST]
    out = {}
    for name in LABELS:
        angles = roles.pose_angles(rig, joints, POSES[name])
        out[name] = {rig.names[bone]: tuple(angles[bone]) for bone in bones}
    return out


def add(name, angles):
    """A new action called `name` that holds Euler angles, bone name -> (x, y, z), at one frame."""
    action = bpy.data.actions.new(name)
    curves = _curves(action)
    for bone, values in angles.items():
        path = f'pose.bones["{bpy.utils.escape_identifier(bone)}"].rotation_euler'
        for index, value in enumerate(values):
            curves.new(path, index=index).keyframe_points.insert(FRAME, value)
    return action


def _curves(action):
    """Where the action's curves are added: in a slot for objects, where actions have slots."""
    if not hasattr(action, "layers"):
        return action.fcurves
    slot = action.slots.new("OBJECT", build.RIG_NAME)
    strip = action.layers.new("Layer").strips.new(type="KEYFRAME")
    return strip.channelbag(slot, ensure=True).fcurves
