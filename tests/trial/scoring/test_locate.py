"""A few of the studies of `locate.py`: spots are found within a pitch, and pads without one are left alone."""

import numpy as np
import pytest
from trial.scoring import locate


@pytest.mark.parametrize("number", range(6))
def test_no_place_is_named_on_a_pad_without_a_spot(number):
    assert locate.located(locate.NULLS[number], number, 0.01).places == 0


def test_spots_are_found_within_a_pitch():
    found = [locate.located(case, k, 0.01) for k, case in enumerate(("soft_center", "hard_corner", "hard_shallow"))]
    misses = [one.miss for one in found]
    assert None not in misses and np.median(misses) < 1.0


def test_bounds_of_a_share_are_those_of_wilson():
    """0 of n: 0 to z^2 / (n + z^2), in closed form; 81 of 263: Newcombe 1998, Stat. Med. 17:857, table I, method 3."""
    assert locate.wilson(0, 10) == pytest.approx((0.0, 1.959964**2 / (10 + 1.959964**2)), abs=1e-12)
    assert locate.wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=1e-4)
