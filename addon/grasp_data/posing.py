"""Poses of MANO and SMPL-X put onto the scene's hand: one as its pose, several as keyframes."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from ..hand.poses import POSES
from ..hand_bones import reading, roles
from ..scene import checks
from . import containers, joints, keying, parameters

LIMIT = "LIMIT_ROTATION"


@dataclass(frozen=True)
class Wish:
    """What the user chose: `side` of the file's pose (None: the hand's own), how its numbers are read, whether joint
    limits are kept, and of how many frames one is taken."""

    side: str | None = None
    is_pca: bool | None = None
    adds_mean: bool = True
    keeps_limits: bool = False
    step: int = 1


@dataclass(frozen=True)
class Done:
    """Frames that were read, scene frames that were keyed (0: a pose), the key in the file, and a remark or ""."""

    count: int
    keyed: int
    key: str
    remark: str


def steps(context, path, wish):
    """Pose the scene's hand by a file, as the steps of a computation: the hand changes at their end alone.

    Returns `Done`; raises `Refusal` with the hand as before.
    """
    hand = context.scene.thenar.hand
    checks.check_hand(context, hand)
    rig, role_names = reading.read_free_rig(context, hand)
    armature = reading.armature_of(hand)
    reading.check_unconstrained(armature, role_names)
    found = roles.resolve(rig, role_names, reading.own_limits(armature, rig))
    own = "right" if found.side > 0.0 else "left"
    side = wish.side or own
    values = yield partial(_apart, partial(containers.read, path))
    poses = parameters.find(values, parameters.Wish(side, wish.is_pca, wish.adds_mean), path.name)
    turns = poses.turns[:: wish.step] if side == own else joints.mirrored(poses.turns[:: wish.step])
    fitted = yield partial(_apart, partial(joints.fit, rig, found, POSES["flat"], turns, wish.keeps_limits))
    named = {rig.names[bone]: matrices for bone, matrices in fitted.turns.items()}
    rows = {}
    if len(turns) > 1:
        rows = yield partial(keying.channels, keying.modes(armature, named), named)
    _check_there(armature, named)
    muted = 0 if wish.keeps_limits else _mute_limits(armature, named)
    keyed = 0
    if rows:
        frames = scene_frames(context.scene, poses.frames[:: wish.step], poses.rate_hz)
        keying.key(armature, rows, frames)
        context.scene.frame_end = max(context.scene.frame_end, int(np.ceil(frames[-1])))
        context.scene.frame_set(context.scene.frame_start)
        keyed = len(frames)
    else:
        keying.pose(armature, {name: matrices[0] for name, matrices in named.items()})
    context.view_layer.update()
    return Done(len(turns), keyed, poses.key, _remark(fitted, muted))


def _check_there(armature, names):
    """Raise `Refusal` where the armature or a bone went while the file was read."""
    try:
        gone = next((name for name in names if name not in armature.pose.bones), None)
    except ReferenceError:
        raise checks.Refusal("the hand's armature was removed while the file was read; load the pose again") from None
    if gone is not None:
        raise checks.Refusal(f"bone '{gone}' was removed while the file was read; load the pose again")


def _apart(action, _cancel, _progress):
    """An action that counts no progress, as work for any thread."""
    return action()


def scene_frames(scene, frames, rate_hz):
    """Scene frames (f,) of a file's frames: from the scene's first on, at its rate; one for one without a rate."""
    ratio = 1.0 if rate_hz is None else scene.render.fps / scene.render.fps_base / rate_hz
    return scene.frame_start + (frames - frames[0]) * ratio


def _mute_limits(armature, names):
    """Switch off the joint limits that would change what is shown; returns of how many bones."""
    count = 0
    for name in names:
        limits = [c for c in armature.pose.bones[name].constraints if c.type == LIMIT and not c.mute]
        for limit in limits:
            limit.mute = True
        count += bool(limits)
    return count


def _remark(fitted, muted):
    if fitted.lost_deg >= 1.0:
        return f"joint limits took off up to {fitted.lost_deg:.0f} degrees, most at {fitted.lost_at}"
    return f"the joint limits of {muted} bones are switched off" if muted else ""
