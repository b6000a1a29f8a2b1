"""What thresholds rest on is counted on the cases that it is about, and on no others."""

import pytest
from trial.scoring import thresholds

SEALED = {
    "null": {"stratum": "null", "names": []},
    "other null": {"stratum": "null", "names": []},
    "one": {"stratum": "single", "effect": "relaxation", "names": ["relaxation"]},
    "held back": {"stratum": "ambiguous", "effect": "relaxation", "names": ["relaxation", "drainage"]},
    "decoy": {"stratum": "decoy", "distortion": "offset", "names": ["offset"]},
    "pair": {"stratum": "pair", "effect": "relaxation+bone", "names": ["relaxation", "bone"]},
}


def tried(**rivals):
    """A verdict by evidence of names, those of pairs joined by `_and_`."""
    return {"rivals": [{"effects": names.split("_and_"), "evidence": nats} for names, nats in rivals.items()]}


SAID = {
    "null": tried(bone=-0.2, offset=1.5, bone_and_offset=9.0),
    "other null": tried(bone=-1.0, drift=0.5),
    "one": tried(relaxation=50.0, drainage=48.0, relaxation_and_bone=52.0, drainage_and_bone=60.0),
    "held back": tried(relaxation=10.0, drainage=11.5, bone=12.0, relaxation_and_bone=13.0),
    "decoy": tried(offset=20.0, drift=20.5),
    "pair": tried(relaxation=1.0, drainage=90.0, relaxation_and_bone=99.0),
}


def test_nulls_alone_tell_what_is_reached():
    assert thresholds.reached(SEALED, SAID) == {"bone": -0.2, "offset": 1.5, "drift": 0.5}


def test_a_lead_is_one_over_the_name_that_is_there():
    led = thresholds.led_by(SEALED, SAID)
    assert led == {("relaxation", "drainage"): 1.5, ("relaxation", "bone"): 2.0, ("offset", "drift"): 0.5}


def test_what_a_second_takes_up_is_what_it_adds_to_the_better_of_the_two():
    taken = thresholds.taken_up(SEALED, SAID)
    # 52 - 50 of 50, and 13 - 12 of 10: the most nats and the largest part may be of two cases.
    assert taken == {("relaxation", "bone"): (2.0, pytest.approx(0.1))}


def test_lines_begin_with_the_largest_and_a_case_without_verdict_is_left_out():
    lines = thresholds.lines(SEALED, {name: SAID[name] for name in ("null", "one")})
    assert lines[1:3] == ["  offset: 1.5", "  bone: -0.2"]
    assert lines[-1] == "  bone beside relaxation: 2.0, 4.0 %"


def test_slow_noise_is_held_against_what_it_is():
    """Variance times memory: 1.1 squared times 0.3 s over 0.15 s, and for slow noise four times as long."""
    told = {"evidence": {"noise_share": 0.01, "noise_step": 1.1, "noise_memory_s": 0.3}}
    plain = {"stratum": "single", "noise": 0.01}
    sealed = {
        "plain": plain,
        "slow": plain | {"stratum": "null", "scatter": "slow"},
        "outliers": plain | {"stratum": "null", "scatter": "outliers"},
        "pulse": plain | {"stratum": "unlisted"},
    }
    least, middle, most = thresholds.noise(sealed, dict.fromkeys(sealed, told))
    assert (least, middle, most) == pytest.approx((0.605, 0.5 * (0.605 + 2.42), 2.42))
    assert thresholds.noise(sealed, {}) is None


def test_rhythms_are_told_of_what_beats_and_the_least_chance_of_what_does_not():
    def beats(hz, chance):
        return {"evidence": {"rhythm_hz": hz, "rhythm_chance": chance}, "rivals": []}

    sealed = {"a": {"stratum": "null"}, "b": {"stratum": "null"}, "c": {"stratum": "unlisted", "distortion": "pulse"}}
    said = {"a": beats(0.5, 0.3), "b": beats(2.0, 0.04), "c": beats(1.19, 1e-6)}
    lines = thresholds.lines(sealed, said)
    assert "  nothing: 4.0e-02 at least, of 2" in lines and "  pulse: 1.19 Hz, 1.0e-06" in lines
