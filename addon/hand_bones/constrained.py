"""Fingers that the constraints of a control rig hold: read where they stand, posed with these muted, and given back.

What was muted and how the bones were posed is kept on the armature object, so that file, undo and reload carry it.
"""

import json

import bpy
import numpy as np
from mathutils import Matrix

from ..hand.skinning import Rig, pose_matrices
from . import channels, roles
from .rig_axes import RigError

FREE_CONSTRAINTS = {"LIMIT_ROTATION", "LIMIT_LOCATION", "LIMIT_SCALE", "LIMIT_DISTANCE"}
"""Constraints that may stand on a bone the fitter turns; any other would overrule it."""

_OFF = 1e-3
"""How far a bone may be from the pose that was written: of its axes, and of its length."""


def digits_of(armature, stored):
    """Names of the bones that have a part, the wrist left out: it is never turned."""
    return [name for role, name in stored.items() if role != roles.WRIST and name in armature.pose.bones]


def holders(armature, names):
    """`(bone, constraint)` of the constraints that overrule what is written to these bones."""
    return [
        (armature.pose.bones[name], constraint)
        for name in names
        for constraint in armature.pose.bones[name].constraints
        if constraint.type not in FREE_CONSTRAINTS and not constraint.mute and constraint.influence > 0.0
    ]


def is_constrained(armature, stored):
    """Whether constraints hold fingers, or were muted for a grasp."""
    names = digits_of(armature, stored)
    return bool(holders(armature, names)) or bool(set(names) & set(_record(armature)["pose"]))


def is_led(armature, stored):
    """Whether a constraint holds a bone above the fingers, as inverse kinematics hold an arm."""
    above = {each.name for name in digits_of(armature, stored) for each in armature.pose.bones[name].parent_recursive}
    return bool(holders(armature, sorted(above)))


def is_muted(armature):
    """Whether constraints are muted for a grasp."""
    return bool(armature.thenar_bones.muted)


def check_own(armature):
    """Raises `RigError` where the constraints cannot be muted for good."""
    if armature.library is not None or armature.override_library is not None:
        raise RigError(
            f"constraints hold the fingers of '{armature.name}', which is linked from another file, so that they "
            "cannot be muted; use Object > Relations > Make Local > Selected Objects first"
        )


def linked(rig, stored):
    """The rig with each digit's bones one below the other, whatever they hang on; parents stand before children."""
    parents = rig.parents.copy()
    for role, name in stored.items():
        before = roles.before_of(role, stored) or stored.get(roles.WRIST)
        if role == roles.WRIST or name not in rig.names or before not in rig.names:
            continue
        bone, above = rig.names.index(name), rig.names.index(before)
        if not _is_above(parents, above, bone) and not _is_above(parents, bone, above):
            parents[bone] = above
    order = np.array(sorted(range(len(parents)), key=lambda bone: (_depth(parents, bone), bone)), dtype=int)
    place = np.empty(len(order), int)
    place[order] = np.arange(len(order))
    above = np.where(parents >= 0, place[parents], -1)[order]
    names = tuple(rig.names[bone] for bone in order)
    return Rig(
        names, above, rig.rest[order], rig.axes[order], rig.basis[order], rig.vertices, rig.weights[:, order],
        rig.world_from_rig,
    )  # fmt: skip


def evaluated_basis(armature, rig, resting):
    """Local transforms (b, 4, 4) that put every bone where it stands now; those named in `resting` stand at rest."""
    posed = np.array([armature.pose.bones[name].matrix for name in rig.names], dtype=np.float64)
    above = np.where((rig.parents >= 0)[:, None, None], posed[rig.parents], np.eye(4))
    basis = np.linalg.inv(above @ rig.from_parent) @ posed
    basis[[name in resting for name in rig.names]] = np.eye(4)
    return basis


