"""What *Switch On* puts on the hand: the numbers that the contact model was tried with, and a doubt."""

import json

import bpy
import letters
import pytest
import stage
from thenar_blender.diagnosis import applying
from thenar_blender.scene.checks import Refusal


def tried(removed):
    """A thin bone whose number in the contact model is not the fit's, and what the contact model removes with it."""
    found = json.loads(json.dumps(letters.FINDINGS["missing_physics"]))
    found["findings"][1]["parameters"]["thickness_mm"] = {"value": 4.0, "unit": "mm", "low": 3.0, "high": 5.0}
    found["model"]["effects"] = [{"name": "bone", "amplitude": 1.0, "thickness_mm": 4.75}]
    share = {"value": removed, "low": 0.0, "high": 1.0}
    found["fit"]["by_contact_model"] = {
        "reducible_error_removed": share,
        "is_behind_the_fit": removed < 0.7,
        "removed_by_the_fit": 0.96,
        "moduli_over_the_fits": [1.0, 1.0],
    }
    return found


@pytest.mark.parametrize(
    ("removed", "doubt"),
    [
        (0.9, ""),
        (0.4, "removes 40 % of the error of held-out recordings, the fit 96 %"),
        (-0.5, "no better than without"),
    ],
)
def test_what_is_switched_on_has_the_numbers_that_the_contact_model_was_tried_with(removed, doubt):
    hand, _ = stage.scene()
    bpy.context.scene.thenar_diagnosis.findings = json.dumps(tried(removed))
    taken = applying.apply(bpy.context, 1)
    bone = next(effect for effect in hand.thenar.effects if effect.name == "bone")
    assert bone.numbers["thickness_mm"].value == pytest.approx(4.75)
    assert doubt in taken.doubt and bool(doubt) == ("contact model" in taken.doubt)


def test_moduli_that_belong_to_the_numbers_are_said():
    stage.scene()
    found = tried(0.9)
    found["model"]["materials"] = {"skin": {"g0_mpa": 0.012, "g_lim_mpa": 0.03}}
    found["fit"]["by_contact_model"]["moduli_over_the_fits"] = [1.2, 0.8]
    bpy.context.scene.thenar_diagnosis.findings = json.dumps(found)
    assert "G0 12 kPa and G Limit 30 kPa" in applying.apply(bpy.context, 1).doubt


def test_what_the_contact_model_was_not_asked_about_bears_no_doubt_of_it():
    stage.scene()
    found = tried(-0.5)
    found["model"]["effects"] = [{"name": "relaxation", "amplitude": 0.2}]
    bpy.context.scene.thenar_diagnosis.findings = json.dumps(found)
    assert "contact model" not in applying.apply(bpy.context, 1).doubt


def test_what_the_contact_model_answers_worse_with_than_without_is_refused_and_the_scene_stays():
    hand, _ = stage.scene()
    found = tried(-25.4)
    found["fit"]["by_contact_model"] |= {
        "is_worse_than_without": True,
        "after": {"rms": 2.866},
        "before": {"rms": 1.07},
    }
    bpy.context.scene.thenar_diagnosis.findings = json.dumps(found)
    with pytest.raises(Refusal, match="its error is 2.87 instead of 1.07 standard deviations of the noise"):
        applying.apply(bpy.context, 1)
    assert not len(hand.thenar.effects) and "bone" not in bpy.context.scene.thenar_diagnosis.model
    # Of another effect nothing was asked.
    found["model"]["effects"] = [{"name": "relaxation", "amplitude": 0.2}]
    bpy.context.scene.thenar_diagnosis.findings = json.dumps(found)
    assert applying.apply(bpy.context, 1).sentence
