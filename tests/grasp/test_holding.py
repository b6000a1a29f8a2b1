"""Force closure and the smallest wrench resisted, against closed forms and a linear program of another library."""

import threading

import numpy as np
import pytest
from scipy.optimize import linprog
from thenar_blender.results import holding

SIDES = 32


def test_a_round_bar_is_held_least_against_turning_about_its_axis():
    radius, half, friction = 24.0, 40.0, 0.38
    held = holding.measure(bar(radius, half, friction))
    wanted = friction * radius / np.hypot(radius, half)
    assert held.least <= wanted * (1.0 + 1e-6) and held.most >= wanted * (1.0 - 1e-6)
    assert held.least == pytest.approx(wanted, rel=0.03)
    assert abs(held.worst[5]) == pytest.approx(1.0, abs=0.05)


def test_without_friction_a_round_bar_may_turn_and_slide():
    held = holding.measure(bar(24.0, 40.0, 0.0))
    assert not held.is_closed and held.least == 0.0


@pytest.mark.parametrize("friction", (0.1, 0.5, 2.0))
def test_two_opposed_points_never_resist_a_turn_about_the_line_between_them(friction):
    points = np.array([[-10.0, 0.0, 0.0], [10.0, 0.0, 0.0]])
    held = holding.measure(holding.Contacts(points, -points / 10.0, friction, np.zeros(3), 10.0))
    assert not held.is_closed
    assert np.abs(held.worst) == pytest.approx([0.0, 0.0, 0.0, 1.0, 0.0, 0.0], abs=1e-3)


def test_two_opposed_disks_resist_a_turn_by_friction_on_their_rims():
    """A pad of two narrow rings: of all wrenches the turn about the line between them is resisted least, by the
    coefficient times the ring's radius for each newton."""
    radius, half, friction = 4.0, 10.0, 0.3
    turn = np.linspace(0.0, 2.0 * np.pi, 49)[:-1]
    ring = radius * np.stack([np.zeros(48), np.cos(turn), np.sin(turn)], axis=1)
    points = np.concatenate([ring + [half, 0.0, 0.0], ring - [half, 0.0, 0.0]])
    inward = np.repeat([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], 48, axis=0)
    arm = float(np.hypot(radius, half))
    held = holding.measure(holding.Contacts(points, inward, friction, np.zeros(3), arm))
    assert held.least == pytest.approx(friction * radius / arm, rel=0.03)


def test_points_on_one_side_close_nothing():
    rng = np.random.default_rng(3)
    points = np.c_[rng.normal(0.0, 10.0, (20, 2)), np.zeros(20)]
    held = holding.measure(holding.Contacts(points, np.tile([0.0, 0.0, 1.0], (20, 1)), 0.5, np.zeros(3), 20.0))
    assert not held.is_closed and held.worst @ [0.0, 0.0, 1.0, 0.0, 0.0, 0.0] > 0.5, "a pull off its own plane"


@pytest.mark.parametrize("friction", (0.2, 0.5))
def test_tetrahedral_points_resist_what_a_linear_program_finds(friction):
    corners = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]]) / np.sqrt(3.0)
    agrees_with_a_linear_program(holding.Contacts(20.0 * corners, -corners, friction, np.zeros(3), 20.0))


