"""The pads of the hand and how deep each lies in a product. Knows nothing of Blender or of the native module.

A pad is one region of palmar skin; its depth is the mean over its four deepest vertices, mm, positive inside.
"""

from dataclasses import dataclass

import numpy as np

from ..hand_bones.roles import FINGERS, WRIST, along, flexion_axis

DEEPEST = 4
"""Vertices whose mean depth counts as the pad's, at 2.5 mm spacing about a sensel of a pressure mat."""

LIGHT_MM = {"distal": 2.6, "middle": 2.2, "proximal": 2.5, "palm": 3.0}
FIRM_MM = {"distal": 3.8, "middle": 3.2, "proximal": 4.0, "palm": 5.7}
"""Target depths by kind of pad: light is 2 to 3 mm, firm was chosen by the areas of Xie Table 6, which are a mat's and
larger than the skin's; the samples of Table 6 are then fitted to its force."""

DEEP_MM = 12.0
"""Tissue taken as this thick where a region's material stands on no bone."""

TISSUE_SHARE = 0.9
"""No vertex shall go deeper than this share of its tissue's thickness."""


@dataclass(frozen=True)
class Pad:
    """One pad: `kind` is distal, middle, proximal or palm; `rows` its vertices; `limit_mm` the deepest allowed."""

    name: str
    role: str
    kind: str
    rows: np.ndarray
    limit_mm: float


@dataclass(frozen=True)
class Skin:
    """Regions of a hand: `regions` (n,) index or -1; per region its name, kind ("finger" or "palm"), thickness, mm."""

    regions: np.ndarray
    names: tuple
    kinds: tuple
    thickness_mm: tuple


def pads_of(rig, joints, skin):
    """One `Pad` per region that has vertices; its role is that of the bone which carries most of it."""
    roles = {bone: role for role, bone in joints.bones.items()}
    out = []
    for region, name in enumerate(skin.names):
        rows = np.flatnonzero(skin.regions == region)
        if len(rows) < DEEPEST:
            continue
        carried = rig.weights[rows].sum(axis=0)
        role = next((roles[bone] for bone in np.argsort(-carried) if bone in roles), WRIST)
        kind = role.rpartition("_")[2]
        if skin.kinds[region] == "palm" or kind in ("metacarpal", WRIST):
            kind = "palm"
        out.append(Pad(name, role, kind, rows, TISSUE_SHARE * skin.thickness_mm[region]))
    return out


def skin_from_bones(rig, joints, normals):
    """A `Skin` for a hand without regions: the palmar side of every bone that has a role is one region.

    `normals` (n, 3): rest vertex normals in rig space. Tissue thickness is assumed 6 mm on fingers, 10 mm on the palm.
    """
    owner = np.where(rig.weights.any(axis=1), rig.weights.argmax(axis=1), -1)
    regions = np.full(len(owner), -1)
    names = []
    for role, bone in joints.bones.items():
        facing = normals @ palmar(rig, joints, role)
        rows = (owner == bone) & (facing > 0.2)
        if rows.sum() >= DEEPEST:
            regions[rows] = len(names)
            names.append(role)
    kinds = tuple("palm" if name == WRIST or name.endswith("metacarpal") else "finger" for name in names)
    thickness = tuple(10.0 if kind == "palm" else 6.0 for kind in kinds)
    return Skin(regions, tuple(names), kinds, thickness)


def palmar(rig, joints, role):
    """Unit direction in rig space in which the palm side of the bone of `role` faces at rest."""
    bone = joints.bones[role]
    if role == WRIST:
        bone = next(joints.bones[f"{f}_proximal"] for f in FINGERS if f"{f}_proximal" in joints.bones)
    facing = np.cross(flexion_axis(rig, bone), along(rig, bone))
    return facing / np.linalg.norm(facing)


def deepest(gap, count=DEEPEST):
    """Indices of the `count` smallest entries of `gap`, in a fixed order."""
    return np.sort(np.argsort(gap, kind="stable")[:count])


def pad_depth(gap_of_pad):
    """Depth of a pad, mm, from the gaps of its vertices; negative while it hangs clear."""
    return -float(gap_of_pad[deepest(gap_of_pad)].mean())
