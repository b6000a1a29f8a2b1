"""The world of closed forms is what its texts say."""

import numpy as np
import pytest
from trial.worlds import closed_forms


def test_shallow_sphere_is_hertz():
    for radius in (4.0, 20.0):
        depth = np.array([0.002, 0.01, 0.02])
        hertz = 16.0 / 3.0 * np.sqrt(radius) * depth**1.5
        np.testing.assert_allclose(closed_forms.pressed(depth, radius), hertz, rtol=4e-3)
    assert closed_forms.pressed(np.array([-1.0, 0.0]), 5.0).tolist() == [0.0, 0.0]


def test_deep_sphere_meets_a_contact_radius_of_half_its_own():
    radius = 6.0
    a = 0.5 * radius
    depth = 0.5 * a * np.log(3.0)
    force = 2.0 * ((a**2 + radius**2) * np.log(3.0) - 2.0 * a * radius)
    assert closed_forms.pressed(np.array([depth]), radius)[0] == pytest.approx(force, rel=1e-4)


def test_step_fades_as_its_terms_do():
    time = np.concatenate([np.linspace(0.0, 0.001, 20), np.linspace(0.01, 3.0, 300)])
    depth = np.minimum(time / 0.001, 1.0)
    fading = [(0.2, 0.5), (0.1, 4.0)]
    found = closed_forms._faded(time, depth, 5.0, fading)[-1] / closed_forms.pressed(np.array([1.0]), 5.0)[0]
    assert found == pytest.approx(0.7 + 0.2 * np.exp(-3.0 / 0.5) + 0.1 * np.exp(-3.0 / 4.0), rel=3e-3)


def test_a_clipped_cell_reads_one_largest_value_in_all_recordings():
    case = closed_forms.draw(3, "saturation", "white")
    most = {recording.table[:, 2].max() for recording in case.recordings}
    assert len(most) == 1 and all((one.table[:, 2] == max(most)).sum() > 1 for one in case.recordings)


@pytest.mark.parametrize("noise", closed_forms.NOISES)
def test_draws_repeat_and_clocks_go_forward(noise):
    one, other = (closed_forms.draw(4, "nothing", noise) for _ in range(2))
    for a, b in zip(one.recordings, other.recordings, strict=True):
        np.testing.assert_array_equal(a.table, b.table)
        written = np.round(a.table[:, 0], 5)
        assert (np.diff(written) > 0.0).all()
        assert a.table[:, 2].max() > 0.05
    with pytest.raises(ValueError, match="no world"):
        closed_forms.draw(1, "nothing", "magic")
