"""Which way the bones of a rig point and bend, whoever drew them. Knows nothing of Blender."""

from dataclasses import replace

import numpy as np

from ..hand.skinning import TWIST
from ..scene.checks import Refusal
from . import roles

ODD_DEG = 30.0
"""A bone drawn this far away from where its segment goes (imported rigs point anywhere) does not say where it goes;
the next joint does, or the skin it carries. The made hand's bones are within 16 degrees."""


class RigError(Refusal):
    """The hand's rig cannot be read; the message says why and what to do."""


def with_axes(rig, role_names, choice):
    """The rig with flexion, twist and abduction axes: flexion by `choice`, else from the line of the knuckles.

    Raises `RigError` where the knuckles must say it and there is only one.
    """
    index = {role: rig.names.index(name) for role, name in role_names.items() if name in rig.names}
    chosen = {"X": (0, 1.0), "NEG_X": (0, -1.0), "Z": (2, 1.0), "NEG_Z": (2, -1.0)}.get(choice)
    along = {role: rig.rest[bone, :3, 1] for role, bone in index.items()}
    if chosen:
        flexion = {role: rig.rest[bone, :3, chosen[0]] * chosen[1] for role, bone in index.items()}
    else:
        along |= {role: segment for role, segment in _segments(rig, index).items() if _is_odd(segment, along[role])}
        flexion = _knuckle_axes(rig, index, along)
    axes = rig.axes.copy()
    for role in flexion:
        across = flexion[role] - along[role] * (along[role] @ flexion[role])
        across /= np.linalg.norm(across)
        frame = np.stack([across, along[role], np.cross(across, along[role])], axis=1)
        axes[index[role]] = rig.rest[index[role], :3, :3].T @ frame
    return replace(rig, axes=axes)


def odd_lengths(rig):
    """Bone -> length of its segment, for bones that are drawn elsewhere than their segment goes."""
    out = {}
    for bone in np.flatnonzero(np.abs(rig.axes[:, :, TWIST] - [0.0, 1.0, 0.0]).max(axis=1) > 1e-6):
        head, along = rig.rest[bone, :3, 3], roles.along(rig, bone)
        reach = (rig.rest[rig.parents == bone, :3, 3] - head) @ along
        skin = (rig.vertices[rig.weights[:, bone] > 0.5] - head) @ along
        out[int(bone)] = float(reach.max()) if len(reach) and reach.max() > 0.0 else float(skin.max(initial=0.0))
    return out


def _is_odd(segment, drawn):
    """Whether the bone is drawn away from its segment."""
    return np.degrees(np.arccos(np.clip(segment @ drawn, -1.0, 1.0))) > ODD_DEG


def _segments(rig, index):
    """Unit direction of each segment in rig space: to the next joint of its digit, else to the skin it carries."""
    out = {}
    for role, bone in index.items():
        digit, _, segment = role.partition("_")
        later = roles.SEGMENTS[roles.SEGMENTS.index(segment) + 1 :] if segment else ()
        following = next((index[f"{digit}_{name}"] for name in later if f"{digit}_{name}" in index), None)
        carried = rig.vertices[rig.weights[:, bone] > 0.5]
        if following is not None:
            goal = rig.rest[following, :3, 3]
        elif segment and len(carried):
            goal = carried.mean(axis=0)
        else:
            continue
        step = goal - rig.rest[bone, :3, 3]
        if np.linalg.norm(step) > 0.0:
            out[role] = step / np.linalg.norm(step)
    return out


def _knuckle_axes(rig, index, along):
    """Flexion axis in rig space per role: the knuckle line, signed so that the rest bend of the fingers is flexion.

    The thumb bends about the axis that carries it towards the little finger's base.
    """
    present = [f for f in roles.FINGERS if f"{f}_proximal" in index]
    if len(present) < 2:
        raise RigError("the flexion axis needs two fingers; choose the axis in the bone settings instead")
    heads = np.array([rig.rest[index[f"{f}_proximal"], :3, 3] for f in present])
    across = (heads[0] - heads[-1]) / np.linalg.norm(heads[0] - heads[-1])
    across = across * _bend_sign(rig, index, along, across)
    out = {role: across for role in index if not role.startswith("thumb")}
    if "thumb_metacarpal" in index:
        start = rig.rest[index["thumb_metacarpal"], :3, 3]
        facing = np.cross(across, along[f"{present[0]}_proximal"])
        goal = heads[-1] - start + 0.8 * np.linalg.norm(heads[-1] - start) * facing
        for role in ("thumb_metacarpal", "thumb_proximal", "thumb_distal"):
            if role in index:
                turn = np.cross(along[role], goal)
                out[role] = turn / np.linalg.norm(turn)
    return out


def _bend_sign(rig, index, along, across):
    """+1 or -1, so that the rest bend is flexion: of the middle phalanges, which joints alone say, else of the last."""
    present = [f for f in roles.FINGERS if f"{f}_proximal" in index]
    bend = 0.0
    for segment in ("middle", "distal"):
        bent = [f for f in present if f"{f}_{segment}" in index]
        if abs(bend) < 0.05:
            bend = sum(across @ np.cross(along[f"{f}_proximal"], along[f"{f}_{segment}"]) for f in bent)
    if abs(bend) < 0.05 and "thumb_distal" in index:
        tip = rig.rest[index["thumb_distal"], :3, 3] - rig.rest[index[f"{present[0]}_proximal"], :3, 3]
        bend = np.cross(across, along[f"{present[0]}_proximal"]) @ tip
    return 1.0 if bend >= 0.0 else -1.0
