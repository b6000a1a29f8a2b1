"""The diagnosis in a scene: asked for, kept, read as a letter, shown on the skin, switched on or refused."""

import copy
import json
from types import SimpleNamespace

import bpy
import letters
import numpy as np
import pytest
import small_studies
import stage
from thenar_blender import native
from thenar_blender.diagnosis import curves, diagnosing, freshness, letter, reading
from thenar_blender.scene.checks import Refusal


@pytest.fixture
def diagnose(tmp_path, monkeypatch):
    """Loads a study of the scene's pad and diagnoses it, with the given findings as the library's answer."""
    skin = None

    def run(found, turned=None):
        nonlocal skin
        hand = bpy.context.scene.thenar.hand
        if hand is not None and skin is None:
            hand.data.calc_loop_triangles()
            triangles = np.array([list(each.vertices) for each in hand.data.loop_triangles])
            vertices = np.array([vertex.co for vertex in hand.data.vertices]) * 1e3
            skin = (vertices if turned is None else turned(vertices)), triangles
        point = (0.0, 0.0, 0.0) if skin is None else skin[0][0]
        path = small_studies.write(tmp_path, skin or small_studies.flat_skin(), point)
        answer = found if isinstance(found, Exception) else letters.Answer(found)

        def diagnosed(study, progress=None, cancel=None):
            assert study.title == "Ball"
            if isinstance(answer, Exception):
                raise answer
            return answer

        monkeypatch.setattr(native.module, "diagnose", diagnosed, raising=False)
        if not len(bpy.context.scene.thenar_recordings.items):
            bpy.ops.thenar.load_recording(filepath=str(path))
        return bpy.ops.thenar.diagnose()

    return run


def effects():
    """What is switched on: name -> (amplitude, numbers, region)."""
    listed = [each for each in bpy.context.scene.thenar.hand.thenar.effects if each.is_on]
    numbers = {each.name: {number.name: number.value for number in each.numbers} for each in listed}
    return {each.name: (each.amplitude, numbers[each.name], each.region) for each in listed}


def told():
    """The letter of the scene as lines."""
    return list(letter.lines(letter.write(reading.parse(bpy.context.scene.thenar_diagnosis.findings))))


@pytest.mark.parametrize("verdict", sorted(reading.VERDICTS))
def test_every_verdict_has_its_letter(verdict, diagnose):
    assert diagnose(letters.FINDINGS[verdict]) == {"FINISHED"}
    lines = told()
    assert lines[0] == letter.HEADINGS[verdict] and lines[1] == letters.FINDINGS[verdict]["sentence"]
    assert all(line == line.strip() or line.startswith("   ") for line in lines) and "" not in lines
    assert not any(word in " ".join(lines) for word in ("None", "nan", "_", "[", "{"))


def test_a_share_that_noise_leaves_unknown_is_not_given(diagnose):
    """Of an effect below the noise the interval of the share reaches from far below 0 to 100 %."""
    found = copy.deepcopy(letters.FINDINGS["missing_physics"])
    found["fit"]["reducible_error_removed"] = {"value": 1.0, "low": -22.8, "high": 1.0}
    diagnose(found)
    lines = told()
    assert "The share of the reducible error that is removed cannot be given: noise is larger than the effect." in lines
    assert not any("of the reducible error is removed" in line for line in lines)


