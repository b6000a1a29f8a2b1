"""Handles of a made hand's bones: rings around the fingers, in place of bones drawn through the skin."""

import bpy
import numpy as np

RING = "Thenar Bone Ring"
CORNERS = 40
CLEARANCE = 1.12
"""Radius of a ring over the largest distance of the skin around it from its middle."""
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
        (x, z), radius = _circle_mm(arrays, index, length / unit)
        pose_bone.custom_shape = _ring()
        pose_bone.use_custom_shape_bone_size = False
        pose_bone.custom_shape_scale_xyz = [radius * unit] * 3
        pose_bone.custom_shape_translation = (x * unit, 0.5 * length, z * unit)


def _is_handle(name):
    return name == "carpus" or name.endswith(("_proximal", "_middle", "_distal")) or name == "thumb_metacarpal"


def _circle_mm(arrays, index, length_mm):
    """Middle across the bone (x, z) and radius of a circle around the skin at the bone's middle."""
    local = (arrays.vertices - arrays.rest[index, :3, 3]) @ arrays.rest[index, :3, :3]
    below = np.flatnonzero(arrays.parents == index)
    joined = [index, *below, arrays.parents[index]] if len(below) > 1 else [index]  # all skin around the wrist
    own = arrays.weights[:, joined].sum(axis=1) > 0.5
    around = own & (np.abs(local[:, 1] - 0.5 * length_mm) < WITHIN * length_mm)
    section = local[around if around.any() else own][:, [0, 2]]
    middle = 0.5 * (section.min(axis=0) + section.max(axis=0))
    return middle, CLEARANCE * float(np.linalg.norm(section - middle, axis=1).max())


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
