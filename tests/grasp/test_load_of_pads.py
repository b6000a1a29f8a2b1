"""What a fit knows of forces between presses: slopes against differences, stiffness against the press."""

from dataclasses import dataclass

import numpy as np
import pytest
from thenar_blender.grasp_fit import load


@dataclass(frozen=True)
class Pad:
    """Vertices of a pad."""

    rows: np.ndarray


def test_slopes_are_those_of_the_residuals_on_a_ball():
    rng = np.random.default_rng(3)
    count, radius = 40, 25.0
    ways = rng.normal(size=(count, 3))
    points = ways / np.linalg.norm(ways, axis=1)[:, None] * rng.uniform(radius - 4.0, radius + 2.0, count)[:, None]
    moves = rng.normal(size=(count, 5, 3))
    held = load.Load(rng.uniform(0.01, 0.1, count), rng.normal(size=3), 50.0, 60.0, np.ones(3), np.full(3, 40.0), 80.0)

    def touched(x):
        there = points + np.einsum("kdj,d->kj", moves, x)
        far = np.linalg.norm(there, axis=1)
        return load.Touched(np.arange(count), there, far - radius, there / far[:, None])

    step = 1e-6
    pairs = [(held.residuals(touched(step * e)), held.residuals(touched(-step * e))) for e in np.eye(5)]
    quotient = np.stack([(ahead - back) / (2.0 * step) for ahead, back in pairs], axis=1)
    here = touched(np.zeros(5))
    far = np.linalg.norm(points, axis=1)[:, None, None]
    turning = (np.eye(3) - here.outward[:, :, None] * here.outward[:, None]) / far
    assert held.slopes(here, moves, turning) == pytest.approx(quotient, rel=1e-5, abs=1e-6)


def test_two_pads_that_press_from_both_sides_balance():
    points, outward = np.array([[10.0, 0.0, 0.0], [-10.0, 0.0, 0.0]]), np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
    held = load.Load(np.full(2, 0.5), np.zeros(3), 10.0, 60.0, np.zeros(3), np.zeros(3), None)
    even = held.residuals(load.Touched(np.arange(2), points, np.array([-2.0, -2.0]), outward))
    assert even == pytest.approx(np.zeros(7), abs=1e-12)
    uneven = held.residuals(load.Touched(np.arange(2), points, np.array([-3.0, -2.0]), outward))
    assert uneven[0] < 0.0, "the deeper pad at +x pushes the product to -x"


def test_stiffness_gives_back_the_force_that_was_pressed():
    rng = np.random.default_rng(4)
    pads = [Pad(np.arange(0, 20)), Pad(np.arange(20, 50))]
    areas, gap = rng.uniform(3.0, 6.0, 60), rng.uniform(-4.0, 1.0, 60)
    force = np.zeros(60)
    force[:20], force[20:50] = 0.3, 0.5
    stiffness = load.stiffness_of(pads, areas, gap, force)
    pressed = stiffness * np.maximum(-gap, 0.0) ** load.POWER
    assert [pressed[pad.rows].sum() for pad in pads] == pytest.approx([6.0, 15.0])
    assert not stiffness[50:].any(), "skin outside the pads bears nothing"
