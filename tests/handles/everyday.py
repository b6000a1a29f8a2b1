"""Eleven things of every day, most of them without a handle: sheets, balls, boxes, a pencil, a coin. Sizes in mm.

Knows nothing of Thenar and of Blender. Made after the search for pinches, none of it while that was written.
"""

import numpy as np
from handles.random_products import block, revolved


def turned(*profile):
    """A body of revolution about z from (radius, height) pairs."""
    across, along = np.array(profile, float).T
    return revolved(across, along, 40)


def ball(radius):
    """A ball of latitudes."""
    turn = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 25)
    across = radius * np.cos(turn)
    across[[0, -1]] = 0.0
    return revolved(across, radius * np.sin(turn), 48)


def brick(*size):
    """A block of twelve triangles."""
    half = 0.5 * np.array(size, float)
    return block(-half, half, 1)


def wedge():
    """A block of 80 by 60 mm, 5 mm thick at one end and 30 at the other."""
    vertices, triangles = brick(80.0, 60.0, 12.0)
    vertices = np.array(vertices, float)
    vertices[:, 2] *= np.where(vertices[:, 0] > 0.0, 2.5, 0.4)
    return vertices, triangles


SHAPES = {
    "phone": lambda: brick(72, 150, 8),
    "card": lambda: brick(86, 54, 0.8),
    "coin": lambda: turned((0, -1), (12, -1), (12, 1), (0, 1)),
    "pencil": lambda: turned((0, -90), (3.7, -90), (3.7, 80), (0, 92)),
    "ball": lambda: ball(32.5),
    "marble": lambda: ball(8.0),
    "cube": lambda: brick(50, 50, 50),
    "box": lambda: brick(200, 90, 60),
    "bottle cap": lambda: turned((0, -7), (15, -7), (15, 7), (0, 7)),
    "book": lambda: brick(150, 210, 24),
    "wedge": wedge,
}