def write(armature, rig, joints, angles):
    """Put fingers into a pose with the constraints muted that hold them, and remember these.

    Raises `RigError`, with everything as before, where a bone does not get there.
    """
    bones = sorted(bone for role, bone in joints.bones.items() if role != roles.WRIST)
    before, posed = state_of(armature), pose_matrices(rig, angles)
    names = [rig.names[bone] for bone in bones]
    own = {name: channels.kept(armature.pose.bones[name]) for name in names}
    _mute(armature, names, {name for bone, name in zip(bones, names, strict=True) if not _hangs(armature, rig, bone)})
    for bone, name in zip(bones, names, strict=True):
        above = armature.data.bones[name].parent
        parent = -1 if above is None else rig.names.index(above.name)
        at_rest = rig.rest[bone] if above is None else posed[parent] @ np.linalg.inv(rig.rest[parent]) @ rig.rest[bone]
        armature.pose.bones[name].matrix_basis = Matrix((np.linalg.inv(at_rest) @ posed[bone]).tolist())
    bpy.context.view_layer.update()
    missed = next((name for bone, name in zip(bones, names, strict=True) if _misses(armature, name, posed[bone])), None)
    if missed is not None:
        for name, values in own.items():
            channels.restore(armature.pose.bones[name], values)
        reset(armature, before)
        raise RigError(
            f"bone '{missed}' did not take the pose, though its constraints were muted: keys or a driver hold it; mute "
            "them, or pose the fingers by their controls"
        )


def back(armature):
    """Give the fingers back to their controls. Returns how many constraints hold again."""
    record, count = _record(armature), 0
    for bone, name in record["constraints"]:
        constraint = armature.pose.bones[bone].constraints.get(name) if bone in armature.pose.bones else None
        if constraint is not None:
            constraint.mute = False
            count += 1
    for bone, values in record["pose"].items():
        if bone in armature.pose.bones:
            channels.restore(armature.pose.bones[bone], values)
    armature.thenar_bones.muted = ""
    return count


def state_of(armature):
    """What `reset` takes: the record, and which constraints of bones are muted."""
    mutes = [(bone.name, each.name, each.mute) for bone in armature.pose.bones for each in bone.constraints]
    return armature.thenar_bones.muted, mutes


def reset(armature, state):
    """Bring record and constraints back to a `state_of`; the pose is the caller's."""
    armature.thenar_bones.muted = state[0]
    for bone, name, mute in state[1]:
        constraint = armature.pose.bones[bone].constraints.get(name)
        if constraint is not None and constraint.mute != mute:
            constraint.mute = mute
    bpy.context.view_layer.update()


def _hangs(armature, rig, bone):
    """Whether the bone hangs on the one that `rig` has it on."""
    above = armature.data.bones[rig.names[bone]].parent
    return (above.name if above is not None else "") == (rig.names[rig.parents[bone]] if rig.parents[bone] >= 0 else "")


def _mute(armature, names, loose):
    """Mute what holds the bones, and the limits of those in `loose`: these count from another bone than the digit's.

    The first record of a bone is the one that counts.
    """
    record = _record(armature)
    limits = [(armature.pose.bones[name], each) for name in loose for each in armature.pose.bones[name].constraints]
    limits = [(bone, each) for bone, each in limits if each.type in FREE_CONSTRAINTS and not each.mute]
    for bone, constraint in [*holders(armature, names), *limits]:
        record["constraints"].append([bone.name, constraint.name])
        constraint.mute = True
    for name in names:
        record["pose"].setdefault(name, channels.kept(armature.pose.bones[name]))
    armature.thenar_bones.muted = json.dumps(record)


def _record(armature):
    text = armature.thenar_bones.muted
    return json.loads(text) if text else {"constraints": [], "pose": {}}


def _misses(armature, name, goal):
    found = np.array(armature.pose.bones[name].matrix, dtype=np.float64)
    far = np.linalg.norm(found[:3, 3] - goal[:3, 3]) / max(armature.data.bones[name].length, 1e-9)
    return far > _OFF or np.abs(found[:3, :3] - goal[:3, :3]).max() > _OFF


def _is_above(parents, above, bone):
    while bone >= 0:
        if bone == above:
            return True
        bone = parents[bone]
    return False


def _depth(parents, bone):
    depth = 0
    while parents[bone] >= 0:
        bone, depth = parents[bone], depth + 1
    return depth
