"""Which vertex of the scene's hand is which vertex of another skin, a study's: the same mesh, or the same place."""

from dataclasses import dataclass

import numpy as np
from bpy.types import Context
from mathutils.kdtree import KDTree
from numpy.typing import ArrayLike

from . import read
from .units import Floats, Ints

SAME_MM = 0.05
"""Largest distance at which moved vertices are the same: PLY and OBJ files keep at least a hundredth."""
NEAR = 0.75
"""How far, in the spacing of the mesh, a vertex may lie from the nearest one of the same surface."""
COVERED = 0.95
"""Share of the other skin's vertices that must lie on the hand."""


@dataclass(frozen=True)
class Match:
    """The rigid motion from the other skin's frame to that of the hand at rest, mm, and which vertex is which.

    `hand_of_other` (n,) and `other_of_hand` (m,) hold numbers of vertices, -1 where there is none.
    """

    rotation: Floats
    shift_mm: Floats
    hand_of_other: Ints
    other_of_hand: Ints

    def point_mm(self, point_mm: ArrayLike) -> Floats:
        """A point (3) of the other skin in the hand's rest frame, mm."""
        return self.rotation @ np.asarray(point_mm, dtype=np.float64) + self.shift_mm

    def direction(self, vector: ArrayLike) -> Floats:
        """A direction (3) of the other skin in the hand's rest frame."""
        return self.rotation @ np.asarray(vector, dtype=np.float64)

    def on_hand(self, vertices: ArrayLike) -> Ints:
        """The hand's vertices, each once, of vertices of the other skin."""
        found = self.hand_of_other[np.asarray(vertices, dtype=np.int64)]
        once: Ints = np.unique(found[found >= 0])
        return once

    def carried(self, values: ArrayLike) -> Floats:
        """Values (n,) of the other skin at the hand's vertices (m,), NaN where there is none."""
        values = np.append(np.asarray(values, dtype=np.float64), np.nan)
        return values[self.other_of_hand]


def on_scene_hand(context: Context, other_mm: Floats) -> Match | None:
    """How another skin (n, 3), mm, lies on the scene's hand. None without a hand, or if it lies nowhere on it."""
    hand = context.scene.thenar.hand
    if hand is None or hand.type != "MESH" or not len(hand.data.vertices):
        return None
    edges = np.empty(2 * len(hand.data.edges), np.int32)
    hand.data.edges.foreach_get("vertices", edges)
    return match(np.asarray(other_mm), read.rest_mm(context, hand), edges.reshape(-1, 2))


def match(other_mm: Floats, hand_mm: Floats, edges: Ints) -> Match | None:
    """How a skin (n, 3) lies on the hand at rest (m, 3), mm, whose edges are (k, 2). None if it lies nowhere on it.

    Meshes of the same vertices may be moved and turned against each other; others must lie in the same place.
    """
    if len(other_mm) == len(hand_mm):
        rotation, shift = _rigid(other_mm, hand_mm)
        if np.abs(other_mm @ rotation.T + shift - hand_mm).max(initial=0.0) < SAME_MM:
            same = np.arange(len(hand_mm))
            return Match(rotation, shift, same, same)
    return _in_place(other_mm, hand_mm, edges)


def _in_place(other_mm: Floats, hand_mm: Floats, edges: Ints) -> Match | None:
    if not len(other_mm) or not len(edges):
        return None
    spacing = float(np.median(np.linalg.norm(hand_mm[edges[:, 0]] - hand_mm[edges[:, 1]], axis=1)))
    hand_of_other, apart = _nearest(hand_mm, other_mm)
    is_on = apart < NEAR * spacing
    if is_on.mean() < COVERED:
        return None
    other_of_hand, apart = _nearest(other_mm, hand_mm)
    other_of_hand[apart >= NEAR * spacing] = -1
    hand_of_other[~is_on] = -1
    return Match(np.eye(3), np.zeros(3), hand_of_other, other_of_hand)


def _nearest(to: Floats, points: Floats) -> tuple[Ints, Floats]:
    """Number of, and distance to, the nearest of `to` for every one of `points`."""
    tree = KDTree(len(to))
    for number, place in enumerate(to):
        tree.insert(place, number)
    tree.balance()
    found = [tree.find(point) for point in points]
    return np.array([number for _, number, _ in found]), np.array([apart for _, _, apart in found])


def _rigid(from_mm: Floats, to_mm: Floats) -> tuple[Floats, Floats]:
    """Rotation (3, 3) and shift (3) that bring points nearest to others in the least squares (Kabsch 1976)."""
    middle_from, middle_to = from_mm.mean(axis=0), to_mm.mean(axis=0)
    left, _, right = np.linalg.svd((from_mm - middle_from).T @ (to_mm - middle_to))
    turn = np.diag([1.0, 1.0, np.sign(np.linalg.det(right.T @ left.T))])
    rotation = right.T @ turn @ left.T
    return rotation, middle_to - rotation @ middle_from
