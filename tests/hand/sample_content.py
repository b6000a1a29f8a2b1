"""Run in a process of its own: makes the files of some samples and prints a digest of what each holds, part by part.

Bytes of the files are not compared: Blender writes addresses and times into them.
"""

import hashlib
import json
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import thenar_blender
from thenar_blender.grasp import samples


def digest(*parts):
    """Hex digest of arrays and of whatever else has a fixed text."""
    out = hashlib.sha256()
    for part in parts:
        out.update(part.tobytes() if isinstance(part, np.ndarray) else repr(part).encode())
    return out.hexdigest()[:16]


def attribute(found):
    """The values of a mesh attribute."""
    kinds = {"FLOAT": ("value", 1, np.float32), "INT": ("value", 1, np.int32), "BOOLEAN": ("value", 1, bool)}
    kinds |= {"FLOAT_VECTOR": ("vector", 3, np.float32), "FLOAT_COLOR": ("color", 4, np.float32)}
    kinds |= {"INT32_2D": ("value", 2, np.int32)}
    field, width, kind = kinds[found.data_type]
    values = np.empty(width * len(found.data), kind)
    found.data.foreach_get(field, values)
    return values


def mesh_parts(obj):
    """Digests of a mesh: positions and faces, attributes, vertex groups, materials."""
    mesh = obj.data
    yield "attributes", [(found.name, digest(attribute(found))) for found in mesh.attributes]
    yield "groups", [group.name for group in obj.vertex_groups]
    yield "weights", digest([[(s.group, s.weight) for s in vertex.groups] for vertex in mesh.vertices])
    yield "materials", [digest(*values_of_tree(material.node_tree)) for material in mesh.materials]
    yield "regions", [(m.name, m.preset, m.thickness_mm, m.g0_kpa, m.g_lim_kpa) for m in obj.thenar.materials]


def values_of_tree(tree):
    """Nodes, their unlinked values and their links, as texts."""
    for node in tree.nodes:
        values = [tuple(np.ravel(socket.default_value)) for socket in node.inputs if hasattr(socket, "default_value")]
        yield node.bl_idname, node.name, values
    for link in tree.links:
        yield link.from_node.name, link.from_socket.identifier, link.to_node.name, link.to_socket.identifier


def content():
    """What the open file holds, by name of the part."""
    out = {}
    for obj in sorted(bpy.context.scene.objects, key=lambda obj: obj.name):
        out[obj.name] = {"kind": obj.type, "place": digest(np.array(obj.matrix_world))}
        if obj.type == "MESH":
            out[obj.name] |= {part: digest(value) for part, value in mesh_parts(obj)}
        if obj.type == "ARMATURE":
            out[obj.name]["rest"] = digest([np.array(bone.matrix_local).tolist() for bone in obj.data.bones])
            out[obj.name]["pose"] = digest([np.array(bone.matrix_basis).tolist() for bone in obj.pose.bones])
        if obj.type in {"LIGHT", "CAMERA"}:
            named = ("energy", "size", "lens", "clip_start", "clip_end")
            out[obj.name]["settings"] = [getattr(obj.data, name) for name in named if hasattr(obj.data, name)]
    return out


def run(kinds):
    """Digests by kind of sample, read from its file."""
    samples.SAMPLES = {kind: samples.SAMPLES[kind] for kind in kinds}
    thenar_blender.register()
    out = {}
    with tempfile.TemporaryDirectory() as folder:
        for path in samples.make_samples(Path(folder)):
            bpy.ops.wm.open_mainfile(filepath=str(path))
            out[path.stem] = content()
    thenar_blender.unregister()
    return out


if __name__ == "__main__":
    print("CONTENT " + json.dumps(run(sys.argv[1:])), flush=True)
