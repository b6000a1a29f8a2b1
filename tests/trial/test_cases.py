"""The trial's cases: what the finite elements hold, how well the truths hide, and that Thenar reads the studies."""

import json
from pathlib import Path

import numpy as np
import pytest
import thenar
from proof import meshes, pressing
from trial import cases, protocols
from trial.drawing import make_cases, make_larger
from trial.scoring import ceiling, counts, score

HERE = Path(__file__).parent
RUNS = dict(np.load(HERE / "drawing/truth_runs.npz"))
LEAST = {"null": 60, "decoy": 40, "single": 90, "pair": 10, "unlisted": 20, "ambiguous": 12, "local": 30}


def run(key, protocol, pad="fingertip"):
    """(times, depths, forces) of a computation, from first touch on."""
    motion = protocols.course(pad, protocol, protocols.STEPS)
    return motion[:, 0], motion[:, 1], RUNS[f"{pad}/{key}/{protocol}"].astype(float)


def test_the_trials_elements_agree_with_felupe():
    """Another program on the same mesh; at the first depth few points touch, and the two place them differently."""
    for row in json.loads((HERE / "finite_elements/axisymmetric_by_felupe.json").read_text()):
        assert np.abs(np.divide(row["own_n"], row["felupe_n"]) - 1.0)[1:].max() < 0.008


@pytest.mark.parametrize("protocol", protocols.PROTOCOLS)
def test_every_equilibrium_was_found(protocol):
    assert all(np.isfinite(force).all() for key, force in RUNS.items() if key.endswith(f"/{protocol}"))


def test_the_base_remembers_nothing():
    """Its force is one function of depth, at every speed, up and down."""
    _, depth, slow = run("none/0/0", "slow, small sphere")
    assert np.allclose(slow, RUNS["fingertip/none/0/0/fast, small sphere"], atol=1e-4 * slow.max())
    peak = depth.argmax()
    back = np.interp(depth[:peak], depth[: peak - 1 : -1], slow[: peak - 1 : -1])
    assert np.abs(back - slow[:peak]).max() < 0.01 * slow.max()


def test_relaxation_fades_while_held_and_dry_friction_does_not():
    base = run("none/0/0", "slow, small sphere")[2]
    for effect, fades in (("relaxation", True), ("rate_independent_loss", False), ("drainage", True)):
        _, depth, force = run(f"{effect}/0/1.0", "slow, small sphere")
        held = np.flatnonzero(depth == depth.max())
        drop = (force[held[0]] - force[held[-1]]) / base.max()
        assert drop > 0.02 if fades else abs(drop) < 0.002


def test_water_takes_longer_under_a_larger_tool_and_relaxation_does_not():
    def half(effect, protocol):
        time, depth, force = run(f"{effect}/0/1.0", protocol)
        held = np.flatnonzero(depth == depth.max())
        share = (force[held[0]] - force[held]) / (force[held[0]] - force[held[-1]])
        return np.interp(0.5, share, time[held] - time[held[0]])

    small, large = "fast, small sphere", "large sphere"
    assert half("drainage", large) > 1.2 * half("drainage", small)
    assert half("relaxation", large) < 1.2 * half("relaxation", small)


def test_adhesion_pulls_only_on_the_way_out():
    _, depth, force = run("adhesion/0/1.0", "slow, small sphere")
    base = run("none/0/0", "slow, small sphere")[2]
    assert force.min() < -0.01 * force.max()
    peak = depth.argmax()
    assert np.allclose(force[:peak], base[:peak], atol=1e-3 * base.max())


def test_cycles_soften():
    _, depth, force = run("cycle_softening/0/1.0", "cycles, small sphere")
    peaks = force[np.flatnonzero(depth == depth.max())]
    assert len(peaks) == protocols.CYCLES and (np.diff(peaks) < 0.0).all()


