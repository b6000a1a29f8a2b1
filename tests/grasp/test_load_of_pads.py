"""What a fit knows of forces between presses: slopes against differences, stiffness against the press."""

from dataclasses import dataclass

import numpy as np
import pytest
from thenar_blender.grasp_fit import load, sharing


@dataclass(frozen=True)
class Pad:
    """Vertices of a pad."""

    rows: np.ndarray
    role: str = ""
    kind: str = "distal"


def test_slopes_are_those_of_the_residuals_on_a_ball():
    rng = np.random.default_rng(3)
    count, radius = 40, 25.0
    ways = rng.normal(size=(count, 3))
    points = ways / np.linalg.norm(ways, axis=1)[:, None] * rng.uniform(radius - 4.0, radius + 2.0, count)[:, None]
    moves = rng.normal(size=(count, 5, 3))
    shared = sharing.Sharing(rng.integers(-1, 3, count), np.array([0.5, 0.3, 0.2]))
    stiffness, outer = rng.uniform(0.01, 0.1, count), (np.ones(3), np.full(3, 40.0))
    held = load.Load(stiffness, rng.normal(size=3), 50.0, 60.0, *outer, 80.0, shared)

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


def test_a_finger_that_bears_too_much_is_known_by_strength():
    """Shares of a maximal grip by MacDermid and others (2004): 25, 35, 25 and 14 of 99; thumb and palm have none."""
    names = ("thumb_distal", "index_distal", "middle_distal", "middle_middle", "ring_distal", "little_distal", "wrist")
    pads = [Pad(np.arange(2 * k, 2 * k + 2), name) for k, name in enumerate(names)]
    pads[-1] = Pad(pads[-1].rows, "wrist", "palm")
    fair = sharing.sharing_of(pads, np.ones(len(pads), bool), 15)
    force = np.zeros(15)
    for pad, sum_n in zip(pads, (80.0, 25.0, 20.0, 15.0, 25.0, 14.0, 60.0), strict=True):
        force[pad.rows] = 0.5 * sum_n
    assert fair.excess(np.arange(15), force) == pytest.approx(np.zeros(4), abs=1e-9)
    assert fair.unevenness(force) == pytest.approx(0.0, abs=1e-9)
    assert fair.factors(pads, force) == pytest.approx(np.ones(len(pads)))
    force[pads[1].rows] += 10.0
    others = np.array([25.0, 35.0, 25.0, 14.0]) / 99.0 * 20.0
    assert fair.excess(np.arange(15), force) == pytest.approx(np.array([20.0, 0.0, 0.0, 0.0]) - others)
    factors = fair.factors(pads, force)
    assert factors[1] < 1.0 < factors[2] == factors[3] and factors[0] == factors[-1] == 1.0
    assert fair.factors(pads, np.zeros(15)) == pytest.approx(np.ones(len(pads))), "nothing touches yet"
    two = sharing.sharing_of(pads, np.array([True, True, True, False, False, False, False]), 15)
    assert two.shares == pytest.approx([25.0 / 60.0, 35.0 / 60.0]), "a pinch of thumb and two fingers"
    assert sharing.sharing_of(pads, np.array([True, True] + [False] * 5), 15) is None
