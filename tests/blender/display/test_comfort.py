"""Pressure held against thresholds: areas over it by hand-made numbers, sources, export, and what is not known."""

import csv
import json

import bpy
import numpy as np
import pytest
import stage
from thenar_blender.results import comfort
from thenar_blender.results import result as results


def halves(hand, names=("index_distal_pad", "thenar"), edges_mm=(0.0,)):
    """Regions along x that part at `edges_mm`: two, a finger's and the thenar, if not told."""
    part = np.digitize(stage.evaluated(hand)[:, 0], edges_mm)
    for number, name in enumerate(names):
        hand.vertex_groups.new(name=name).add([int(i) for i in np.flatnonzero(part == number)], 1.0, "REPLACE")
    bpy.ops.thenar.assign_regions()


def over(hand, limits):
    """Area over the limits by region, from the attributes alone."""
    pressure, force = stage.attribute(hand, "pressure_kpa"), stage.attribute(hand, "contact_force_n")
    region = stage.attribute(hand, "contact_region")
    area = np.where(pressure > 0, force / np.maximum(pressure, 1e-30) * 1000, 0)
    return [area[(region == k) & (pressure > limit)].sum() for k, limit in enumerate(limits)]


def test_areas_over_the_threshold_are_those_of_the_vertices():
    region, force = np.array([0, 0, 0, 1, 1, -1]), np.array([0.1, 0.2, 0.0, 0.3, 0.1, 9.0])
    pressure = np.array([100.0, 40.0, 0.0, 60.0, 10.0, 900.0])
    verdict = comfort.judged(["index", "palm"], [50.0, 50.0], (pressure, force, region))
    assert verdict.over_mm2 == pytest.approx((1.0, 5.0)), "0.1 N at 100 kPa is 1 mm², 0.3 N at 60 kPa is 5 mm²"
    assert verdict.sentence == "6 mm² (29% of the contact) exceeds its threshold: Palm 5 mm², Index 1 mm²"
    free = comfort.judged(["index", "palm"], [200.0, 0.0], (pressure, force, region))
    assert free.sentence == "No pressure exceeds its threshold; one region has no threshold"


@pytest.mark.parametrize(
    ("region", "part"),
    [
        ("index_distal_pad", "finger"),
        ("thumb_proximal_pad", "finger"),
        ("thenar", "thenar"),
        ("hypothenar", "palm"),
        ("distal_palm_radial", "palm"),
        ("Whole skin", ""),
    ],
)
def test_regions_belong_to_parts_of_the_hand(region, part):
    assert comfort.part_of(region) == part


def test_discomfort_is_a_share_of_the_pain_threshold_that_the_user_types():
    hand, _ = stage.scene()
    halves(hand)
    stage.solve()
    settings = bpy.context.scene.thenar
    settings.comfort.rule = "DISCOMFORT"
    assert settings.result.comfort == "No threshold is known; enter yours under Comfort"
    assert settings.result.over_mm2 == 0.0
    peak = float(stage.attribute(hand, "pressure_kpa").max())
    settings.comfort.finger_kpa, settings.comfort.thenar_kpa = peak / 0.76, peak / 0.44
    rows = {row.name: row for row in settings.result.regions}
    assert rows["index_distal_pad"].threshold_kpa == pytest.approx(peak / 2)
    assert rows["thenar"].threshold_kpa == pytest.approx(peak / 2)
    wanted = over(hand, [peak / 2] * 2)
    assert [row.over_mm2 for row in settings.result.regions] == pytest.approx(wanted, rel=1e-4)
    assert settings.result.over_mm2 == pytest.approx(sum(wanted), rel=1e-4) and sum(wanted) > 1.0


def test_a_finger_has_what_lies_over_the_threshold_in_all_its_regions():
    hand, _ = stage.scene()
    halves(hand, ("index_distal_pad", "index_middle_pad", "thenar"), (-1.0, 1.0))
    settings = bpy.context.scene.thenar
    settings.comfort.rule, settings.comfort.finger_kpa, settings.comfort.thenar_kpa = "OWN", 5.0, 5.0
    result = stage.solve()
    distal, middle, thenar = over(hand, [5.0] * 3)
    assert min(distal, middle, thenar) > 1.0
    told = {finger.name: finger.over_mm2 for finger in result.fingers}
    assert told == {"index": pytest.approx(distal + middle, rel=1e-4), "palm": pytest.approx(thenar, rel=1e-4)}


def test_the_verdict_is_exported_and_shown(tmp_path):
    hand, _ = stage.scene()
    halves(hand)
    settings = bpy.context.scene.thenar
    settings.comfort.rule = "BLOOD_FLOW"
    stage.solve()
    with pytest.raises(RuntimeError, match="choose a threshold under Comfort"):
        settings.comfort.rule = "OFF"
        bpy.ops.thenar.show_map(kind="COMFORT")
    settings.comfort.rule, settings.comfort.finger_kpa, settings.comfort.thenar_kpa = "OWN", 5.0, 10.0
    share, pressure = stage.attribute(hand, "threshold_share"), stage.attribute(hand, "pressure_kpa")
    limit = np.where(stage.attribute(hand, "contact_region") == 0, 5.0, 10.0)
    assert share == pytest.approx(pressure / limit, rel=1e-5)
    assert bpy.ops.thenar.show_map(kind="COMFORT") == {"FINISHED"} and hand.thenar.shows_pressure
    assert bpy.ops.thenar.export(filepath=str(tmp_path / "judged.csv")) == {"FINISHED"}
    rows = list(csv.DictReader((tmp_path / "judged.csv").open()))
    assert [float(row["threshold_share"]) > 1 for row in rows] == list(share > 1)
    told = json.loads(json.dumps(results.as_dict(settings.result)))
    assert told["comfort"] == settings.result.comfort and "exceeds its threshold" in told["comfort"]
    assert [row["threshold_kpa"] for row in told["regions"]] == [5.0, 10.0]
    assert told["over_threshold_mm2"] == pytest.approx(sum(over(hand, [5.0, 10.0])), rel=1e-4)


def test_a_threshold_does_not_make_the_result_out_of_date_and_goes_with_clear():
    from thenar_blender import workflow

    hand, _ = stage.scene()
    stage.solve()
    settings = bpy.context.scene.thenar
    settings.comfort.rule = "BLOOD_FLOW"
    assert not workflow.is_out_of_date(bpy.context) and "threshold_share" in hand.data.attributes
    bpy.ops.thenar.clear()
    assert "threshold_share" not in hand.data.attributes and settings.result.comfort == ""
    settings.comfort.rule = "OFF"
