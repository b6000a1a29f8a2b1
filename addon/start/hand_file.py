"""The operator that reads a rigged hand from a file: all that the file holds stays, and its hand is taken."""

from pathlib import Path

import bpy
from bpy_extras.io_utils import ImportHelper

from ..operators import polling, running, selecting
from ..product_files import formats, importing
from ..scene.checks import Refusal
from . import picking

BLEND = ".blend"
SUFFIXES = (".glb", ".gltf", ".fbx", ".usd", ".usda", ".usdc", ".usdz", BLEND)
"""Files that may hold an armature."""
STUB = 0.03
"""Length at which bones that carry no other are drawn, as a share of the armature's longest side."""
LISTED = "GLB, FBX, USD or .blend"


class THENAR_OT_add_hand(bpy.types.Operator, ImportHelper):
    """Read a rigged hand or body from a file (GLB, FBX, USD, .blend), choose its hand, and find bones and regions"""

    bl_idname = "thenar.add_hand"
    bl_label = "Add Hand from File"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: bpy.props.StringProperty(default=";".join(f"*{each}" for each in SUFFIXES), options={"HIDDEN"})
    filepath: bpy.props.StringProperty(
        name="File", description="The hand's file: GLB, FBX, USD or .blend", subtype="FILE_PATH"
    )

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.wrong_mode(context), polling.busy(), polling.live(context))

    def execute(self, context):
        selecting.to_object_mode(context)
        hand = running.attempt(self, add_hand, context, bpy.path.abspath(self.filepath))
        if hand is None:
            return {"CANCELLED"}
        picking.take(self, context, hand)
        return {"FINISHED"}


def add_hand(context, path):
    """Read a file into the scene, and return its hand's mesh, selected and active.

    Raises `Refusal`, with the scene as before, where the file cannot be read or holds no mesh.
    """
    path, before = Path(path), importing.everything()
    if path.suffix.lower() not in SUFFIXES:
        raise Refusal(f"'{path.name}' cannot be read as a hand; export it with its bones as {LISTED}")
    try:
        if path.suffix.lower() == BLEND:
            _append(context, path)
        else:
            found = formats.check(path)
            with importing.kept(context):
                importing.run(found, path, disable_bone_shape=True)
            _thin_bones(context, before)
        context.view_layer.update()
        hand = _hand_among(context, [obj for obj in context.scene.objects if _is_new(obj, before)], path)
    except Exception as error:
        importing.remove_new(before, [])
        if isinstance(error, Refusal):
            raise
        raise Refusal(
            f"'{path.name}' could not be read: {importing.reason(error)}; export it again, or as another format"
        ) from None
    for other in context.selected_objects:
        other.select_set(False)
    hand.hide_set(False)
    hand.select_set(True)
    context.view_layer.objects.active = hand
    return hand


def _thin_bones(context, before):
    """Draw bones of new armatures as lines inside the hand: octahedra in front of it hide it.

    A bone that carries no other ends where the importer guesses; it is drawn short, its direction stays.
    """
    for obj in [obj for obj in context.scene.objects if obj.type == "ARMATURE" and _is_new(obj, before)]:
        obj.show_in_front, obj.data.display_type = False, "STICK"
        if not obj.visible_get():
            continue
        short = STUB * max(obj.dimensions)
        context.view_layer.objects.active = obj
        bpy.ops.object.mode_set(mode="EDIT")
        for bone in obj.data.edit_bones:
            if not bone.children:
                bone.length = min(bone.length, short / max(obj.matrix_world.median_scale, 1e-9))
        bpy.ops.object.mode_set(mode="OBJECT")


def _append(context, path):
    """Copy armatures of a .blend into the scene, with the meshes that they bend and the objects they hang on."""
    if not path.is_file():
        raise Refusal(f"there is no file '{path.name}' in '{path.parent}'; choose the hand's file")
    with bpy.data.libraries.load(str(path)) as (held, wanted):
        wanted.objects = held.objects
    objects = [obj for obj in wanted.objects if obj is not None]
    armatures = [obj for obj in objects if obj.type == "ARMATURE"]
    kept = {*armatures, *(mesh for armature in armatures for mesh in picking.bent_by(objects, armature))}
    kept = kept or {obj for obj in objects if obj.type == "MESH"}
    for obj in [*kept]:
        while obj.parent is not None:
            obj = obj.parent
            kept.add(obj)
    for obj in objects:
        if obj in kept:
            context.scene.collection.objects.link(obj)
    bpy.data.batch_remove([obj for obj in objects if obj not in kept and obj.users == 0])


def _hand_among(context, objects, path):
    """The mesh among `objects` that is bent as a hand, else the largest. Raises `Refusal` if there is no mesh."""
    armatures = [obj for obj in objects if obj.type == "ARMATURE"]
    bent = [mesh for armature in armatures for mesh in picking.bent_by(objects, armature)]
    meshes = bent or [obj for obj in objects if obj.type == "MESH" and len(obj.data.polygons)]
    if not meshes:
        raise Refusal(f"'{path.name}' holds no mesh; export the hand's skin with its bones as {LISTED}")
    return picking.best_of(context, meshes)


def _is_new(obj, before):
    return obj.session_uid not in before["objects"]


CLASSES = (THENAR_OT_add_hand,)
