"""Makes .blend files of a body with MPFB's default rig and with a generated Rigify rig, for `rig_to_map.py`.

Not a test of pytest: it wants the files `base.obj`, `rig.default.json` and `rig.human_toes.json` of MakeHuman's MPFB
(github.com/makehumancommunity/mpfb2, src/mpfb/data; CC0), which are not in this repository. Body, bones and their
places are those of MPFB; the weights are Blender's automatic ones. `python public_rigs.py FOLDER OUT`.
"""

import json
import sys
from pathlib import Path

import bpy

METRES_PER_DECIMETRE = 0.1


def main(folder, out):
    """Write OUT/mpfb.blend and OUT/rigify.blend."""
    make(folder, "rig.default.json", out / "mpfb.blend", is_rigify=False)
    make(folder, "rig.human_toes.json", out / "rigify.blend", is_rigify=True)


def make(folder, bones, path, is_rigify):
    """A body on a rig in an empty file; Rigify's bones are a metarig, from which its rig is generated."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="rigify")
    places, faces = read_base(folder / "base.obj")
    body = add_body(places, faces)
    rig = add_bones(folder / bones, places, faces)
    if is_rigify:
        metarig = rig
        shown = metarig.data.collections.new("All")
        shown.rigify_ui_row = 1
        for bone in metarig.data.bones:
            shown.assign(bone)
        activate(metarig)
        bpy.ops.pose.rigify_generate()
        rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE" and obj is not metarig)
        bpy.data.objects.remove(metarig)
        for shape in [obj for obj in bpy.data.objects if obj.name.startswith("WGT")]:
            shape.hide_viewport = True
    body.select_set(True)
    activate(rig)
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    bare = sum(not vertex.groups for vertex in body.data.vertices)
    print(path.name, len(rig.data.bones), "bones,", len(body.data.vertices), "vertices,", bare, "of no bone")
    bpy.ops.wm.save_as_mainfile(filepath=str(path))


def read_base(path):
    """Every vertex (x, y, z), z up, in metres, and the faces by group; joints are groups of small cubes."""
    places, faces, group = [], {}, ""
    for line in path.read_text().splitlines():
        word, _, rest = line.partition(" ")
        if word == "v":
            x, y, z = (METRES_PER_DECIMETRE * float(each) for each in rest.split())
            places.append((x, -z, y))
        elif word == "g":
            group = rest.strip()
        elif word == "f":
            faces.setdefault(group, []).append([int(each.partition("/")[0]) - 1 for each in rest.split()])
    return places, faces


def add_body(places, faces):
    """The body alone, without clothes' helpers and joint cubes."""
    used = sorted({vertex for face in faces["body"] for vertex in face})
    place = {vertex: number for number, vertex in enumerate(used)}
    mesh = bpy.data.meshes.new("Body")
    shown = [[place[vertex] for vertex in face] for face in faces["body"]]
    mesh.from_pydata([places[vertex] for vertex in used], [], shown)
    body = bpy.data.objects.new("Body", mesh)
    bpy.context.collection.objects.link(body)
    return body


def place_of(described, places, faces):
    """Where an end of a bone is: in the middle of a joint's cube, or of vertices."""
    if described["strategy"] == "CUBE":
        chosen = sorted({vertex for face in faces[described["cube_name"]] for vertex in face})
    else:
        chosen = described.get("vertex_indices") or [described["vertex_index"]]
    return [sum(places[vertex][axis] for vertex in chosen) / len(chosen) for axis in range(3)]


def add_bones(path, places, faces):
    """An armature of MPFB's file: heads, tails, rolls, parents, and Rigify's types where it has them."""
    described = json.loads(path.read_text())
    rows = described.get("bones", described)
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.collection.objects.link(rig)
    activate(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    made = {}
    for name, row in rows.items():
        bone = made[name] = rig.data.edit_bones.new(name)
        bone.head, bone.tail = (place_of(row[end], places, faces) for end in ("head", "tail"))
        bone.roll = row["roll"]
    for name, row in rows.items():
        if row.get("parent"):
            made[name].parent = made[row["parent"]]
            made[name].use_connect = row["use_connect"]
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, row in rows.items():
        typed = row.get("rigify") or {}
        rig.pose.bones[name].rigify_type = typed.get("rigify_type", "")
        for key, value in (typed.get("rigify_parameters") or {}).items():
            if not isinstance(value, list):  # lists name collections of bones
                setattr(rig.pose.bones[name].rigify_parameters, key, value)
    return rig


def activate(obj):
    """Select it as the active object, in Object Mode."""
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj


if __name__ == "__main__":
    main(*(Path(argument) for argument in sys.argv[-2:]))
