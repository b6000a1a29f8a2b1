"""Numbers of a finding that recordings bound on one side or on none."""

import pytest
from thenar_blender.diagnosis import wording


@pytest.mark.parametrize(
    ("low", "high", "said"),
    [
        (0.1, 0.4, "0.2 MPa (0.1–0.4)"),
        (0.1, None, "at least 0.1 MPa"),
        (None, 0.4, "at most 0.4 MPa"),
        (None, None, "not determined"),
        (0.2, 0.2, "0.2 MPa (not fitted)"),
    ],
)
def test_a_number_without_both_ends_is_a_bound(low, high, said):
    assert wording.estimate({"value": 0.2, "low": low, "high": high, "unit": "MPa"}) == said


def test_what_is_read_and_not_fitted_has_no_such_words():
    ceiling = {"value": 20.0, "low": 20.0, "high": 20.0, "unit": "kPa"}
    assert wording.estimate(ceiling, is_fitted=False) == "20 kPa"
    assert wording.estimate({"value": 3.0, "unit": "1"}) == wording.value({"value": 3.0, "unit": "1"})