def test_a_thinner_pad_is_stiffer_most_under_the_widest_tool():
    thin = {
        tool: RUNS[f"fingertip/bone/0/1.0/{tool}"].max() / RUNS[f"fingertip/none/0/0/{tool}"].max() for tool in WIDER
    }
    assert 1.0 < thin[WIDER[0]] < thin[WIDER[1]] < thin[WIDER[2]]


WIDER = ("slow, small sphere", "large sphere", "wide sphere")


@pytest.mark.parametrize("pad", ["forefinger", "fingertip", "palm", *protocols.SECOND])
def test_the_base_model_holds_what_has_no_effect(pad):
    """Thenar's layer, G0 and Glim fitted to three spheres together: a null is one. Share of full scale, rms."""
    thickness, deepest = protocols.PADS[pad][1], protocols.depth(pad)
    text = cases.skin(pad).split("end_header\n")
    count = int(text[0].split("element vertex ")[1].split()[0])
    lines = text[1].splitlines()
    vertices = np.array([line.split() for line in lines[:count]], dtype=float)
    triangles = np.array([line.split()[1:] for line in lines[count:]], dtype=int)
    skin = thenar.Skin(vertices, triangles, materials=[pressing.material(0.01, thickness)])
    columns, seen = [], []
    for protocol in WIDER:
        radius = protocols.radius(pad, protocols.PROTOCOLS[protocol].tool)
        _, depth, force = run("none/0/0", protocol, pad)
        rows = np.arange(protocols.STEPS[0] + 3, 2 * protocols.STEPS[0] + 1, 3)
        reach = min(2.2 * np.sqrt(2.0 * radius * deepest), 1.4 * radius)
        tools = [meshes.sphere(radius, (0.0, 0.0, radius - depth[k]), reach, 0.15) for k in rows]
        model = np.array([np.linalg.norm(skin.press(*tool).total_force_n) for tool in tools])
        columns.append(np.stack([model, model * depth[rows] / deepest], axis=1) / force.max())
        seen.append(force[rows] / force.max())
    columns, seen = np.concatenate(columns), np.concatenate(seen)
    left = seen - columns @ np.linalg.lstsq(columns, seen, rcond=None)[0]
    assert np.sqrt((left**2).mean()) < 0.01


@pytest.mark.parametrize("split", ["trial", "second"])
def test_thenar_reads_every_kind_of_study(split, tmp_path):
    sealed = score.labels(split)
    kinds = {label["stratum"]: name for name, label in sealed.items()}
    for case in kinds.values():
        cases.write(case, tmp_path / case)
        study = thenar.Study.load(tmp_path / case)
        assert study.warnings == []
        for recording in study.recordings:
            if recording.kind == "indentation":
                assert recording.curve.channels.force_n.max() > 0.0
            else:
                assert np.nanmax(recording.map.pressure_kpa) > 1.0 and len(recording.sensels.area_mm2) == 64


def test_what_is_recorded_next_is_added(tmp_path):
    case = next(name for name in cases.names("trial") if len(cases.held_back(name)) > 1)
    cases.write(case, tmp_path / "before")
    protocol, published = cases.held_back(case)[0], cases.index()[case]["published"][0]
    cases.follow_up(case, {protocol: 3, published: 2}, tmp_path / "after")
    before, after = (thenar.Study.load(tmp_path / name).recordings for name in ("before", "after"))
    assert [one.protocol for one in after[len(before) :]] == [protocol, published, protocol, published, protocol]
    peaks = [one.curve.channels.force_n.max() for one in after if one.protocol == published]
    assert len(set(peaks)) == len(peaks) and np.ptp(peaks) < 0.5 * max(peaks)
    with pytest.raises(ValueError, match="there is no protocol dance"):
        cases.follow_up(case, {"dance": 2}, tmp_path)
    with pytest.raises(ValueError, match="was recorded 12 times more, not 13"):
        cases.follow_up(case, {protocol: 13}, tmp_path)


