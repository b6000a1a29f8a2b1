"""Hand and product in the product's own frame, where grasps are searched: neither's place in the scene counts there."""

from dataclasses import dataclass, replace

import numpy as np

from .. import native, workflow
from ..grasp_fit import closing, field, fitter, places, walls
from ..hand.skinning import pose_matrices, skin


@dataclass(frozen=True)
class Stage:
    """A `fitting.Fit` brought into the product's own frame.

    `hand` and `gauge` are those to fit with; `vertices` (k, 3) the product's. `world` (4, 4) leads from the own frame
    to the scene, `home` (4, 4) from the hand's place in the scene to the one that `hand` stands in.
    """

    fit: object
    hand: fitter.Hand
    gauge: walls.Gauge
    vertices: np.ndarray
    world: np.ndarray
    home: np.ndarray

    @property
    def mark(self):
        """The product's origin (3) in the own frame."""
        return np.linalg.solve(self.world, np.append(self.fit.frame_mm[:3, 3], 1.0))[:3].round(DIGITS)

    @property
    def triangles(self):
        """Triangles (m, 3) of the product."""
        return self.fit.product_mm[1]

    def carried(self, found):
        """A `Grasp` of the own frame as one of the scene."""
        gauge = replace(self.gauge, product=self.fit.product, field=None)
        return replace(found, place=self.world @ found.place @ self.home, gauge=gauge)

    def taken(self, found):
        """A `Grasp` of the scene as one of the own frame."""
        place = np.linalg.inv(self.world) @ found.place @ np.linalg.inv(self.home)
        return replace(found, place=place, gauge=self.gauge)

    def contact_of(self, found, cancel=None):
        """The pressed contact of a grasp of the own frame, in that frame. Raises `Refusal`."""
        read = self.fit.press.reading
        rig = self.hand.rig.moved(found.place)
        posed = replace(read.hand, posed_mm=skin(rig, pose_matrices(rig, found.angles)), origin_mm=np.zeros(3))
        product = replace(read.product, vertices_mm=self.vertices, triangles=self.triangles)
        press = replace(self.fit.press, force_n=None, reading=replace(read, hand=posed, product=product))
        return workflow.compute(press, cancel)


DIGITS = 6
"""Lengths in the own frame are rounded to so many digits behind the point, mm: what turning and moving in single
precision leaves is then gone, and the same product gives the same bits."""

PLACES = 9
"""The same for what the hand is, in mm and in its turn."""

SAMPLES = 1000
"""Points of the surface at which walls are looked at: a box of twelve triangles has no vertices on its sides."""


def stage_of(fit):
    """The `Stage` of a `fitting.Fit`."""
    vertices, triangles = fit.product_mm
    frame = _even(fit.frame_mm)
    shape = np.linalg.solve(frame, np.c_[vertices, np.ones(len(vertices))].T).T[:, :3].round(DIGITS)
    origin, axes = places.own_frame(shape, triangles)
    own = np.eye(4)
    own[:3, :3], own[:3, 3] = axes, origin
    local = ((shape - origin) @ axes).round(DIGITS)
    product = native.module.Product(local, triangles)
    deepest = np.nanmax(fitter.wanted_depths(fit.hand.pads, fit.wish), initial=0.0)
    surface = places.sampled(local, triangles, SAMPLES)[0]
    gauge = replace(walls.gauge_of(product, surface, deepest), field=field.field_of(product, local), is_faced=True)
    hand, home = _at_home(fit.hand)
    return Stage(fit, hand, gauge, local, frame @ own, home)


def _even(frame):
    """The frame of an object (4, 4), mm, its scale taken out to five digits; the world's where it is skewed or
    mirrored."""
    size = np.cbrt(np.linalg.det(frame[:3, :3]))
    turn = frame[:3, :3] / size if size > 0.0 else np.zeros((3, 3))
    if not np.allclose(turn.T @ turn, np.eye(3), atol=1e-4):
        return np.eye(4)
    out = frame.copy()
    out[:3, :3] /= float(f"{size:.5g}")
    return out


def _at_home(hand):
    """The hand at a place of its own, knuckles at the origin and the palm facing +z, and the motion (4, 4) there."""
    linear = hand.rig.world_from_rig[:3, :3]
    size = np.cbrt(abs(np.linalg.det(linear)))
    plain = np.eye(4)
    if np.allclose(linear.T @ linear, size**2 * np.eye(3), atol=1e-4 * size**2):
        sign = np.sign(np.linalg.det(linear))
        plain[:3, :3] = float(f"{size:.5g}") * np.diag([1.0, 1.0, sign])
        plain = plain @ np.linalg.inv(hand.rig.world_from_rig)
    placed = hand.rig.moved(plain)
    knuckles, radial, _, facing = closing.hand_frame(placed, hand.joints)
    turn = np.stack([radial, np.cross(facing, radial), facing])
    home = np.eye(4)
    home[:3, :3], home[:3, 3] = turn, -turn @ knuckles
    linear = (home @ placed.world_from_rig).round(PLACES)
    # How deep bones may lie in others was measured where the hand stands.
    capsules = replace(hand.capsules, allowed=hand.capsules.allowed.round(PLACES))
    return replace(hand, rig=replace(hand.rig, world_from_rig=linear), capsules=capsules), home @ plain
