"""Made rigs as Blender objects: an armature, and a mesh with an octahedron around the middle of every skin bone."""

import bpy
import numpy as np
from mathutils import Vector

_AROUND = np.concatenate([np.eye(3), -np.eye(3)])
_FACES = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]


def _middle(made, row):
    """Middle of a bone's segment: halfway to the next bone, or as far on as the bone before goes."""
    following = next((other[2] for other in made.builder.rows if other[1] == row[0]), None)
    before = next((other[2] for other in made.builder.rows if other[0] == row[1]), row[2])
    return row[2] + 0.5 * (following - row[2] if following is not None else 0.8 * (row[2] - before))


def into_scene(made, only=None, scale=0.001):
    """`(mesh object, armature object)` of a `kinds.Made`, the scene's hand; `only`: names of bones that get skin.

    Bones point up whatever their segment does, as exchange files draw them.
    """
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, parent, place, has_skin in made.builder.rows:
        bone = data.edit_bones.new(name)
        bone.head = Vector(place * scale)
        bone.tail = bone.head + Vector((0.0, 0.0, 12.0 * scale))
        bone.use_deform = has_skin
        bone.parent = data.edit_bones.get(parent) if parent else None
    bpy.ops.object.mode_set(mode="OBJECT")
    rows = [row for row in made.builder.rows if row[3] and (only is None or row[0] in only)]
    places = np.concatenate([_middle(made, row) + 6.0 * _AROUND for row in rows]) * scale
    faces = [tuple(6 * k + corner for corner in face) for k in range(len(rows)) for face in _FACES]
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(places.tolist(), [], faces)
    body = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(body)
    for k, row in enumerate(rows):
        body.vertex_groups.new(name=row[0]).add(list(range(6 * k, 6 * k + 6)), 1.0, "REPLACE")
    body.parent = rig
    body.modifiers.new("Armature", "ARMATURE").object = rig
    bpy.context.scene.thenar.hand = body
    bpy.context.view_layer.update()
    return body, rig
