"""A bed of springs has its curve, relaxes as a convolution does, never pulls, keeps its damage; mats sum to force."""

import numpy as np
import pytest
from trial.fingertips.pressure_mats import Mat
from trial.fingertips.tissue_bed import Bed, Damage, dragged

DEPTHS = np.arange(0.0, 2.01, 0.02)
HERTZ = Bed(DEPTHS, DEPTHS**1.5)


def test_an_elastic_bed_has_the_curve_it_was_given_both_ways():
    time = np.linspace(0.0, 4.0, 201)
    depth = 2.0 - np.abs(time - 2.0)
    np.testing.assert_allclose(HERTZ.follow(time, depth).force_n, depth**1.5, atol=2e-4)


def test_a_linear_bed_relaxes_as_its_closed_form():
    # F = d: on a ramp of 1 mm/s, (1 - g) t + g tau (1 - exp(-t / tau)); in the hold the branch fades alone.
    share, tau = 0.3, 0.4
    time = np.linspace(0.0, 3.0, 61)
    found = Bed(DEPTHS, DEPTHS).follow(time, np.minimum(time, 1.0), [(share, tau)]).force_n
    branch = share * tau * -np.expm1(-np.minimum(time, 1.0) / tau) * np.exp(-np.maximum(time - 1.0, 0.0) / tau)
    np.testing.assert_allclose(found, (1.0 - share) * np.minimum(time, 1.0) + branch, atol=1e-9)


def test_a_slower_clock_fades_as_one_with_longer_times():
    time = np.linspace(0.0, 3.0, 61)
    depth = np.minimum(time, 1.0)
    slower = HERTZ.follow(time, depth, [(0.3, 0.4)], slower=lambda at: 3.0).force_n
    np.testing.assert_allclose(slower, HERTZ.follow(time, depth, [(0.3, 1.2)]).force_n, atol=1e-12)


def test_a_lift_from_relaxed_tissue_parts_early_and_never_pulls():
    time = np.linspace(0.0, 4.0, 401)
    depth = np.interp(time, [0.0, 1.0, 3.0, 4.0], [0.0, 1.0, 1.0, 0.0])
    followed = HERTZ.follow(time, depth, [(0.3, 0.4), (0.2, 3.0)])
    assert followed.force_n.min() >= 0.0
    apart = depth[(time > 3.0) & (followed.reach_mm == 0.0)].max()
    assert 0.02 < apart < 0.5
    # While loading, contact reaches as deep as the tool does.
    np.testing.assert_allclose(followed.reach_mm[1:100], depth[1:100], atol=0.021)


def test_damage_goes_on_from_press_to_press_and_ends_at_its_share():
    damage = Damage(0.4, 1.0, 1.0)
    time = np.linspace(0.0, 1.0, 51)
    tops = [HERTZ.follow(time, time, (), damage).force_n[-1] for _ in range(40)]
    assert (np.diff(tops) < 0.0).all() and tops[0] < 1.0
    # Springs that are met late bear little and lose little: the share is reached by no more than all.
    assert 0.6 <= tops[-1] < 0.75


def test_skin_is_sheared_before_a_tool_slides_on_it():
    slide = np.concatenate([np.linspace(0.0, 3.0, 31), np.linspace(3.0, -1.0, 41)[1:]])
    force = dragged(slide, np.full(len(slide), 2.0), 0.25, 0.5)
    np.testing.assert_allclose(force[:11], -0.5 * slide[:11], atol=1e-12)
    np.testing.assert_allclose(force[10:31], -0.5)
    assert force[-1] == pytest.approx(0.5) and not dragged(slide, np.full(len(slide), 2.0), 0.0, 0.5).any()


def test_sensels_share_out_the_whole_load_wherever_the_image_lies():
    at = (np.arange(40) - 19.5) * 0.5
    image = np.exp(-(at[:, None] ** 2 + (at[None, :36] - at[:36].mean()) ** 2) / 8.0)
    load = image.sum() * 0.25
    mat = Mat(2.0, (12, 9), (0.3, -0.2))
    for shift in (0.0, 1.3):
        cells = mat.cells(image, 0.5, shift)
        center = np.einsum("ij,ijk->k", cells, mat.stated()) / cells.sum()
        assert cells.sum() * 4.0 == pytest.approx(load, rel=1e-3)
        # The mat lies off by its offset, so that what it reads seems to lie off the other way.
        np.testing.assert_allclose(center, [shift - 0.3, 0.2], atol=0.02)


def test_a_mat_reads_its_faults():
    mat = Mat(2.0, (4, 3), (0.0, 0.0), 2.0, ((1, 1),), 9.0)
    read = mat.read(np.array([[1.0, 2.0, 0.2]] * 2 + [[4.0, 5.0, 6.0]] * 2), (0.0, 0.0, 0.6), np.random.default_rng(1))
    np.testing.assert_allclose(read, [[2.0, 4.0, 0.0], [2.0, 0.0, 0.0], [8.0, 9.0, 9.0], [8.0, 9.0, 9.0]])
    noisy = mat.read(np.full((4, 3), 2.0), (0.03, 0.3, 0.6), np.random.default_rng(2))
    assert noisy[1, 1] == 0.0 and len(set(noisy.ravel())) > 9
