"""A finger that rolls over a ball without slipping: keyframes on the hand's armature, which move the whole hand."""

import numpy as np
from mathutils import Matrix

ROLL_DEG = 32.0
"""How far the finger turns about its own axis to either side."""
FRAMES = 48
"""The roll begins and ends upright; at 24 frames a second it lasts 2 s. Every frame has its key, in the
Euler angles nearest to those before: others of the same turn throw the finger off the ball between two keys."""


def roll(context, rig, product, bone):
    """Key the armature `rig` so that the finger with this distal `bone` rolls over a ball to one side and to the other.

    The ball's middle is its object's origin. The scene's range becomes that of the roll.
    """
    scene, start = context.scene, np.array(rig.matrix_world)
    turn = rig.rotation_euler.copy()
    for frame in range(1, FRAMES + 2):
        angle = np.radians(ROLL_DEG) * np.sin(2.0 * np.pi * (frame - 1) / FRAMES)
        rig.matrix_world = Matrix((motion(rig, start, (product, bone), angle) @ start).tolist())
        turn = rig.matrix_world.to_euler("XYZ", turn)
        rig.rotation_euler = turn
        for path in ("location", "rotation_euler"):
            rig.keyframe_insert(path, frame=frame)
    rig.matrix_world = Matrix(start.tolist())
    scene.frame_start, scene.frame_end = 1, FRAMES
    scene.render.fps, scene.render.fps_base = 24, 1.0
    scene.frame_set(1)


def motion(rig, start, where, angle):
    """The motion (4, 4), world units, of a finger that has turned by `angle`, radians; `where`: the ball, the bone.

    Finger and ball are round about their axes: while the finger turns by `angle` in all, its axis goes around the ball
    by the share of the angle that the distance of skin from bone is of the distance of the bone from the ball's middle.
    """
    product, bone = where
    posed = start @ np.array(rig.pose.bones[bone].matrix)
    head, along = posed[:3, 3], posed[:3, 1] / np.linalg.norm(posed[:3, 1])
    middle = np.array(product.matrix_world.translation)
    across = head - middle - along * ((head - middle) @ along)
    distance = np.linalg.norm(across)
    radius = 0.5 * max(product.dimensions)
    around = angle * max(distance - radius, 0.0) / distance
    return turned(around, along, middle) @ turned(angle - around, along, middle + across)


def turned(angle, axis, center):
    """A turn (4, 4) by an angle, radians, about an axis (3) through a point (3)."""
    turn = Matrix.Rotation(angle, 4, axis.tolist())
    return np.array(Matrix.Translation(center.tolist()) @ turn @ Matrix.Translation((-center).tolist()))
