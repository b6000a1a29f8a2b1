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


@pytest.mark.parametrize("seed", range(12))
def test_fingers_that_ease_need_less_and_no_less_than_a_linear_program_finds(seed):
    rng = np.random.default_rng(100 + seed)
    points = rng.normal(0.0, 25.0, (rng.integers(5, 30), 3))
    push = -points / np.linalg.norm(points, axis=1)[:, None] * rng.uniform(0.5, 8.0, len(points))[:, None]
    push *= rng.uniform(0.8, 1.2, len(points))[:, None]
    net, moment = push.sum(axis=0) + rng.normal(0.0, 1.0, 3), rng.normal(0.0, 40.0, 3)
    found = friction.needed(points, push, *friction.eased(points, push, net, moment))
    assert least_friction(points, push, net, moment, friction.EASE) * 0.995 <= found
    assert found < friction.needed(points, push, net, moment)


def test_two_jaws_on_a_sheet_balance_by_pressing_a_little_harder():
    turn = np.linspace(0.0, 2.0 * np.pi, 25)[:-1]
    pad = 6.0 * np.stack([np.cos(turn), np.zeros(24), np.sin(turn)], axis=1)
    points = np.concatenate([pad + [0.0, 1.5, 0.0], pad - [0.0, 1.5, 0.0]])
    push = np.concatenate([np.tile([0.0, -0.52, 0.0], (24, 1)), np.tile([0.0, 0.5, 0.0], (24, 1))])
    net, moment = push.sum(axis=0), np.cross(points, push).sum(axis=0)
    assert np.isinf(friction.needed(points, push, net, moment)), "the sides of a sheet have no friction across it"
    left = friction.eased(points, push, net, moment)
    assert friction.needed(points, push, *left) == pytest.approx(0.0, abs=1e-6)


def least_friction(points, push, net, moment, ease=0.0):
    """The least coefficient by a linear program: cones of `SIDES` sides inside Coulomb's, so up to 0.3 % too large.

    With `ease` each force may change by that share of itself first, the cone stays that of the force as it was, and
    what counts as nothing may be left over in each direction.
    """
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
    cone = np.zeros((len(points), count + 1 + len(points)))
    cone[owner, np.arange(count)] = 1.0
    cone[:, count] = -size
    harder = np.concatenate([push, np.cross(points, push)], axis=1).T
    arm = np.linalg.norm(points - points.mean(axis=0), axis=1).mean()
    slack = (ease > 0.0) * friction.NOTHING * size.sum()
    rest = np.diag([1.0, 1.0, 1.0, arm, arm, arm])
    balance = np.hstack([columns, np.zeros((6, 1)), harder, rest])
    cone = np.hstack([cone, np.zeros((len(points), 6))])
    cost = np.r_[np.zeros(count), 1.0, np.zeros(len(points) + 6)]
    bounds = [(0.0, None)] * (count + 1) + [(-ease, ease)] * len(points) + [(-slack, slack)] * 6
    solved = linprog(cost, A_ub=cone, b_ub=np.zeros(len(points)), A_eq=balance, b_eq=-np.r_[net, moment], bounds=bounds)
    assert solved.success
    return solved.fun
