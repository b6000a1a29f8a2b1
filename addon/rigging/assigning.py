"""Digits written to the bone map of a hand's armature, and where they lie in the world."""

from ..hand_bones import bonemap, reading, roles
from ..hand_bones.rig_axes import RigError
from ..rigs import digits

DIGITS = ("thumb", *roles.FINGERS)


def assign(context, hand, digit, names):
    """Make the bones `names` the `digit` of `hand`; one bone stands for its whole chain. Returns the parts written.

    Bones that other digits had are taken from them. Raises `RigError` if they carry no skin of the hand, or are
    fewer than two.
    """
    armature = reading.armature_of(hand)
    skeleton = reading.skeleton_of(context, hand)
    chosen = [skeleton.names.index(name) for name in names if name in skeleton.names]
    if len(chosen) == 1:
        bones = digits.chain_through(skeleton, chosen[0])
    else:
        bones = digits.in_order(skeleton, [bone for bone in chosen if skeleton.skin[bone] > 0.0])
    if len(bones) < 2:
        raise RigError(
            f"{len(bones)} of the chosen bones move skin of '{hand.name}', a digit needs two or three; select one "
            "bone of its chain, or all of them"
        )
    found = digits.roles_of(skeleton, digit, bones)
    taken = set(found.values())
    kept = {
        role: name
        for role, name in bonemap.get_map(armature).items()
        if role.partition("_")[0] != digit and name not in taken
    }
    wrist = digits.wrist_of(skeleton, bones)
    if roles.WRIST not in kept and wrist is not None and wrist not in kept.values():
        kept[roles.WRIST] = wrist
    bonemap.set_map(armature, {**kept, **found}, armature.thenar_bones.axis)
    return found


def lines(armature):
    """Digit -> world points of its joints as posed, end included, for the digits that are assigned."""
    known = bonemap.get_map(armature)
    bones = armature.pose.bones
    out = {}
    for digit in DIGITS:
        names = [known.get(f"{digit}_{segment}") for segment in digits.segments_of(digit)]
        chain = [bones[name] for name in names if name and name in bones]
        heads = [bone.head.copy() for bone in chain]
        if len(heads) > 1:
            rest, before = chain[-1].bone.head_local, chain[-2].bone.head_local
            heads.append(chain[-1].matrix @ chain[-1].bone.matrix_local.inverted() @ (rest + 0.8 * (rest - before)))
            out[digit] = [armature.matrix_world @ head for head in heads]
    return out


def screen_bones(armature, names, to_screen):
    """Bone name -> the two ends of its segment on the screen; `to_screen(point)` gives a 2D point or None.

    A segment goes to the next bone of those `names`, else as far as the bone is drawn.
    """
    bones = armature.pose.bones
    out = {}
    for name in names:
        bone = bones[name]
        following = [child for child in bone.children if child.name in names]
        ends = (bone.head, following[0].head if len(following) == 1 else bone.tail)
        points = [to_screen(armature.matrix_world @ end) for end in ends]
        if None not in points:
            out[name] = tuple(points)
    return out


def nearest(segments, place, reach):
    """Name of the segment nearest to the 2D `place` within `reach` pixels, or None."""
    best, name = reach, None
    for candidate, (start, end) in segments.items():
        step = end - start
        along = max(0.0, min(1.0, (place - start).dot(step) / max(step.dot(step), 1e-9)))
        apart = (place - (start + along * step)).length
        if apart < best:
            best, name = apart, candidate
    return name