@pytest.mark.parametrize("seed", range(10))
def test_random_points_resist_what_a_linear_program_finds(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(0.0, 1.0, (rng.integers(4, 12), 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    inward = -points + 0.2 * rng.normal(0.0, 1.0, points.shape)
    inward /= np.linalg.norm(inward, axis=1)[:, None]
    agrees_with_a_linear_program(holding.Contacts(25.0 * points, inward, 0.6, rng.normal(0.0, 3.0, 3), 30.0))


def test_a_ball_held_all_around_resists_a_turn_least_and_the_work_is_bounded():
    """A turn about any axis: the coefficient for each newton at the radius. Thousands of facets are alike here."""
    count, friction = 400, 0.3
    height, turn = 1.0 - (2.0 * np.arange(count) + 1.0) / count, np.arange(count) * np.pi * (3.0 - np.sqrt(5.0))
    ring = np.sqrt(1.0 - height**2)
    outward = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    contacts = holding.Contacts(20.0 * outward, -outward, friction, np.zeros(3), 20.0)
    held = holding.measure(contacts)
    assert 0.9 * friction < held.least <= friction and 0.99 * friction <= held.most < 1.1 * friction
    stopped = threading.Event()
    stopped.set()
    early = holding.measure(contacts, stopped)
    assert 0.0 <= early.least <= held.most and early.least < held.least, "a cancelled search ends at once"


@pytest.mark.parametrize("seed", range(4))
def test_neither_place_nor_turn_nor_size_of_the_product_changes_it(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(0.0, 20.0, (30, 3))
    push = -points / np.linalg.norm(points, axis=1)[:, None] * rng.uniform(0.5, 4.0, 30)[:, None]
    turn, _ = np.linalg.qr(rng.normal(0.0, 1.0, (3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    before = holding.of_skin(points, push, 0.4)
    after = holding.of_skin(3.0 * points @ turn.T + rng.normal(0.0, 500.0, 3), 7.0 * push @ turn.T, 0.4)
    assert before.quality.is_closed and after.sum_n == pytest.approx(7.0 * before.sum_n)
    assert after.quality.least <= before.quality.most * (1.0 + 1e-6)
    assert before.quality.least <= after.quality.most * (1.0 + 1e-6)
    assert after.arm_mm == pytest.approx(3.0 * before.arm_mm)


def test_what_presses_nothing_has_no_measure():
    assert holding.of_skin(np.zeros((0, 3)), np.zeros((0, 3)), 0.4) is None


def bar(radius, half, friction):
    """Contacts all around a round bar along z."""
    turn, height = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 25)[:-1], np.linspace(-half, half, 12))
    out = np.stack([np.cos(turn.ravel()), np.sin(turn.ravel()), np.zeros(turn.size)], axis=1)
    points = radius * out + height.ravel()[:, None] * [0.0, 0.0, 1.0]
    return holding.Contacts(points, -out, friction, np.zeros(3), float(np.hypot(radius, half)))


def agrees_with_a_linear_program(contacts):
    """No direction is resisted less than `least`, and the worst one no more than `most`; pyramids of `SIDES` sides lie
    inside Coulomb's cones, so that the program's reach is up to 0.5 % of the friction too small."""
    wrenches, short = pyramids(contacts), 1.0 - np.cos(np.pi / SIDES)
    held = holding.measure(contacts)
    slack = short * contacts.friction * 1.5
    rng = np.random.default_rng(0)
    ways = rng.normal(0.0, 1.0, (40, 6))
    for way in ways / np.linalg.norm(ways, axis=1)[:, None]:
        assert reach(wrenches, way) >= held.least - slack
    worst = held.worst / np.linalg.norm(held.worst)
    assert reach(wrenches, -worst) <= held.most + 1e-6
    assert held.least <= held.most and (not held.is_closed or held.least >= 0.95 * held.most)


def reach(wrenches, way):
    """How far the convex hull of wrenches (k, 6) reaches from zero along a unit direction; 0 where zero is outside."""
    count = len(wrenches)
    equal = np.c_[np.r_[wrenches.T, np.ones((1, count))], np.r_[-way, 0.0]]
    found = linprog(np.r_[np.zeros(count), -1.0], A_eq=equal, b_eq=np.r_[np.zeros(6), 1.0], bounds=(0.0, None))
    return -found.fun if found.status == 0 else 0.0


def pyramids(contacts):
    """Wrenches (k * SIDES, 6) on the edges of pyramids in Coulomb's cones."""
    out = []
    for point, normal in zip(contacts.points, contacts.inward, strict=True):
        one = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        one = one / np.linalg.norm(one)
        turn = np.linspace(0.0, 2.0 * np.pi, SIDES + 1)[:-1, None]
        force = normal + contacts.friction * (np.cos(turn) * one + np.sin(turn) * np.cross(normal, one))
        out.append(np.c_[force, np.cross((point - contacts.about_mm) / contacts.arm_mm, force)])
    return np.concatenate(out)