def test_the_letter_tells_size_place_time_and_gain(diagnose):
    diagnose(letters.FINDINGS["missing_physics"])
    lines = told()
    for line in (
        "1. Relaxation, 97 % confidence",
        "   Amplitude: 0.34 (0.31–0.37)",
        "   Time: 1.9 s (1.6–2.3)",
        "   Force that fades with time at held depth, by three exponentials of time.",
        "   It lies at the site pad. It shows while holding, at 0.8–30 s, at 1.2–2 mm depth, in 'slow 1', 'slow 2', "
        "'fast 1' and 2 more. It depends on time and speed.",
        "Before: 0.21 N (0.18–0.24)",
        "Noise floor: 0.03 N (0.02–0.04)",
        "96 % (91 % to > 99 %) of the reducible error is removed.",
        "The log predictive density of held-out recordings rises by 374; by the same change on the wrong "
        "recordings and moments (negative control) by 35.3 at most.",
        "Evaluated on 2 held-out recordings: 'sphere 1' and 'sphere 2'.",
        "Detection limit, adhesion: 0.02 J/m²",
        "Detection limit, bone: 17.2 % of the thickness",
        "Detection limit, relaxation: not detectable",
        "Detection limit, saturation: not detectable",
        "   Seen: force at held depth falls with time",
        "   Not seen: fast presses need more force than slow ones",
        "Evidence while pressing in: 25 %",
        "Evidence while holding: 75 %",
        "Fitted, Default: G 20.3 to 90 kPa",
        "The evidence leads by 21 nats.",
    ):
        assert line in lines, lines
    assert [round(bar.share, 3) for bar in letter.write(letters.FINDINGS["missing_physics"]).bars] == [
        1.0,
        0.238,
        0.143,
    ]


