"""Handles of a made hand's bones: rings around the fingers, in place of bones drawn through the skin."""

import bpy
import numpy as np

RING = "Thenar Bone Ring"
CORNERS = 40
CLEARANCE = 1.12
"""Radius of a ring over the largest distance of the skin around it from the bone."""
WITHIN = 0.2
"""Skin within this share of the bone's length from its middle counts."""


def put_on(rig, arrays, unit):
    """Give each bone that a finger or the wrist turns by a ring that fits the skin.

    `arrays`: the hand's `Rig`, mm; `unit`: Blender units per mm.

    A custom shape of the user's own is kept.
    """
    for index, name in enumerate(arrays.names):
        pose_bone = rig.pose.bones[name]
        if not _is_handle(name) or not (pose_bone.custom_shape is None or _is_ring(pose_bone.custom_shape)):
            continue
        length = rig.data.bones[name].length
        pose_bone.custom_shape = _ring()
        pose_bone.use_custom_shape_bone_size = False
        pose_bone.custom_shape_scale_xyz = [_radius_mm(arrays, index, length / unit) * unit] * 3
        pose_bone.custom_shape_translation = (0.0, 0.5 * length, 0.0)


def _is_handle(name):
    return name == "carpus" or name.endswith(("_proximal", "_middle", "_distal")) or name == "thumb_metacarpal"


def _radius_mm(arrays, index, length_mm):
    local = (arrays.vertices - arrays.rest[index, :3, 3]) @ arrays.rest[index, :3, :3]
    own = arrays.weights[:, index] > 0.5
    around = own & (np.abs(local[:, 1] - 0.5 * length_mm) < WITHIN * length_mm)
    around = around if around.any() else own
    return CLEARANCE * float(np.hypot(local[around, 0], local[around, 2]).max())


def _is_ring(shape):
    return shape.name.startswith(RING)


def _ring():
    """A circle about +Y of radius 1; in no collection, so it is seen at the bones alone."""
    known = bpy.data.objects.get(RING)
    if known is not None and known.type == "MESH" and len(known.data.vertices) == CORNERS:
        return known
    turns = np.linspace(0.0, 2.0 * np.pi, CORNERS, endpoint=False)
    points = np.stack([np.cos(turns), np.zeros(CORNERS), np.sin(turns)], axis=1)
    mesh = bpy.data.meshes.new(RING)
    mesh.from_pydata(points.tolist(), [(k, (k + 1) % CORNERS) for k in range(CORNERS)], [])
    return bpy.data.objects.new(RING, mesh)
