"""The track record: what counts as right, what the other worlds alone state, and that no scored split is in it."""

import json

import pytest
from trial.worlds import track_record
from trial.worlds.track_record import Said


def finding(effect, posterior=0.99, kind="tissue", channel="force", **more):
    return {"effect": effect, "kind": kind, "channel": channel, "confidence": None, "posterior": posterior} | more


def kept(folder, name, *findings):
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.json").write_text(json.dumps({"verdict": "missing_physics", "findings": findings}))


def test_kinds_part_one_of_two_maps_and_slides():
    skin, other = finding("relaxation"), finding("gain", kind="instrument")
    of = track_record.kind_of
    assert of(skin, [skin], "calibration") == "skin_form_known"
    assert of(other, [other], "finite_element_pads") == "instrument_form_measured"
    assert of(skin, [skin, other], "closed_forms") == "one_of_two_form_known"
    assert of(finding("friction", channel="tangential_force"), [skin], "closed_forms") == "slide"
    # A ceiling of the mat is no second effect of the curves.
    ceiling = finding("saturation", kind="instrument", channel="map")
    assert of(skin, [skin, ceiling], "calibration") == "skin_form_known"
    assert of(ceiling, [skin, ceiling], "calibration") == "mat_ceiling"
    assert of(finding("gain", kind="instrument", channel="map"), [skin], "calibration") == "mat_gain"
    with pytest.raises(ValueError, match="is of kind place"):
        of(skin | {"track_record": {"kind": "place"}}, [skin], "calibration")


def test_findings_of_worlds_are_judged_by_the_truth_in_their_name(tmp_path):
    kept(
        tmp_path,
        "closed_forms_relaxation_depth_jitter_3",
        finding("relaxation"),
        finding("saturation", kind="instrument"),
    )
    kept(tmp_path, "closed_forms_nothing_in_cycles_white_3", finding("relaxation", 0.8))
    kept(tmp_path, "closed_forms_nothing_white_4")
    said = list(track_record.of_worlds(tmp_path))
    assert [(one.is_right, one.posterior) for one in said] == [(False, 0.8), (True, 0.99), (False, 0.99)]


def test_a_world_is_stated_by_the_record_of_the_others():
    good = [Said("a", "skin", 0.99, True)] * 40
    bad = [Said("b", "skin", 0.99, n % 2 == 0) for n in range(20)]
    alone = [Said("c", "place", 0.99, False)]
    rows = {row[0]: row[1:] for row in track_record.left_out(good + bad + alone)}
    # By the first world's record 20 of the second are stated at 90 % or more, and half of them are right.
    assert (len(rows["b"][2]), sum(rows["b"][2])) == (20, 10)
    # By the second world's record none of the first is.
    assert rows["a"][2] == [] and rows["a"][3] == 0
    # Of places nothing is known.
    assert rows["c"] == (1, [False], [], 1)


def test_a_frequency_is_no_more_than_posterior_bound_and_worst_world():
    table = {("skin", 0.9, "a"): [40, 40], ("skin", 0.9, "b"): [12, 20], ("skin", 0.0, "a"): [9, 9]}
    of = track_record.frequency
    assert of(table, Said("", "skin", 0.99, True)) == pytest.approx(0.6)
    assert of(table, Said("", "skin", 0.5, True)) is None
    del table["skin", 0.9, "b"]
    assert 0.9 < of(table, Said("", "skin", 0.99, True)) < 0.95
    assert of(table, Said("", "skin", 0.91, True)) == 0.91


def test_the_record_of_the_library_holds_no_scored_split():
    lines = [line for line in track_record.COUNTS.read_text().splitlines() if not line.startswith("#")]
    worlds = {line.split(",")[2] for line in lines}
    assert lines and worlds <= {
        "calibration",
        "closed_forms",
        "finite_element_pads",
        "grasps_cylinder_60",
        "grasps_cylinder_100",
    }
