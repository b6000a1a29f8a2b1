"""The world of closed forms is what its texts say."""

import numpy as np
import pytest
from trial.worlds import closed_forms, motions


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


def test_a_trigger_begins_depth_where_the_force_passes_it():
    case = closed_forms.draw(3, "nothing", "trigger")
    at_zero = {}
    for one in case.recordings:
        k = int(np.argmax(one.table[:, 1] >= 0.0))
        part = -one.table[k - 1, 1] / (one.table[k, 1] - one.table[k - 1, 1])
        force = one.table[k - 1, 2] + part * (one.table[k, 2] - one.table[k - 1, 2])
        at_zero.setdefault(one.tool, []).append(force)
    least, most = closed_forms.TRIGGER_N
    means = [np.mean(forces) for forces in at_zero.values()]
    assert all(least - 0.003 < mean < most + 0.003 for mean in means) and np.ptp(means) < 0.004


def test_a_tool_whose_length_is_off_shifts_all_its_depths_alike():
    plain, off = (closed_forms.draw(3, "nothing_in_cycles", noise) for noise in ("white", "tool_length"))
    lift = [one.table[0, 1] for one in off.recordings]
    by_tool = {
        one.tool: [a for a, o in zip(lift, off.recordings, strict=True) if o.tool == one.tool] for one in off.recordings
    }
    for lifts in by_tool.values():
        shift = abs(np.mean(lifts) + 0.15)
        assert 0.03 < shift < 0.13 and np.std(lifts) < 0.01
    assert all(abs(one.table[0, 1] + 0.15) < 0.02 for one in plain.recordings)


def test_a_clipped_cell_reads_one_largest_value_in_all_recordings():
    case = closed_forms.draw(3, "saturation", "white")
    most = {recording.table[:, 2].max() for recording in case.recordings}
    assert len(most) == 1 and all((one.table[:, 2] == max(most)).sum() > 1 for one in case.recordings)


def test_zeros_of_recordings_differ_where_cells_are_tared_before_each():
    """Before the tool touches a recording reads its own zero, off by 5 to 20 mN; elsewhere there is none."""
    size = {"tared": [], "white": []}
    for noise, sizes in size.items():
        for seed in range(40):
            tables = [one.table for one in closed_forms.draw(seed, "nothing", noise).recordings]
            zeros = [np.mean(table[table[:, 1] < -0.05, 2]) for table in tables]
            sizes.append(np.sqrt(np.mean(np.square(zeros))))
    assert np.sqrt(np.mean(np.square(size["tared"]))) == pytest.approx(0.0132, rel=0.2)
    assert max(size["white"]) < 0.005


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


def _protocols(motion, deepest):
    """Protocols of eight draws of a motion."""
    return [one for seed in range(8) for one in motions.drawn(motion, deepest, np.random.default_rng(seed))]


@pytest.mark.parametrize("motion", motions.MOTIONS)
def test_motions_go_down_to_the_largest_depth_without_a_jump(motion):
    for _, time, depth in _protocols(motion, 1.2):
        assert 1.15 < depth.max() <= 1.2 + 1e-12 and depth[0] < 0.0
        speeds = np.abs(np.diff(depth) / np.diff(time))
        assert (np.diff(time) > 0.0).all() and speeds.max() <= (1.35 / 0.25 if motion == "short" else 3.0)


def test_kinked_approach_presses_slower_than_it_comes():
    for name, time, depth in _protocols("kinked", 1.2):
        speed = np.gradient(depth, time)
        press = float(name.split()[2])
        assert speed[2] == pytest.approx(0.9) and np.median(speed[(depth > 0.5) & (speed > 0.0)]) == pytest.approx(
            press
        )


def test_a_sine_is_straight_nowhere_and_a_step_has_few_readings():
    for _, time, depth in _protocols("sine", 1.2):
        turns = np.abs(np.diff(depth, 2)) / np.diff(time)[1:] ** 2
        assert np.median(turns) > 1.0
    step = next(one for one in _protocols("short", 1.2) if one[0] == "step")
    assert 1 <= ((step[2] > -0.14) & (step[2] < 1.19) & (step[1] < 2.0)).sum() <= 3


