"""What is on no list is not named, and an oracle that knows its form says whether it could have been seen."""

import json

import numpy as np
import pytest
import thenar
from trial.oracles import strangers
from trial.worlds import closed_forms


def diagnosed(seed, noise, folder):
    """What is said of a stranger."""
    closed_forms.draw(seed, "stranger", noise).write(folder)
    return json.loads(thenar.diagnose(thenar.Study.load(folder)).to_json())


@pytest.mark.parametrize(("noise", "seed"), [("stray", 3001), ("in_proportion", 3003), ("mixture", 3002)])
def test_a_joint_that_sticks_and_slips_is_unlisted(noise, seed, tmp_path):
    """Nothing was missing, while waves were looked for in sums over parts of a phase, which hold several of them."""
    said = diagnosed(seed, noise, tmp_path)
    assert said["verdict"] == "unlisted" and said["findings"] == []
    assert any("short waves" in note for note in said["notes"]), said["notes"]


@pytest.mark.parametrize(("noise", "seed"), [("white", 3004), ("gain_scatter", 3005)])
def test_a_pocket_that_passes_for_a_stiff_skin_or_a_stiffening_law_is_unlisted(noise, seed, tmp_path):
    """These explain a fifth of what a free curve over depth does, and were named while nothing else was asked."""
    said = diagnosed(seed, noise, tmp_path)
    assert said["verdict"] == "unlisted" and said["findings"] == []
    assert any("follow one curve over depth" in note for note in said["notes"]), said["notes"]


@pytest.mark.parametrize(("noise", "seed"), [("encoder", 3002), ("in_proportion", 3002)])
def test_a_pocket_under_flat_skin_is_unlisted_also_on_a_half_space(noise, seed, tmp_path):
    """Nothing was missing, while a half space's flat skin was taken for a finger whose bone is not stated."""
    said = diagnosed(seed, noise, tmp_path)
    assert said["verdict"] == "unlisted" and said["findings"] == []
    assert any("a ball on flat skin is known to 0.6 %" in note for note in said["notes"])
    assert not any("bone" in note for note in said["notes"])


@pytest.mark.parametrize(("noise", "seed"), [("white", 10410), ("white", 10415)])
def test_a_joint_that_sticks_and_slips_at_the_same_depths_is_unlisted(noise, seed, tmp_path):
    """Nothing was missing, while waves were compared by time in one protocol; an oracle sees each by 19 and more."""
    presses, reader, _ = strangers.drawn(seed, noise)
    assert strangers.length(presses, reader) > 4.0 * strangers.SURE
    said = diagnosed(seed, noise, tmp_path)
    assert said["verdict"] == "unlisted" and said["findings"] == []
    assert any("share, depth by depth, short waves" in note for note in said["notes"]), said["notes"]


def test_short_waves_are_seen_through_a_hum(tmp_path):
    """They were left out where a hum was larger; now a hum of its own phase and size is taken off each recording."""
    said = diagnosed(12001, "hum", tmp_path)
    assert said["verdict"] == "unlisted" and said["findings"] == []
    assert any("short waves" in note for note in said["notes"]), said["notes"]
    assert any("the force hums at 1.81 Hz" in note for note in said["notes"]), said["notes"]


@pytest.mark.parametrize(("noise", "seed"), [("gain_scatter", 12003), ("stray_depth", 12003)])
def test_a_pulse_that_grows_with_the_force_is_unlisted(noise, seed, tmp_path):
    """Nothing was missing, while it was sought by what a sample adds to the gain, which is little in a hold."""
    said = diagnosed(seed, noise, tmp_path)
    assert said["verdict"] == "unlisted" and said["findings"] == []
    _, _, stranger = strangers.drawn(seed, noise)
    assert said["evidence"]["rhythm_hz"] == pytest.approx(stranger.rate_hz, abs=0.05)


@pytest.mark.parametrize(("noise", "seed"), [("encoder", 12002), ("clock", 12003)])
def test_a_stiff_skin_that_needs_another_depth_0_is_only_suspected(noise, seed, tmp_path):
    """A pocket was named a stiff skin, "at least 95 % right", with a first touch that was 0.04 and 0.06 mm off."""
    said = diagnosed(seed, noise, tmp_path)
    assert said["findings"] == [] and said["suspected"] == ["stiff_skin"]
    assert any("fits only with a depth 0 that is off" in note and "first_touch_mm" in note for note in said["notes"])


def test_what_leaves_clear_waves_is_only_suspected(tmp_path):
    """Stick and slip was named drainage and a late clock, which leave waves of 15 standard errors."""
    said = diagnosed(12002, "autocorrelated", tmp_path)
    assert said["verdict"] == "unlisted" and said["findings"] == []
    assert "timing" in said["suspected"]
    assert any("would not be enough: " in note for note in said["notes"]), said["notes"]


@pytest.mark.parametrize("noise", closed_forms.NOISES)
def test_length_grows_with_what_is_added_and_not_with_what_else_makes_it(noise):
    presses, reader, _ = strangers.drawn(1, noise)
    whole = strangers.length(presses, reader)
    assert np.isfinite(whole) and whole > 0.0
    for press in presses:
        press.force = press.without + 2.0 * (press.force - press.without)
    assert strangers.length(presses, reader) == pytest.approx(2.0 * whole, rel=1e-6)
    # A stiffer tissue that is touched later is no stranger; neither is nothing.
    for press in presses:
        press.force = 1.1 * press.without - 0.02 * press.slope
    assert strangers.length(presses, reader) < 1.0
    for press in presses:
        press.force = press.without
    assert strangers.length(presses, reader) == 0.0


def test_length_is_that_of_independent_noise_where_nothing_is_free():
    """A saw of 10 mN at each of 50 samples in white noise of 5 mN: the root of 50, times two."""
    _, reader, _ = strangers.drawn(1, "white")
    time = np.linspace(0.0, 1.0, 50)
    force = np.full(50, 1e-9)
    saw = 0.01 * (-1.0) ** np.arange(50)
    press = strangers.Press(time, time, force + saw, force, np.zeros(50), "ball")
    assert strangers.length([press], reader) == pytest.approx(2.0 * np.sqrt(50.0), rel=1e-3)