def test_curves_of_the_clearest_recordings_are_kept_and_drawn(diagnose):
    diagnose(letters.FINDINGS["missing_physics"])
    kept = curves.read(bpy.context.scene.thenar_diagnosis.curves)
    assert [curve["recording"] for curve in kept] == ["slow 1", "hold"], "in the order in which the finding shows"
    assert (kept[0]["time_s"][0], kept[0]["time_s"][-1], len(kept[0]["time_s"])) == (0.0, 19.9, 80)
    image = curves.picture(kept[0])
    for share, color in ((0.0, curves.MEASURED), (1.0, curves.MEASURED)):
        x = round(10 + share * (curves.WIDTH - 20))
        column = np.abs(image[:, x, :3] - color).sum(axis=1)
        height = 10 + (1.0 + 1.99 * share) / 2.99 * (curves.HEIGHT - 20)
        assert abs(column.argmin() - height) < 2 and column.min() < 0.05, "the first and the last reading"
    before = np.abs(image[:, curves.WIDTH // 4, :3] - curves.BEFORE).sum(axis=1)
    assert abs(before.argmin() - (10 + 2.0 / 2.99 * (curves.HEIGHT - 20))) < 2, "2 N, with parameters alone"
    text = bpy.context.scene.thenar_diagnosis.curves
    assert curves.icon(text, 1) == curves.icon(text, 1), "drawn once; background has no icons, so both are 0"
    (preview,) = curves._held["previews"].values()
    assert tuple(preview.image_size) == (curves.WIDTH, curves.HEIGHT)
    diagnose(letters.FINDINGS["nothing_missing"])
    assert bpy.context.scene.thenar_diagnosis.curves == ""


def test_the_letter_names_rivals_and_the_recording_that_settles_it(diagnose):
    diagnose(letters.FINDINGS["cannot_tell"])
    lines = told()
    assert "These recordings cannot distinguish relaxation from drainage." in lines
    assert "At 90 % the explanation is one of: relaxation; drainage." in lines
    assert "Record next: Hold a sphere of 16 mm or more at the same depth for 30 s, twice." in lines
    assert "Settles it in 87 % of cases, 4 min" in lines


def test_a_finding_changes_the_next_solve(diagnose):
    stage.scene()
    diagnose(letters.FINDINGS["missing_physics"])
    before = stage.solve().peak_kpa
    assert bpy.ops.thenar.apply_finding(index=1) == {"FINISHED"}
    amplitude, numbers, region = effects()["bone"]
    assert (amplitude, numbers["thickness_mm"], region) == (1.0, 2.0, "")
    assert stage.solve().peak_kpa > 1.1 * before, "2 mm over bone press harder than 7 mm"
    assert bpy.ops.thenar.apply_finding(index=1) == {"FINISHED"}
    assert len(bpy.context.scene.thenar.hand.thenar.effects) == 1, "taken over twice, it stands once"
    assert [row.name for row in bpy.context.scene.thenar_diagnosis.model] == ["bone"]


def test_what_acts_over_time_says_that_it_needs_a_bake(diagnose):
    stage.scene()
    diagnose(letters.FINDINGS["missing_physics"])
    assert bpy.ops.thenar.apply_finding(index=0) == {"FINISHED"}
    amplitude, numbers, _ = effects()["relaxation"]
    assert amplitude == pytest.approx(0.34) and numbers["time_3_s"] == pytest.approx(1.9)
    assert numbers["time_2_s"] == 0.5, "what the finding does not tell comes from the findings' own model"
    stage.solve()
    assert any("bake to see it" in text.name for text in bpy.context.scene.thenar.result.warnings)


def test_a_finding_of_one_region_stays_there(diagnose):
    hand, _ = stage.scene()
    found = json.loads(json.dumps(letters.FINDINGS["missing_physics"]))
    found["findings"][1]["where"]["region"] = "left"
    diagnose(found)
    points = stage.evaluated(hand)
    for name, inside in (("left", points[:, 0] < 0.0), ("right", points[:, 0] >= 0.0)):
        hand.vertex_groups.new(name=name).add([int(i) for i in np.flatnonzero(inside)], 1.0, "REPLACE")
    bpy.ops.thenar.assign_regions()
    assert bpy.ops.thenar.apply_finding(index=1) == {"FINISHED"}
    assert effects()["bone"][2] == "left"
    assert bpy.ops.thenar.show_finding(index=1) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert {vertex.index for vertex in hand.data.vertices if vertex.select} == set(np.flatnonzero(points[:, 0] < 0.0))
    hand.thenar.effects[0].region = "right"
    assert bpy.ops.thenar.apply_finding(index=1) == {"FINISHED"}
    assert [effect.region for effect in hand.thenar.effects] == ["right", "left"], "each region has its own"
    hand.thenar.effects.clear()
    hand.thenar.materials["left"].name = "other"
    with pytest.raises(RuntimeError, match="region 'left', which 'Pad' does not list"):
        bpy.ops.thenar.apply_finding(index=1)
    assert not effects()


def turned(points):
    """A skin as another program may have moved it: turned by 90 degrees about x, and shifted."""
    return points[:, [0, 2, 1]] * (1.0, 1.0, -1.0) + (5.0, -3.0, 2.0)


@pytest.mark.parametrize("moved", [None, turned])
def test_an_inclusion_comes_to_lie_at_its_place_on_the_hand(diagnose, moved):
    hand, _ = stage.scene()
    local = np.array([vertex.co for vertex in hand.data.vertices]) * 1e3
    lowest = int(local[:, 2].argmin())
    there = (local if moved is None else moved(local))[lowest]
    diagnose(letters.inclusion(there, 3.0), moved)
    before = stage.solve().peak_kpa
    assert bpy.ops.thenar.apply_finding(index=0) == {"FINISHED"}
    _, numbers, _ = effects()["inclusion"]
    center = [numbers[f"center_{axis}_mm"] for axis in "xyz"]
    assert np.allclose(center, local[lowest], atol=0.02)
    assert (numbers["contrast"], numbers["radius_mm"]) == (4.0, 3.0)
    assert stage.solve().peak_kpa > 1.05 * before, "a stiff place below the contact presses harder"
    assert bpy.ops.thenar.show_finding(index=0) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    chosen = {vertex.index for vertex in hand.data.vertices if vertex.select}
    assert chosen == set(np.flatnonzero(np.linalg.norm(local - local[lowest], axis=1) <= 3.0))


def test_a_bone_slopes_along_the_hand_however_the_study_lay(diagnose):
    stage.scene()
    found = json.loads(json.dumps(letters.FINDINGS["missing_physics"]))
    numbers = {"slope": 0.5, "direction_x": 0.0, "direction_y": 0.6, "direction_z": 0.8}
    found["findings"][1]["parameters"] |= {name: {"value": value, "unit": "1"} for name, value in numbers.items()}
    diagnose(found, turned)
    assert bpy.ops.thenar.apply_finding(index=1) == {"FINISHED"}
    _, told_numbers, _ = effects()["bone"]
    assert [told_numbers[f"direction_{axis}"] for axis in "xyz"] == pytest.approx([0.0, -0.8, 0.6], abs=1e-6)


def test_another_study_begins_with_a_model_of_its_own(diagnose):
    diagnose(letters.FINDINGS["instrument"])
    assert bpy.ops.thenar.apply_finding(index=0) == {"FINISHED"}
    state = bpy.context.scene.thenar_diagnosis
    diagnose(letters.FINDINGS["instrument"])
    assert len(state.model) == 1, "the same study goes on with what was taken over"
    state.path = "/another/study"
    diagnose(letters.FINDINGS["instrument"])
    assert len(state.model) == 0


@pytest.mark.parametrize(
    ("listed", "outcome"),
    [("5,7,9", {5, 7, 9}), ("5,99999", "skin has not"), ("5,x", "list vertices by number")],
)
def test_vertices_that_a_finding_lists_are_selected(diagnose, listed, outcome):
    hand, _ = stage.scene()
    found = letters.inclusion((0.0, 0.0, 0.0), 3.0)
    found["findings"][0]["where"]["vertices_csv"] = listed
    diagnose(found)
    if isinstance(outcome, str):
        with pytest.raises(RuntimeError, match=outcome):
            bpy.ops.thenar.show_finding(index=0)
        return
    assert bpy.ops.thenar.show_finding(index=0) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert {vertex.index for vertex in hand.data.vertices if vertex.select} == outcome


def test_a_place_on_another_skin_is_not_guessed(diagnose):
    diagnose(letters.inclusion((0.0, 0.0, 0.0), 3.0))
    with pytest.raises(RuntimeError, match="[Cc]hoose the hand"):
        bpy.ops.thenar.apply_finding(index=0)
    stage.scene()
    for operator in (bpy.ops.thenar.apply_finding, bpy.ops.thenar.show_finding):
        with pytest.raises(RuntimeError, match="study's skin is not 'Pad'"):
            operator(index=0)
    assert not effects() and not len(bpy.context.scene.thenar_diagnosis.model)


def test_an_instrument_changes_nothing_on_the_skin(diagnose):
    stage.scene()
    diagnose(letters.FINDINGS["instrument"])
    before = stage.solve().input_hash
    assert bpy.ops.thenar.apply_finding(index=0) == {"FINISHED"}
    model = bpy.context.scene.thenar_diagnosis.model
    assert [(row.name, row.kind) for row in model] == [("drift", "instrument")]
    assert json.loads(model[0].parameters)["rate_n_per_min"]["value"] == 0.1
    assert stage.solve().input_hash == before and not effects()


@pytest.mark.parametrize(
    ("verdict", "index", "reason"),
    [
        ("unlisted", 0, "not in Thenar's list"),
        ("cannot_tell", 0, "cannot distinguish relaxation from drainage.*record this first: hold a sphere"),
        ("nothing_missing", 0, "lists no finding"),
        ("missing_physics", 7, "no finding 7; the diagnosis lists 2"),
    ],
)
def test_what_has_no_name_is_not_switched_on(diagnose, verdict, index, reason):
    stage.scene()
    diagnose(letters.FINDINGS[verdict])
    with pytest.raises(RuntimeError, match=reason):
        bpy.ops.thenar.apply_finding(index=index)
    assert not effects() and not len(bpy.context.scene.thenar_diagnosis.model)


def test_a_named_effect_with_a_rival_is_not_switched_on(diagnose):
    stage.scene()
    found = json.loads(json.dumps(letters.FINDINGS["missing_physics"]))
    found["cannot_tell"] = [["bone", "stiffening_law"]]
    diagnose(found)
    with pytest.raises(RuntimeError, match="cannot distinguish bone from stiffening law"):
        bpy.ops.thenar.apply_finding(index=1)
    assert bpy.ops.thenar.apply_finding(index=0) == {"FINISHED"}
    assert set(effects()) == {"relaxation"}


def test_a_finding_in_another_unit_is_refused(diagnose):
    stage.scene()
    found = json.loads(json.dumps(letters.FINDINGS["missing_physics"]))
    found["findings"][1]["parameters"]["thickness_mm"]["unit"] = "m"
    diagnose(found)
    with pytest.raises(RuntimeError, match="thickness_mm in m and Thenar expects mm"):
        bpy.ops.thenar.apply_finding(index=1)
    assert not effects()


def test_the_file_keeps_the_diagnosis(diagnose, tmp_path):
    stage.scene()
    diagnose(letters.FINDINGS["missing_physics"])
    before, path = told(), str(tmp_path / "kept.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert told() == before and freshness.problem(bpy.context.scene.thenar_diagnosis) == ""
    assert bpy.ops.thenar.apply_finding(index=1) == {"FINISHED"}
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert set(effects()) == {"bone"} and len(bpy.context.scene.thenar_diagnosis.model) == 1


def test_findings_of_a_study_that_changed_are_called_old(diagnose, tmp_path):
    stage.scene()
    diagnose(letters.FINDINGS["missing_physics"])
    state = bpy.context.scene.thenar_diagnosis
    (tmp_path / "report.html").write_text("a report beside the study is no change")
    freshness.forget()
    assert freshness.problem(state) == ""
    with (tmp_path / "press.csv").open("a") as file:
        file.write("3.2,0.82,0.2\n")
    freshness.forget()
    assert "has changed since" in freshness.problem(state)
    (tmp_path / "press.csv").unlink()
    (tmp_path / "study.toml").unlink()
    freshness.forget()
    assert "no longer at" in freshness.problem(state)
    state.made_with = "Thenar 0.0.1"
    assert "made with Thenar 0.0.1" in freshness.problem(state)


def test_a_diagnosis_that_fails_leaves_the_last_one(diagnose):
    diagnose(letters.FINDINGS["instrument"])
    before = told()
    with pytest.raises(RuntimeError, match="No press is long enough"):
        diagnose(native.module.RecordingError("no press is long enough"))
    with pytest.raises(RuntimeError, match="unknown verdict 'guess'"):
        diagnose(letters.FINDINGS["instrument"] | {"verdict": "guess"})
    assert told() == before


def test_what_cannot_be_asked_says_why():
    with pytest.raises(RuntimeError, match="[Nn]o study is loaded"):
        bpy.ops.thenar.diagnose()
    for operator in (bpy.ops.thenar.apply_finding, bpy.ops.thenar.show_finding):
        with pytest.raises(RuntimeError, match="[Nn]othing was diagnosed"):
            operator(index=0)
    with pytest.raises(RuntimeError, match="[Nn]othing was found yet"):
        bpy.ops.thenar.report(filepath="/nowhere/report.html")
    item = bpy.context.scene.thenar_recordings.items.add()
    item.kind = "MAP"
    with pytest.raises(RuntimeError, match="mat alone cannot be diagnosed"):
        bpy.ops.thenar.diagnose()


@pytest.mark.parametrize("text", ["", "[]", '{"schema": 2}', '{"schema": 1, "verdict": "unlisted", "findings": [{}]}'])
def test_findings_that_are_none_are_refused(text):
    with pytest.raises(Refusal, match="press Diagnose again"):
        reading.parse(text)


def test_the_library_is_asked_beside_the_window(monkeypatch, tmp_path):
    """Progress and cancel reach the library; nothing of the scene is read or written by the worker."""
    seen = {}

    def diagnosed(study, progress=None, cancel=None):
        seen.update(progress=progress, cancel=cancel)
        return letters.Answer(letters.FINDINGS["nothing_missing"])

    monkeypatch.setattr(native.module, "diagnose", diagnosed, raising=False)
    bpy.ops.thenar.load_recording(filepath=str(small_studies.write(tmp_path, small_studies.flat_skin())))
    steps = diagnosing.steps(bpy.context)
    work = next(steps)
    cancel, progress = SimpleNamespace(is_set=lambda: False), lambda stage, fraction: None
    value = work(cancel, progress)
    assert seen == {"progress": progress, "cancel": cancel}
    assert not bpy.context.scene.thenar_diagnosis.is_valid
    with pytest.raises(StopIteration) as end:
        steps.send(value)
    assert end.value.value["verdict"] == "nothing_missing" and bpy.context.scene.thenar_diagnosis.is_valid
