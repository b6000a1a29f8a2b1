"""The regions of a rigged hand painted from its bones: one vertex group and one material each."""

import bpy
import numpy as np

from .. import languages
from ..hand.operators import can_pose
from ..hand_bones import reading, roles
from ..hand_look import normals
from ..operators import running
from ..operators.regions import add_region
from ..rigs import skin_regions
from ..scene import checks, mesh, regions
from ..scene.checks import Refusal

_SAME_PLACE = 1e-6
"""Vertices nearer than this share of the mesh's size are one: exchange files double them at the seams of their maps."""


def from_bones(context, hand):
    """Paint the palmar regions of `hand` and list each with a material of its kind; returns their names.

    Groups of these names are painted over, others and the materials of others stay. The mesh is not touched before
    all is known. Raises `Refusal` if the bones are not found, or hardly any skin faces the palm's side.
    """
    checks.check_hand(context, hand)
    numbers = region_numbers(context, hand)
    present = [name for k, name in enumerate(skin_regions.NAMES) if (numbers == k).sum() >= 3]
    if len(present) < 3:
        raise Refusal(
            f"hardly any skin of '{hand.name}' lies on the palm's side of its bones; check the bones and their "
            "flexion axis under Bones, and that the faces point outwards"
        )
    bone_names = set(reading.armature_of(hand).data.bones.keys())
    active = hand.vertex_groups.active_index
    for name in present:
        group = name if name not in bone_names else f"{name} region"
        regions.paint(hand, group, (numbers == skin_regions.NAMES.index(name)).astype(np.float32))
        if group not in hand.thenar.materials:
            add_region(hand, group)
    hand.vertex_groups.active_index = active
    return present


def region_numbers(context, hand):
    """Region per vertex (n,), a number in `skin_regions.NAMES` or -1. Raises `Refusal` if the bones are not known."""
    rig, stored = reading.read_rig(context, hand)
    joints = roles.resolve(rig, stored)
    facing = normals.outward_normals(rig.vertices, mesh.triangles(hand.data))
    edges = np.empty(2 * len(hand.data.edges), np.int32)
    hand.data.edges.foreach_get("vertices", edges)
    return skin_regions.from_bones(rig, joints, facing, _with_seams(rig.vertices, edges.reshape(-1, 2)))


def _with_seams(vertices, edges):
    """Edges (e, 2) and one more between any two vertices at the same place."""
    step = max(np.ptp(vertices, axis=0).max() * _SAME_PLACE, 1e-12)
    cells = np.round((vertices - vertices.min(axis=0)) / step).astype(np.int64)
    order = np.lexsort(cells.T)
    same = (cells[order[1:]] == cells[order[:-1]]).all(axis=1)
    return np.concatenate([edges, np.stack([order[:-1][same], order[1:][same]], axis=1)])


class THENAR_OT_regions_from_bones(bpy.types.Operator):
    """Paint the skin's regions from the bones and the palm's side: finger pads, palm, thenar, hypothenar"""

    bl_idname = "thenar.regions_from_bones"
    bl_label = "Regions from Bones"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return can_pose(cls, context)

    def execute(self, context):
        hand = context.scene.thenar.hand
        found = running.attempt(self, from_bones, context, hand)
        if found is None:
            return {"CANCELLED"}
        words = "{count} regions from the bones of '{name}'"
        self.report({"INFO"}, languages.report(words, count=len(found), name=hand.name))
        return {"FINISHED"}


CLASSES = (THENAR_OT_regions_from_bones,)
