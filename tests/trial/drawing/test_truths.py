"""Truths of the trial between the amplitudes that were computed."""

import numpy as np
import pytest
from trial import cases, protocols
from trial.drawing import make_cases, truths
from trial.scoring import score

GRIPS = [(pad, variant) for pad in ("forefinger", "fingertip", "thumb") for variant in (0, 1)]
LABELS = score.labels("trial") | score.labels("calibration")


@pytest.mark.parametrize("pad, variant", GRIPS)
def test_a_grip_never_pushes_where_nothing_touches(pad, variant):
    if f"{pad}/adhesion/{variant}/1.0/wide sphere" not in truths.runs():
        pytest.skip("no second form on this pad")
    truth = truths.Truth(pad, "adhesion", variant)
    assert len(truth.grips) == len(protocols.GRIPS)
    for name, (_, depth, rest, _) in truth.parts.items():
        for amplitude in np.linspace(0.0, 1.0, 41):
            assert truth.added(name, amplitude)[depth < 0.0].max() < 1e-4 * rest.max()


def test_a_stronger_grip_pulls_more():
    truth = truths.Truth("fingertip", "adhesion")
    pulls = [truth.added("large sphere", amplitude).min() for amplitude in truth.grips]
    assert (np.diff(pulls) < 0.0).all()


@pytest.mark.parametrize("effect", [one for one in protocols.SINGLE if one != "adhesion"])
@pytest.mark.parametrize("variant", [0, 1])
def test_an_effect_is_drawn_as_finite_elements_have_it_between_amplitudes(effect, variant):
    """Within 0.3 % of the largest load and 8 % of what the effect adds (another thickness has another mesh)."""
    pad, amplitude = protocols.BETWEEN
    truth = truths.truth_of(pad, effect, variant)
    assert amplitude not in protocols.FINER
    for name, (time, _, rest, _) in truth.parts.items():
        rows = truths.runs()[f"{pad}/{effect}/{variant}/{amplitude}/{name}"].astype(float)
        added = truths.along(pad, name, rows, time) - rest
        off = truth.added(name, amplitude) - added
        assert np.abs(off).max() < 0.003 * rest.max()
        assert np.linalg.norm(off) < 0.08 * np.linalg.norm(added)


def test_a_little_drainage_is_no_small_part_of_much():
    """Water leaves a stiffer skeleton sooner: on the line from full strength the wide sphere would lose a third."""
    pad, name = "heel_of_hand", "wide sphere"
    truth = truths.truth_of(pad, "drainage", 1)
    depth = truth.parts[name][1]
    held = np.flatnonzero(depth == depth.max())
    little, much = (truth.added(name, amplitude)[held] for amplitude in (0.125, 1.0))
    lost = [one[0] - one[-1] for one in (little, much)]
    assert lost[0] > 3.0 * 0.125 * lost[1] > 0.0


@pytest.mark.parametrize("pair", protocols.PAIRS)
def test_a_pair_is_what_was_computed_at_full_and_each_alone_at_none(pair):
    pair_name, pad = "+".join(pair), "forefinger"
    both = truths.Truth(pad, pair[0]), truths.Truth(pad, pair[1])
    truth = truths.truth_of(pad, pair_name, 0)
    for name in truths.RICH:
        motion = protocols.course(pad, name, protocols.STEPS)
        rows = truths.runs()[f"{pad}/{pair_name}/0/1.0/{name}"].astype(float)
        deep = motion[:, 1] > 0.0
        wanted = truths.along(pad, name, rows, truth.parts[name][0])
        assert np.allclose(truth.whole(name, (1.0, 1.0)), wanted, atol=0.01 * np.abs(rows[deep]).max())
        assert np.allclose(truth.whole(name, (0.5, 0.0)), both[0].whole(name, 0.5))
        assert np.allclose(truth.whole(name, (0.0, 0.5)), both[1].whole(name, 0.5))


def test_what_two_do_together_fades_as_the_product():
    truth = truths.truth_of("fingertip", "bone+relaxation", 0)
    name = "wide sphere"

    def together(one, other):
        alone = truth.both[0].added(name, one) + truth.both[1].added(name, other)
        return truth.added(name, (one, other)) - alone

    assert np.allclose(together(0.2, 0.3), 0.06 * together(1.0, 1.0))


def test_each_of_two_is_as_severe_as_planned_where_it_can_be():
    """An amplitude below 1 was found by what the effect does alone; of a grip the closest that was computed."""
    pairs = {name: label for name, label in LABELS.items() if label["stratum"] == "pair"}
    assert len(pairs) >= 30
    for name, label in pairs.items():
        plan = label | {"pad": cases.index()[name]["pad"], "published": cases.index()[name]["published"]}
        found = make_cases.alone(plan, label["amplitudes"], label["g_mpa"])
        for effect, amplitude, kappa in zip(label["effect"].split("+"), label["amplitudes"], found, strict=True):
            if effect == "adhesion":
                assert amplitude in protocols.GRIPS
            elif amplitude < 0.999:
                assert kappa == pytest.approx(label["wanted_kappa"], rel=0.01)
