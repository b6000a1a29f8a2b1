"""Turns of bones over frames written to an armature: as its pose, or as keyframes."""

import numpy as np
from mathutils import Matrix

_LINEAR = 1
"""Blender's number of the interpolation LINEAR."""


def pose(armature, turns):
    """Set basis rotations, bone name -> (3, 3); location and scale of those bones are reset."""
    for name, turn in turns.items():
        armature.pose.bones[name].matrix_basis = Matrix(turn.tolist()).to_4x4()


def modes(armature, names):
    """How each bone is rotated, by name."""
    return {name: armature.pose.bones[name].rotation_mode for name in names}


def channels(held, turns, cancel=None, progress=None):
    """Rotation property and values (f, k) by bone name, of basis rotations (f, 3, 3) by name and modes as `modes` has
    them. It asks Blender for nothing, so any thread may run it."""
    out = {}
    for number, (name, matrices) in enumerate(turns.items()):
        if cancel is not None and cancel.is_set():
            break  # what was computed is dropped
        if progress is not None:
            progress("keying", number / len(turns))
        out[name] = _channels(held[name], matrices)
    return out


def key(armature, rows_of, frames):
    """Keyframe rotations, as `channels` gives them, at scene frames (f,) in rising order.

    Keys of these bones' rotations between the first and the last frame are replaced; others stay.
    """
    for name, (path, rows) in rows_of.items():
        bone = armature.pose.bones[name]
        bone.keyframe_insert(path, frame=float(frames[0]))
        whole = bone.path_from_id(path)
        for index in range(rows.shape[1]):
            curve = next(c for c in curves(armature) if c.data_path == whole and c.array_index == index)
            _fill(curve, np.asarray(frames, np.float64), rows[:, index])


def curves(armature):
    """F-curves of the armature's own action."""
    animation = armature.animation_data
    action, slot = animation.action, getattr(animation, "action_slot", None)
    if slot is None:
        return list(action.fcurves)
    strips = [strip for layer in action.layers for strip in layer.strips]
    bags = [strip.channelbag(slot) for strip in strips]
    return [curve for bag in bags if bag is not None for curve in bag.fcurves]


def _channels(mode, matrices):
    """The rotation property of a bone of this rotation mode, and its values (f, k) without leaps between frames."""
    rows, last = [], None
    for turn in matrices:
        matrix = Matrix(turn.tolist())
        if mode in {"QUATERNION", "AXIS_ANGLE"}:
            value = matrix.to_quaternion()
            if last is not None:
                value.make_compatible(last)
        else:
            value = matrix.to_euler(mode, last) if last is not None else matrix.to_euler(mode)
        last = value
        rows.append(_axis_angle(value) if mode == "AXIS_ANGLE" else tuple(value))
    names = {"QUATERNION": "rotation_quaternion", "AXIS_ANGLE": "rotation_axis_angle"}
    return names.get(mode, "rotation_euler"), np.array(rows)


def _axis_angle(quaternion):
    axis, angle = quaternion.to_axis_angle()
    return angle, *axis


def _fill(curve, frames, values):
    """Replace the keys between the first and the last frame by these, with lines between them; others stay."""
    points = curve.keyframe_points
    held = {name: _read(points, name, width) for name, width in _KEPT.items()}
    outside = (held["co"][:, 0] < frames[0] - 1e-3) | (held["co"][:, 0] > frames[-1] + 1e-3)
    new = np.stack([frames, values], axis=1)
    fresh = {name: new for name in ("co", "handle_left", "handle_right")}
    fresh["interpolation"] = np.full((len(new), 1), _LINEAR)
    order = np.argsort(np.concatenate([held["co"][outside, 0], frames]), kind="stable")
    points.add(max(len(order) - len(points), 0))
    while len(points) > len(order):
        points.remove(points[-1], fast=True)
    for name, width in _KEPT.items():
        added = fresh.get(name, np.zeros((len(new), width)))
        rows = np.concatenate([held[name][outside], added])[order]
        points.foreach_set(name, rows.ravel().astype(held[name].dtype))
    curve.update()


def _read(points, name, width):
    """A property of all keys, (k, width)."""
    out = np.empty(width * len(points), np.float32 if width == 2 else np.int32)
    points.foreach_get(name, out)
    return out.reshape(-1, width)


_KEPT = {
    "co": 2,
    "handle_left": 2,
    "handle_right": 2,
    "handle_left_type": 1,
    "handle_right_type": 1,
    "interpolation": 1,
    "easing": 1,
}
"""Properties of a key that stay with it, and how many numbers each has."""
