"""Rotation vectors of the hand's place. Knows nothing of Blender."""

import numpy as np

from .skinning import rotation


def rotation_of(vector):
    """3 by 3 rotation about `vector` (3,) by its length, radians."""
    angle = float(np.linalg.norm(vector))
    return rotation(vector / angle, angle) if angle > 1e-12 else np.eye(3)


def left_jacobian(vector):
    """Derivative of a rotation vector's motion: d(R p) = (J dv) x (R p); Chirikjian 2012, section 10.8."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    if angle < 1e-6:
        return np.eye(3) + 0.5 * cross
    return np.eye(3) + (1.0 - np.cos(angle)) / angle**2 * cross + (angle - np.sin(angle)) / angle**3 * (cross @ cross)
