"""The friction that a held product needs, against closed forms and a linear program of another library."""

import numpy as np
import pytest
from scipy.optimize import linprog
from thenar_blender.grasp import friction

SIDES = 48


def test_two_jaws_hold_a_weight_by_half_its_share():
    points, push = np.array([[-10.0, 0.0, 0.0], [10.0, 0.0, 0.0]]), np.array([[50.0, 0.0, 0.0], [-50.0, 0.0, 0.0]])
    assert friction.needed(points, push, np.array([0.0, 0.0, -10.0]), np.zeros(3)) == pytest.approx(0.1, rel=1e-3)


def test_a_ring_holds_a_torque_by_its_radius():
    turn = np.linspace(0.0, 2.0 * np.pi, 41)[:-1]
    points = 20.0 * np.stack([np.cos(turn), np.sin(turn), np.zeros(40)], axis=1)
    held = friction.needed(points, -5.0 * points / 20.0, np.zeros(3), np.array([0.0, 0.0, 400.0]))
    assert held == pytest.approx(400.0 / (20.0 * 200.0), rel=1e-3)


def test_what_balances_needs_none():
    points, push = np.array([[-10.0, 0.0, 0.0], [10.0, 0.0, 0.0]]), np.array([[50.0, 0.0, 0.0], [-50.0, 0.0, 0.0]])
    assert friction.needed(points, push, np.zeros(3), np.zeros(3)) == 0.0


def test_one_contact_holds_no_pull_along_its_normal():
    push = np.array([[30.0, 0.0, 0.0]])
    assert np.isinf(friction.needed(np.zeros((1, 3)), push, np.array([5.0, 0.0, 0.0]), np.zeros(3)))
    assert np.isinf(friction.needed(np.zeros((0, 3)), np.zeros((0, 3)), np.array([5.0, 0.0, 0.0]), np.zeros(3)))


@pytest.mark.parametrize("seed", range(12))
def test_as_little_as_a_linear_program_finds(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(0.0, 25.0, (rng.integers(5, 30), 3))
    push = -points / np.linalg.norm(points, axis=1)[:, None] * rng.uniform(0.5, 8.0, len(points))[:, None]
    outer, outer_moment = rng.normal(0.0, 3.0, 3), rng.normal(0.0, 40.0, 3)
    net, moment = push.sum(axis=0) + outer, np.cross(points, push).sum(axis=0) + outer_moment
    least = least_friction(points, push, net, moment)
    found = friction.needed(points, push, net, moment)
    assert 0.995 * least <= found <= 1.05 * least


def least_friction(points, push, net, moment):
    """The least coefficient by a linear program: cones of `SIDES` sides inside Coulomb's, so up to 0.3 % too large."""
    size = np.linalg.norm(push, axis=1)
    columns, owner = [], []
    for k, (point, force) in enumerate(zip(points, push, strict=True)):
        normal = force / size[k]
        one = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        one = one / np.linalg.norm(one)
        two = np.cross(normal, one)
        for turn in np.linspace(0.0, 2.0 * np.pi, SIDES + 1)[:-1]:
            drag = np.cos(turn) * one + np.sin(turn) * two
            columns.append(np.concatenate([drag, np.cross(point, drag)]))
            owner.append(k)
    columns, owner = np.array(columns).T, np.array(owner)
    count = columns.shape[1]
    cone = np.zeros((len(points), count + 1))
    cone[owner, np.arange(count)] = 1.0
    cone[:, -1] = -size
    balance = np.hstack([columns, np.zeros((6, 1))])
    cost = np.r_[np.zeros(count), 1.0]
    solved = linprog(cost, A_ub=cone, b_ub=np.zeros(len(points)), A_eq=balance, b_eq=-np.r_[net, moment])
    assert solved.success
    return solved.fun
