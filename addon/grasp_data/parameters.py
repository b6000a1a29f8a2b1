"""Which numbers of a file are a hand's pose: keys, widths, sides, PCA and mean, as axis-angles of 15 joints.

Knows nothing of Blender. Keys and widths are those of MANO, SMPL-H and SMPL-X files; the guide lists them.
"""

from dataclasses import dataclass

import numpy as np

from ..scene.checks import Refusal

JOINTS = 15
FULL = 3 * JOINTS
SIDES = {"left": "left", "lhand": "left", "left_hand": "left", "right": "right", "rhand": "right"}
SIDES["right_hand"] = "right"
ABSOLUTE = ("fullpose", "pose_hand", "poses")
"""Keys whose angles hold the mean pose already."""
KEYS = ("left_hand_pose", "right_hand_pose", "fullpose", "hand_pose", "pose_hand", "poses", "handpose", "mano_pose")
KEYS = (*KEYS, "pose_m", "pose")
"""Keys of poses in lower case; of several, the first is taken."""
RATES = ("mocap_framerate", "mocap_frame_rate", "frame_rate", "fps")
WIDTHS = {FULL: 0, FULL + 3: 3, FULL + 6: 3}
"""Numbers of one hand in a row -> where its fingers begin; what is before is the hand's turn, after it its place."""
BODIES = {90: (0, 45), 156: (66, 111), 165: (75, 120)}
"""Numbers of both hands or a body in a row -> where the left and the right fingers begin: AMASS, SMPL-H, SMPL-X."""
LARGEST_TURN = 2.0 * np.pi


@dataclass(frozen=True)
class Wish:
    """`side` that is wanted, `is_pca` (None: by the width), and whether the file's mean pose is added."""

    side: str
    is_pca: bool | None = None
    adds_mean: bool = True


@dataclass(frozen=True)
class Poses:
    """`turns` (f, 15, 3): axis-angles, rad, in the order of MANO's joints; `frames` (f,): their numbers in the file."""

    turns: np.ndarray
    frames: np.ndarray
    key: str
    rate_hz: float | None


def find(values, wish, name):
    """The `Poses` of the side that `wish` names in what a file holds; `name` of the file is for messages.

    Numbers that name no side are taken for that side. Raises `Refusal` where there are none, or none that can be read.
    """
    if not isinstance(values, dict | list):
        values = {"pose": values}
    found = {}
    _gather(values, None, found, name)
    fitting = [(KEYS.index(key), side is None, side, key) for side, key in found if side in (None, wish.side)]
    fitting += [(KEYS.index(key), False, side, key) for side, key in found if side == "both"]
    if not fitting:
        there = " and ".join(sorted({side for side, _ in found}))
        if there:
            raise Refusal(f"'{name}' holds no {wish.side} hand, only: {there}; choose Side to mirror it")
        raise Refusal(f"'{name}' holds no pose of a hand; name it hand_pose, or left_hand_pose and right_hand_pose")
    _, _, side, key = min(fitting)
    rows = found[side, key]
    frames, numbers = np.array([row[0] for row in rows]), [row[1] for row in rows]
    if len({len(row) for row in numbers}) > 1:
        raise Refusal(f"'{name}': the frames of '{key}' are not of one length; save them as one array")
    turns = _turns(np.array(numbers, dtype=np.float64), (key, side), values, wish, name)
    return Poses(turns, frames, key, _rate(values))


def _gather(node, side, found, name):
    """Fill `found`, (side, key) -> [(frame, numbers)], from nested containers."""
    frames = _frames(node)
    if frames is not None:
        for frame, child in frames:
            inner = {}
            _gather(child, side, inner, name)
            for place, rows in inner.items():
                if len(rows) > 1 and len(frames) > 1:
                    raise Refusal(f"'{name}' holds several sequences of '{place[1]}'; save one sequence in a file")
                found.setdefault(place, []).extend([(frame, rows[0][1])] if len(rows) == 1 else rows)
        return
    if not isinstance(node, dict):
        return
    for key, value in node.items():
        word = str(key).lower()
        if word in KEYS and _is_numbers(value):
            rows = _rows(value, key, name)
            own = {"left_hand_pose": "left", "right_hand_pose": "right"}.get(word, side)
            found[("both" if len(rows[0]) in BODIES else own), word] = list(enumerate(rows))
        elif isinstance(value, dict | list) and not _is_numbers(value):
            _gather(value, SIDES.get(word, side), found, name)


def _frames(node):
    """[(number, child)] of a list of dicts, or of a dict whose keys are numbers; else None."""
    if isinstance(node, list) and node and any(isinstance(child, dict) for child in node):
        return [(index, child) for index, child in enumerate(node) if child is not None]
    if isinstance(node, dict) and node and all(str(key).isdecimal() for key in node):
        return sorted((int(str(key)), child) for key, child in node.items() if child is not None)
    return None


def _is_numbers(value):
    """Whether `value` is an array of numbers, or nested lists of numbers alone."""
    if isinstance(value, np.ndarray):
        return value.dtype.kind in "iuf" and value.size > 0
    while isinstance(value, list | tuple) and len(value):
        if not all(type(item) is type(value[0]) or isinstance(item, int | float | np.ndarray) for item in value):
            return False
        value = value[0]
    return isinstance(value, int | float) or (isinstance(value, np.ndarray) and value.dtype.kind in "iuf")


