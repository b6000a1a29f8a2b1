"""Which bone plays which part of a hand, how far it may bend, and how its angles are counted.

Knows nothing of Blender. Angles of the outside world are anatomical degrees: 0 is a straight joint, flexion is
positive, abduction is positive towards the thumb; inside, angles are turns from rest about the bone's own axes.
"""

import re
from dataclasses import dataclass

import numpy as np

from ..hand.skinning import ABDUCTION, FLEXION, TWIST
from ..scene.checks import Refusal

FINGERS = ("index", "middle", "ring", "little")
SEGMENTS = ("metacarpal", "proximal", "middle", "distal")
WRIST = "wrist"
ROLES = (
    WRIST,
    *(f"{finger}_{segment}" for finger in FINGERS for segment in SEGMENTS),
    "thumb_metacarpal",
    "thumb_proximal",
    "thumb_distal",
)
COLUMNS = {"flexion": FLEXION, "twist": TWIST, "abduction": ABDUCTION}

LIMITS_DEG = {
    "metacarpal": {"flexion": (0.0, 0.0)},
    "proximal": {"flexion": (-20.0, 90.0), "abduction": (-20.0, 20.0)},
    "middle": {"flexion": (0.0, 100.0)},
    "distal": {"flexion": (0.0, 80.0)},
    "ring_metacarpal": {"flexion": (0.0, 15.0)},
    "little_metacarpal": {"flexion": (0.0, 30.0)},
    "thumb_metacarpal": {"flexion": (-18.0, 50.0), "abduction": (-27.0, 18.0), "twist": (-40.0, 16.0)},
    "thumb_proximal": {"flexion": (-10.0, 55.0), "abduction": (-5.0, 5.0)},
    "thumb_distal": {"flexion": (-15.0, 80.0)},
}
"""Joint limits, anatomical degrees (e-hand.com; ring and little metacarpal after Sancho-Bru), for rigs without limits
of their own; metacarpals, the thumb's first joint and every abduction count from rest.

A negative twist of the thumb is pronation: its pad turns toward the fingers' pads. At -40 the pad turns by 78 degrees,
seen along the hand, from the thumb abducted and extended to full circumduction (111 with MP and IP bent by 40 and 20);
70 to 110 were measured in 27 people (Journal of Orthopaedic Research, repub.eur.nl/pub/59657). The joint alone turns by
17 degrees (Cooney et al. 1981, mean of 19 people): the MP joint has no twist here, so that this one carries its share.
"""

_FINGER_WORDS = (
    ("thumb", ("thumb", "pollex")),
    ("index", ("index", "pointer", "forefinger")),
    ("ring", ("ring",)),
    ("little", ("little", "pinky", "pinkie", "small")),
    ("middle", ("middle", "mid")),
)
_WRIST_WORDS = ("wrist", "hand", "carpus", "forearm")


class RoleError(Refusal):
    """A bone that the hand needs is missing; the message names the role and the remedy."""


@dataclass(frozen=True)
class Joints:
    """Bone indices by role, side (+1 right, -1 left), each bone's rest flexion, radians (b,), and the rig's own
    limits: (bone, column) -> (low, high), turns from rest, radians."""

    bones: dict
    side: float
    rest_flexion: np.ndarray
    limits: dict

    def bone(self, role):
        """Bone of `role`, or None."""
        return self.bones.get(role)


def finger_of(name):
    """The digit that a bone's name speaks of, or None; `index_middle` is the index finger's."""
    lowered = re.sub(r"metacarp\w*|middle_?phalanx", "", name.lower())
    found = [(lowered.find(word), digit) for digit, words in _FINGER_WORDS for word in words if word in lowered]
    return min(found)[1] if found else None


def guess(names, parents, has_weight):
    """Role -> bone name for a rig whose bones are named in any common way.

    Chains are read from the hierarchy: a digit's last three weighted bones are its phalanges (two for the thumb, with
    its metacarpal), the weighted bone before them its metacarpal if no other digit hangs on it.
    """
    chains = {}
    for bone in range(len(names)):
        digit = finger_of(names[bone])
        if digit and has_weight[bone]:
            chains.setdefault(digit, []).append(bone)
    out = {}
    for digit, chain in chains.items():
        chain = sorted(chain, key=lambda bone: _depth(bone, parents))[-4:]
        segments = SEGMENTS if digit != "thumb" else ("metacarpal", "proximal", "distal")
        first = parents[chain[0]]
        is_alone = first >= 0 and has_weight[first] and list(parents).count(first) == 1
        if len(chain) == len(segments) - 1 and is_alone and digit != "thumb":
            chain = [first, *chain]
        for segment, bone in zip(reversed(segments), reversed(chain), strict=False):
            out[f"{digit}_{segment}"] = names[bone]
    used = set(out.values())
    for bone, name in sorted(enumerate(names), key=lambda item: _depth(item[0], parents)):
        carries = any(_hangs(names.index(other), bone, parents) for other in used)
        if name not in used and carries and any(word in name.lower() for word in _WRIST_WORDS):
            out[WRIST] = name
    return {role: out[role] for role in ROLES if role in out}


