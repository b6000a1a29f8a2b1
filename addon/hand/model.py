"""The made hand (`thenar.hand`) as a `Rig` and a `Skin`. Knows nothing of Blender."""

import numpy as np

from ..hand_bones.roles import guess, resolve
from ..hand_look.normals import vertex_normals
from .pads import Skin
from .skinning import ABDUCTION, FLEXION, Rig


def rig_of(made):
    """The rig of a hand made by `thenar.hand`, in mm, rig space and world alike."""
    bones = made["bones"]
    names = tuple(bone["name"] for bone in bones)
    parents = np.array([names.index(bone["parent"]) if bone["parent"] else -1 for bone in bones])
    rest = np.stack([bone_frame(bone) for bone in bones])
    weights = np.asarray(made["weights"], float)
    total = weights.sum(axis=1, keepdims=True)
    return Rig(
        names,
        parents,
        rest,
        np.tile(np.eye(3), (len(bones), 1, 1)),
        np.tile(np.eye(4), (len(bones), 1, 1)),
        np.asarray(made["vertices_mm"], float),
        weights / np.where(total > 0.0, total, 1.0),
        np.eye(4),
        vertex_normals(np.asarray(made["vertices_mm"], float), np.asarray(made["triangles"])),
    )


def tails_of(made):
    """Ends (b, 3) of the bones, mm."""
    return np.array([bone["tail_mm"] for bone in made["bones"]], float)


def bone_frame(bone):
    """rig_from_bone (4, 4) at rest: +Y along the bone, +X its flexion axis, +Z its palm side."""
    head, tail = np.array(bone["head_mm"], float), np.array(bone["tail_mm"], float)
    along = (tail - head) / np.linalg.norm(tail - head)
    facing = np.cross(bone["flexion_axis"], along)
    facing /= np.linalg.norm(facing)
    frame = np.eye(4)
    frame[:3, :3] = np.stack([np.cross(along, facing), along, facing], axis=1)
    frame[:3, 3] = head
    return frame


def skin_of(made):
    """Regions of a made hand."""
    return Skin(
        np.asarray(made["regions"]), tuple(made["region_names"]), tuple(made["kind"]), tuple(made["thickness_mm"])
    )


def limits_of(made, rig):
    """(bone, column) -> (low, high), turns from rest, radians, about the axes of `rig`."""
    out = {}
    for index, bone in enumerate(made["bones"]):
        out[index, FLEXION] = tuple(np.radians(bone["limits_deg"]["flexion"]))
        low, high = np.radians(bone["limits_deg"]["abduction"])
        out[index, ABDUCTION] = (low, high) if _is_left(made) else (-high, -low)
    return out


def _is_left(made):
    """Whether the hand is a left one: its index finger lies at smaller x than its little finger."""
    heads = {bone["name"]: bone["head_mm"][0] for bone in made["bones"]}
    return heads["index_proximal"] < heads["little_proximal"]


def joints_of(made, rig):
    """Roles of the made hand's bones, with its own limits."""
    return resolve(rig, guess(rig.names, rig.parents, rig.weights.any(axis=0)), limits_of(made, rig))