def _rows(value, key, name):
    """Rows of numbers, one a frame; joints, and rotation matrices of joints, are laid into a row."""
    try:
        array = np.array(value, dtype=np.float64)
    except (ValueError, TypeError):
        raise Refusal(f"'{name}': the rows of '{key}' are not of one length; save them as one array") from None
    if array.ndim >= 3 and array.shape[-2:] == (3, 3) and array.shape[-3] in (JOINTS, JOINTS + 1):
        array = _logarithms(array.reshape(-1, 3, 3), key, name).reshape(*array.shape[:-3], array.shape[-3], 3)
    if array.ndim >= 2 and array.shape[-1] == 3:
        array = array.reshape(*array.shape[:-2], -1)
    return array.reshape(-1, array.shape[-1] if array.ndim else 1)


def _logarithms(matrices, key, name):
    """Axis-angles (n, 3) of rotation matrices (n, 3, 3)."""
    straight = np.abs(matrices @ np.swapaxes(matrices, 1, 2) - np.eye(3)).max(axis=(1, 2)) < 1e-3
    if not (straight & (np.linalg.det(matrices) > 0.0)).all():
        worst = int(np.argmin(straight & (np.linalg.det(matrices) > 0.0)))
        raise Refusal(f"'{name}': matrix {worst} of '{key}' is no rotation; save axis-angles")
    symmetric = np.clip((np.trace(matrices, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0)
    angle = np.arccos(symmetric)
    across = np.stack([matrices[:, 2, 1], matrices[:, 0, 2], matrices[:, 1, 0]], axis=1)
    across -= np.stack([matrices[:, 1, 2], matrices[:, 2, 0], matrices[:, 0, 1]], axis=1)
    if (angle > np.pi - 1e-3).any():
        raise Refusal(f"'{name}': a joint of '{key}' turns by 180 degrees, about no one axis; save axis-angles")
    scale = np.where(angle > 1e-6, angle / (2.0 * np.sin(np.maximum(angle, 1e-6))), 0.5)
    return across * scale[:, None]


def _turns(numbers, place, values, wish, name):
    """Axis-angles (f, 15, 3) of rows of numbers."""
    key, side = place
    width = numbers.shape[1]
    if side == "both":
        start = BODIES[width][wish.side == "right"]
        fingers = numbers[:, start : start + FULL]
    else:
        is_pca = wish.is_pca if wish.is_pca is not None else width not in WIDTHS or key == "pose_m"
        fingers = _of_components(numbers, key, values, wish, name) if is_pca else _of_angles(numbers, key, name)
    if wish.adds_mean and key not in ABSOLUTE and not _is_flat(values):
        mean = _model(values, "hands_mean", wish.side, (FULL,), name)
        fingers = fingers if mean is None else fingers + mean
    turns = fingers.reshape(-1, JOINTS, 3)
    wrong = ~np.isfinite(turns).all(axis=2) | (np.linalg.norm(turns, axis=2) > LARGEST_TURN)
    if wrong.any():
        frame, joint = np.argwhere(wrong)[0]
        raise Refusal(
            f"'{name}': joint {joint + 1} of '{key}' in frame {frame} is no angle in radians: "
            f"{', '.join(f'{value:.4g}' for value in turns[frame, joint])}; save axis-angles in radians"
        )
    return turns


def _of_angles(numbers, key, name):
    start = WIDTHS.get(numbers.shape[1])
    if start is None:
        raise Refusal(
            f"'{name}': '{key}' has {numbers.shape[1]} numbers a frame; a hand has 45 axis-angles, or 48 with its turn"
        )
    return numbers[:, start : start + FULL]


def _of_components(numbers, key, values, wish, name):
    """Axis-angles of PCA coefficients by the components that the file brings."""
    start = WIDTHS.get(numbers.shape[1], 0)
    weights = numbers[:, start : start + FULL]
    count = weights.shape[1]
    components = _model(values, "hands_components", wish.side, (FULL, FULL), name)
    if components is None:
        raise Refusal(
            f"'{name}': '{key}' holds {count} PCA coefficients, and the file no hands_components to read them by; "
            "save the full pose (45 axis-angles), or add hands_components and hands_mean of the model"
        )
    if count > FULL:
        raise Refusal(f"'{name}': '{key}' has {count} numbers a frame; a hand has 45 PCA coefficients at most")
    return weights @ components[:count]


def _model(values, key, side, shape, name):
    """An array of the model that the file brings, of one side's where there are two; None without one."""
    if not isinstance(values, dict):
        return None
    found = next((values[word] for word in (key + side[0], key) if word in values), None)
    if found is None:
        return None
    array = np.array(found, dtype=np.float64) if _is_numbers(found) else np.zeros(0)
    if array.shape != shape or not np.isfinite(array).all():
        raise Refusal(f"'{name}': '{key}' is not {' by '.join(map(str, shape))} numbers; copy it from the model again")
    return array


def _is_flat(values):
    """Whether the file says that its angles count from the flat hand."""
    said = values.get("flat_hand_mean") if isinstance(values, dict) else None
    return bool(np.all(said)) if said is not None else False


def _rate(values):
    """Frames a second, or None where the file does not say."""
    for key in RATES if isinstance(values, dict) else ():
        if key in values and _is_numbers(values[key]):
            rate = float(np.array(values[key], dtype=np.float64).ravel()[0])
            if np.isfinite(rate) and rate > 0.0:
                return rate
    return None