def _depth(bone, parents):
    depth = 0
    while parents[bone] >= 0:
        bone, depth = parents[bone], depth + 1
    return depth


def _hangs(bone, above, parents):
    while bone >= 0:
        if bone == above:
            return True
        bone = parents[bone]
    return False


def resolve(rig, role_names, limits=None):
    """`Joints` of `rig` from role -> bone name; `limits` of the rig itself go before the anatomical ones.

    Raises `RoleError` if a named bone does not exist, or if not even one finger has its three phalanges.
    """
    bones = {}
    for role, name in role_names.items():
        if not name:
            continue
        if name not in rig.names:
            part = role.replace("_", " ")
            raise RoleError(f"no bone called '{name}' for {part}; name an existing bone or clear the field")
        bones[role] = rig.names.index(name)
    whole = [f for f in FINGERS if all(f"{f}_{s}" in bones for s in SEGMENTS[1:])]
    if not whole:
        raise RoleError("no finger has its proximal, middle and distal bone; name the bones of at least one finger")
    return Joints(bones, _side(rig, bones, whole), _rest_flexion(rig, bones), limits or {})


def _side(rig, bones, whole):
    """+1 where the flexion axes point to the thumb's side (a right hand), -1 on a left hand."""
    heads = np.array([rig.rest[bones[f"{f}_proximal"], :3, 3] for f in whole])
    if len(whole) > 1:
        radial = heads[0] - heads[-1]
    elif "thumb_metacarpal" in bones:
        radial = rig.rest[bones["thumb_metacarpal"], :3, 3] - heads[0]
    else:
        return 1.0
    axis = sum(flexion_axis(rig, bones[f"{f}_proximal"]) for f in whole)
    return 1.0 if axis @ radial >= 0.0 else -1.0


def flexion_axis(rig, bone):
    """Flexion axis of `bone` at rest, unit, in rig space."""
    axis = rig.rest[bone, :3, :3] @ rig.axes[bone, :, FLEXION]
    return axis / np.linalg.norm(axis)


def along(rig, bone):
    """Where the segment of `bone` points at rest, unit, in rig space."""
    return rig.rest[bone, :3, :3] @ rig.axes[bone, :, TWIST]


def _rest_flexion(rig, bones):
    """Angle of each phalanx to the bone before it, about its own flexion axis; zero for metacarpals and others."""
    out = np.zeros(len(rig.names))
    for role, bone in bones.items():
        digit, _, segment = role.partition("_")
        if segment in ("", "metacarpal"):
            continue
        before = before_of(role, bones)
        if before is None:
            continue
        axis = flexion_axis(rig, bone)
        here, there = along(rig, bone), along(rig, before)
        here, there = here - axis * (axis @ here), there - axis * (axis @ there)
        out[bone] = np.arctan2(axis @ np.cross(there, here), there @ here)
    return out


def before_of(role, bones):
    """What `bones` (by role) holds for the segment before `role` on its digit; None for a digit's first and others."""
    digit, _, segment = role.partition("_")
    chain = SEGMENTS if digit != "thumb" else ("metacarpal", "proximal", "distal")
    return bones.get(f"{digit}_{chain[chain.index(segment) - 1]}") if segment in chain[1:] else None


def limits_of(role):
    """Angle name -> (low, high), anatomical degrees; empty for the wrist and unknown roles."""
    return LIMITS_DEG.get(role) or LIMITS_DEG.get(role.partition("_")[2], {})


def from_anatomical(joints, role, angle, degrees):
    """An anatomical angle in degrees as a turn from rest, radians; works on scalars and pairs."""
    turn = np.radians(degrees)
    if COLUMNS[angle] == FLEXION:
        return turn - joints.rest_flexion[joints.bones[role]]
    return -joints.side * turn if COLUMNS[angle] == ABDUCTION else joints.side * turn


def angle_bounds(joints, role, angle):
    """Turn from rest (low, high), radians, of one angle of `role`; rest itself is always allowed."""
    own = joints.limits.get((joints.bones[role], COLUMNS[angle]))
    if own is not None:
        return own
    low, high = limits_of(role)[angle]
    ends = sorted((float(from_anatomical(joints, role, angle, low)), float(from_anatomical(joints, role, angle, high))))
    return min(ends[0], 0.0), max(ends[1], 0.0)


def pose_angles(rig, joints, pose):
    """Angles (b, 3) from `pose`: role -> {angle name: anatomical degrees}; roles the rig lacks are passed over."""
    out = np.zeros((len(rig.names), 3))
    for role, angles in pose.items():
        bone = joints.bone(role)
        if bone is None:
            continue
        for angle, degrees in angles.items():
            low, high = angle_bounds(joints, role, angle)
            out[bone, COLUMNS[angle]] = np.clip(from_anatomical(joints, role, angle, degrees), low, high)
    return out
