"""`thenar.press_ball`: a ball on a layer under a stiff skin that stretches, beside finite elements at finite strain."""

import math

import numpy as np
import pytest
import thenar
from trial import protocols
from trial.drawing import truths
from trial.finite_elements import against_ball

PAD = "forefinger"  # of the calibration
SKINS = {  # as truth_runs.changed has them, which needs numba: variant, amplitude -> thickness mm, modulus over pulp's
    (0, 0.5): (0.4, 10.5),
    (0, 1.0): (0.4, 20.0),
    (1, 1.0): (0.7, 20.0),
}
TOOLS = {"small": "slow, small sphere", "large": "large sphere", "wide": "wide sphere"}


def of_elements(name, key):
    """Depths and forces of a protocol's loading, without first touch."""
    steps = protocols.STEPS[0]
    depths = protocols.course(PAD, name, protocols.STEPS)[steps + 1 : 2 * steps + 1, 1]
    return depths, truths.runs()[f"{PAD}/{key}/{name}"].astype(float)[steps + 1 : 2 * steps + 1]


@pytest.mark.parametrize("skin", SKINS)
@pytest.mark.parametrize("tool", TOOLS)
def test_what_a_skin_adds_is_that_of_finite_elements(skin, tool):
    """Pulp's own finite strain, which a linear layer leaves out, is the same with and without a skin."""
    thickness, radius = protocols.PADS[PAD][1], protocols.radius(PAD, tool)
    skin_mm, ratio = SKINS[skin]
    depths, with_skin = of_elements(TOOLS[tool], f"stiff_skin/{skin[0]}/{skin[1]}")
    _, without = of_elements(TOOLS[tool], "none/0/0")
    ours = thenar.press_ball(radius, depths, thickness, skin_mm=skin_mm, skin_ratio=ratio)
    ours = ours / thenar.press_ball(radius, depths, thickness)
    off = ours / (with_skin / without) - 1.0
    print(f"{tool}, {skin_mm} mm, x {ratio}: adds {(100 * (ours - 1.0)).round(1)} %")
    print(f"  off {(100 * off).round(2)} %")
    assert np.abs(off[2:]).max() < 0.04
    # The first rows lie within 0.13 mm of first touch, where elements are as large as the contact.
    assert np.abs(off).max() < 0.12


def test_what_balls_do_not_share_is_less_than_the_diagnosis_allows_for():
    """At finite strain a pad is up to 3 % softer than a linear one, much alike under all tools."""
    found = against_ball.departures()
    assert all(np.abs(rows[:, :3]).max() < 0.03 for rows in found.values())
    assert (against_ball.not_shared(found) < [0.006, 0.006, 0.003]).all()  # prepare::FORM_ERROR


@pytest.mark.parametrize("skin_mm", [0.0, 0.3])
def test_depths_can_be_asked_for_alone_or_together(skin_mm):
    """What a depth needs does not depend on the depths before it."""
    depths = np.array([0.1, 0.35, 0.7])
    numbers = {"skin_mm": skin_mm, "skin_ratio": 15.0}
    together = thenar.press_ball(6.0, depths, 5.0, **numbers)
    alone = thenar.press_ball(6.0, [0.35, 0.7], 5.0, **numbers)
    assert np.abs(together[1:] / alone - 1.0).max() < 1e-3


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ({"radius_mm": -1.0}, "radius_mm"),
        ({"depths_mm": [0.2, 0.1]}, "depths_mm must rise"),
        ({"depths_mm": []}, "depths_mm"),
        ({"depths_mm": [0.1, math.nan]}, "depths_mm"),
        ({"depths_mm": [7.0]}, "depths_mm"),
        ({"thickness_mm": math.nan}, "half space"),
        ({"poisson_ratio": 0.6}, "poisson_ratio"),
        ({"skin_mm": 5.0, "skin_ratio": 3.0}, "skin_mm"),
        ({"skin_mm": 0.3, "skin_ratio": 0.5}, "skin_ratio"),
    ],
)
def test_numbers_that_are_none_of_a_press_are_refused(numbers, said):
    right = {"radius_mm": 6.0, "depths_mm": [0.1, 0.5], "thickness_mm": 5.0}
    with pytest.raises(thenar.SolveError, match=said):
        thenar.press_ball(**right | numbers)


def test_numbers_at_random_give_forces_or_a_sentence():
    random = np.random.default_rng(20261123)
    solved = 0
    for _ in range(60):
        sizes = 10.0 ** random.uniform(-3.0, 3.0, 3)
        depths = np.sort(10.0 ** random.uniform(-2.5, 0.0, 3)) * sizes[0]
        numbers = {"skin_mm": sizes[2] * 0.1, "skin_ratio": 10.0 ** random.uniform(0.0, 5.0)}
        try:
            forces = thenar.press_ball(sizes[0], depths, sizes[1], random.uniform(0.0, 0.5), **numbers)
        except thenar.SolveError:
            continue
        solved += 1
        assert np.isfinite(forces).all() and (forces >= 0.0).all()
    assert solved > 10