@pytest.mark.parametrize("part", [0.1, 0.3])
def test_an_s_curve_starts_and_stops_at_rest_with_even_acceleration(part):
    along = np.linspace(0.0, 1.0, 2001)
    gone = motions._way(along, part)
    speed = np.diff(gone) / np.diff(along)
    assert gone[0] == 0.0 and gone[-1] == 1.0 and speed[0] < 0.01 and speed[-1] < 0.01
    assert speed.max() == pytest.approx(1.0 / (1.0 - part))
    most = np.abs(np.diff(speed)).max() / along[1]
    assert most == pytest.approx(1.0 / (part * (1.0 - part)), rel=1e-6)


def test_a_ramp_follows_a_stand_and_is_held_for_three_seconds():
    for name, time, depth in _protocols("stand", 1.2):
        step = time[1] - time[0]
        stood = (depth < -motions.LIFT_MM + 1e-9)[time < 1.5].sum() * step
        assert 0.2 <= stood <= 0.9 + 2.0 * step
        assert (depth > 1.2 - 1e-9).sum() * step == pytest.approx(3.0, abs=1.5 * step)
        speed = np.diff(depth)[time[1:] < stood + 1.0] / step
        assert speed.max() == pytest.approx(float(name.split()[2]), rel=0.01)


def test_other_motions_change_no_case_of_straight_ramps_and_are_refused_for_a_truth_that_fades():
    one, other = (closed_forms.draw(4, "nothing", "depth_jitter", motion) for motion in ("ramps", "kinked"))
    assert one.radii == other.radii and one.deepest_mm == other.deepest_mm
    assert len(one.recordings[0].table) != len(other.recordings[0].table)
    with pytest.raises(ValueError, match="no world of relaxation with white and sine"):
        closed_forms.draw(1, "relaxation", "white", "sine")


def test_a_ceiling_of_other_motions_clips_their_presses():
    case = closed_forms.draw(3, "saturation", "white", "kinked")
    most = max(recording.table[:, 2].max() for recording in case.recordings)
    assert all((one.table[:, 2] == most).sum() > 1 for one in case.recordings)


def test_two_together_are_the_product_of_both():
    """What has faded by the end of a hold, and what use has taken from press to press."""
    case = closed_forms.draw(2, "relaxation_and_cycle_softening", "white")
    firsts = {}
    for one in case.recordings:
        firsts.setdefault((one.protocol, one.tool), []).append(one.table[:, 2].max())
    slow, fast = (firsts[name, "ball"] for name in ("0.5 mm/s", "4 mm/s"))
    assert case.rest_s is None and len(slow) == len(fast)
    assert slow[0] > slow[-1] and all(one.table[-1, 1] > 0.7 * case.deepest_mm for one in case.recordings)
    held = [one.table[:, 2] for one in case.recordings if one.tool == "ball"]
    assert all(force[-1] < 0.9 * force.max() for force in held)


def test_a_clipped_cell_reads_its_ceiling_where_tissue_fades_too():
    case = closed_forms.draw(3, "relaxation_and_saturation", "white")
    most = max(one.table[:, 2].max() for one in case.recordings)
    clipped = [one for one in case.recordings if (one.table[:, 2] == most).sum() > 1]
    assert {one.protocol for one in clipped} >= {"4 mm/s"}
    # What has faded lies below the ceiling again.
    assert all(one.table[-1, 2] < most for one in clipped if one.tool == "ball")


def test_strangers_are_what_their_names_say():
    depth = np.concatenate([np.linspace(-0.1, 1.2, 300), np.linspace(1.2, -0.1, 300)])
    time = np.linspace(0.0, 4.0, 600)
    seen = set()
    for seed in range(12):
        strange = closed_forms.Stranger(1.2, np.random.default_rng(seed))
        factor = strange.factor(time, depth)
        seen.add(strange.kind)
        if strange.kind == "pocket":
            np.testing.assert_allclose(factor[:300], factor[:299:-1], atol=5e-3)
            assert factor[0] == pytest.approx(1.0, abs=1e-3) and factor[300] == pytest.approx(
                1 - strange.share, abs=1e-2
            )
        if strange.kind == "pulse":
            power = np.abs(np.fft.rfft(factor - factor.mean()))
            assert np.fft.rfftfreq(600, time[1])[power.argmax()] == pytest.approx(strange.rate_hz, abs=0.25)
        if strange.kind == "stick_slip":
            slips = (np.abs(np.diff(factor)) > 0.5 * strange.share).sum()
            assert slips == pytest.approx(2.6 / strange.period_mm, abs=2)
        assert 0.05 <= strange.share <= 0.15 and np.abs(factor - 1.0).max() <= strange.share + 1e-9
    assert seen == {"pocket", "pulse", "stick_slip"}
