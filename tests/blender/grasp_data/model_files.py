"""MANO as published, by the tests' own code: joint places of the zero pose, tree, axis-angles, and files of poses."""

import bpy
import numpy as np
from mathutils import Quaternion, Vector

PLACES_MM = np.array(
    [
        [95.67, 6.38, 6.19],
        [7.57, 1.18, 26.87],
        [-25.11, 5.19, 29.09],
        [-47.26, 3.89, 28.98],
        [1.01, 4.90, 2.83],
        [-30.17, 6.77, -2.77],
        [-53.08, 5.51, -6.71],
        [26.88, -3.56, -37.02],
        [9.87, -3.50, -49.52],
        [-6.00, -4.19, -59.85],
        [13.93, 2.43, -20.49],
        [-14.38, 4.49, -25.59],
        [-37.90, 2.80, -33.22],
        [71.58, -9.14, 32.00],
        [51.95, -8.25, 55.70],
        [29.73, -13.68, 70.22],
    ]
)
"""Joints of the right model at zero pose and shape, mm, as programs that use the model print them (Romero, Tzionas &
Black 2017, Embodied Hands: 16 joints; wrist, then index, middle, little, ring finger and thumb, three each)."""
PARENTS = (-1, 0, 1, 2, 0, 4, 5, 0, 7, 8, 0, 10, 11, 0, 13, 14)
DIGITS = ("index", "middle", "little", "ring", "thumb")


def places(side):
    """Joint places (16, 3) of the model of that side; the left one is the mirror image."""
    return PLACES_MM * ([1, 1, 1] if side == "right" else [-1, 1, 1])


def turned(pose, side):
    """Places [16] and whole turns [16] of the joints under axis-angles `pose` (45,): by quaternions, joint by joint."""
    rest = [Vector(place) for place in places(side)]
    at, turn = [rest[0]], [Quaternion()]
    for joint in range(1, 16):
        vector = Vector(pose[3 * joint - 3 : 3 * joint])
        own = Quaternion(vector.normalized(), vector.length) if vector.length > 0 else Quaternion()
        above = PARENTS[joint]
        at.append(at[above] + turn[above] @ (rest[joint] - rest[above]))
        turn.append(turn[above] @ own)
    return at, turn


def bones(digit):
    """Names of the made hand's bones that turn at a digit's three joints."""
    segments = ("metacarpal", "proximal", "distal") if digit == "thumb" else ("proximal", "middle", "distal")
    return [f"{digit}_{segment}" for segment in segments]


def make(side):
    """A coarse made hand in the scene: its bones are those of a fine one."""
    assert bpy.ops.thenar.make_hand(side=side, spacing_mm=6.0) == {"FINISHED"}


def armature():
    """The scene's hand's armature as it is shown, constraints applied."""
    bpy.context.view_layer.update()
    rig = bpy.context.scene.thenar.hand.parent
    return rig.evaluated_get(bpy.context.evaluated_depsgraph_get())


def load(tmp_path, values, **options):
    """Write `values` as NPZ and pose the hand by it."""
    np.savez(tmp_path / "pose.npz", **values)
    return bpy.ops.thenar.load_hand_pose(filepath=str(tmp_path / "pose.npz"), **options)


def grips(count=6, seed=3):
    """Poses (count, 45) of a right hand: fingers flexed by up to 1.2 rad a joint, all joints turned a little."""
    random = np.random.default_rng(seed)
    out = random.uniform(-0.25, 0.25, (count, 15, 3))
    out[:, :12, 2] += random.uniform(0.0, 1.0, (count, 12))
    return out.reshape(count, 45)


def mirror(pose):
    """The same pose of the other model: axis-angles mirrored at x = 0."""
    return (pose.reshape(-1, 15, 3) * [1, -1, -1]).reshape(pose.shape)