def test_what_is_recorded_next_is_of_the_same_truth():
    """The mean of twelve presses lies as near to the study's own as scatter and noise let it."""
    own = 0
    for case in cases.names("trial"):
        label = score.labels("trial")[case]
        if label["stratum"] != "ambiguous" or not cases.held_back(case):
            continue
        protocol = cases.index()[case]["published"][0]
        mean = np.mean([force for _, _, _, force in cases.recorded_next(case, {protocol: 12})], axis=0)
        first = next(k for k, one in enumerate(cases.recordings(case)) if one["protocol"] == protocol)
        _, _, force = cases.curve(case, first)
        assert abs(np.vdot(mean, force) / np.vdot(mean, mean) - 1.0) < 5.0 * make_cases.REPEAT_GAIN
        own += 1
    assert own >= 12


@pytest.mark.parametrize("split, lacking", [("trial", ()), ("second", ("local",))])
def test_a_trial_is_as_large_as_it_must_be_and_hides_its_truths(split, lacking):
    sealed = score.labels(split)
    found = {stratum: sum(label["stratum"] == stratum for label in sealed.values()) for stratum in LEAST}
    assert all(found[stratum] >= least for stratum, least in LEAST.items() if stratum not in lacking), found
    plain = ("null", "poor", "local", "faint", "beyond")
    hidden = [label["r2"] for label in sealed.values() if label["stratum"] not in plain]
    assert np.mean(np.array(hidden) >= counts.CONCEALED) >= 0.6


def test_splits_share_no_pad():
    pads = [{("mat" in about(name), about(name)["pad"]) for name in cases.names(split)} for split in score.SPLITS]
    assert sum(map(len, pads)) == len(set.union(*pads)) > len(pads)


def test_a_larger_draw_is_of_the_calibrations_pads_and_of_none_of_its_cases(tmp_path, monkeypatch):
    make_larger.make(tmp_path, times=1)
    monkeypatch.setenv(cases.LARGER, str(tmp_path))
    cached = (cases.index, cases._numbers)
    for one in cached:
        one.cache_clear()
    try:
        sealed, kept = score.labels("larger"), score.labels("calibration")
        kept = [label for name, label in kept.items() if "mat" not in about(name)]
        assert len(sealed) == len(kept) > 0
        moduli = [{tuple(label["g_mpa"]) for label in some} for some in (sealed.values(), kept)]
        assert len(moduli[0]) == len(sealed) and not moduli[0] & moduli[1]
        assert {about(name)["pad"] for name in sealed} == {"forefinger", "thenar"}
        cases.write(next(iter(sealed)), tmp_path / "study")
        assert thenar.Study.load(tmp_path / "study").recordings
    finally:
        monkeypatch.undo()
        for one in cached:
            one.cache_clear()


def about(case):
    """What the public index tells of a case."""
    return cases.index()[case]


def test_ambiguous_cases_are_ambiguous_and_single_ones_are_not():
    """The closest other effect, fitted instead, leaves little beside the noise; of a single effect it leaves more."""
    for label in score.labels("trial").values():
        if label["stratum"] == "ambiguous":
            assert label["rival_kappa"] < 0.5 and label["names"] == [label["effect"], label["rival"]]
        if label["stratum"] == "single":
            assert label["rival_kappa"] >= 0.3


def test_the_second_trial_asks_for_what_its_recordings_hold():
    """Seen and told apart is one name, seen and not told apart two; of what is asked the oracle is nearly sure."""
    asked = 0
    for name, label in score.labels("second").items():
        if label["stratum"] not in ("single", "ambiguous"):
            assert label["stratum"] not in ("pair", "mixed") or counts.holds_answer(label)
            continue
        seen, told = ceiling.separations(about(name), label)
        assert seen >= ceiling.SEEN and (told >= ceiling.TOLD) == (label["stratum"] == "single")
        closest = [ceiling.closest(about(name), label)] if label["stratum"] == "ambiguous" else []
        assert label["names"] == [label["effect"], *closest] and counts.holds_answer(label)
        asked += 1
    assert asked > 100
