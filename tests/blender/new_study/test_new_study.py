"""A study made from files of other units, names and decimal commas: the library reads from it what was recorded."""

import tomllib

import bpy
import laboratory
import numpy as np
import pytest
import thenar
from thenar_blender.new_study import drafting, writing


def draft():
    return bpy.context.scene.thenar_new_study


def choose(folder, *names):
    """Choose files in the folder, as the file browser does."""
    return bpy.ops.thenar.new_study(directory=f"{folder}/", files=[{"name": name} for name in names])


def answer(diameter_mm=12.0, **columns):
    """Give every protocol a ball, and every head these answers."""
    for protocol in draft().protocols:
        protocol.shape, protocol.diameter_mm = "SPHERE", diameter_mm
    for head in draft().columns:
        for name, value in columns.items():
            setattr(head, name, value)


def read(folder):
    """The study's curves by file, as the library reads them from what was written."""
    study = thenar.Study.load(folder)
    listed = tomllib.loads((folder / "study.toml").read_text())["recordings"]
    named = {recording.name: recording for recording in study.recordings}
    return {each["file"]: (each, named[each["name"]].curve) for each in listed}


def is_as_recorded(curve, rows, length="depth_mm"):
    truth = np.array(rows)
    channels = curve.channels
    for name, column in (("time_s", 0), (length, 1), ("force_n", 2)):
        np.testing.assert_allclose(np.asarray(channels[name]), truth[:, column], rtol=2e-6, atol=2e-6)
    return True


def test_three_repeats_in_the_usual_units_ask_for_the_tool_alone(tmp_path):
    rows = {f"press_{k}.csv": laboratory.press(k) for k in (1, 2, 3)}
    names = [laboratory.write(tmp_path / name, each) for name, each in rows.items()]
    assert choose(tmp_path, *reversed(names)) == {"FINISHED"}
    assert [item.name for item in draft().files] == names
    assert not len(draft().columns)
    assert [item.protocol for item in draft().files] == [1, 1, 1]
    assert "diameter" in drafting.problem(bpy.context)
    assert not bpy.ops.thenar.write_study.poll()
    answer()
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    assert not draft().is_open
    item = bpy.context.scene.thenar_recordings.items[0]
    assert (item.kind, item.about) == ("STUDY", "study of 3 recordings")
    found = read(tmp_path)
    assert len({each["protocol"] for each, _ in found.values()}) == 1
    assert all(is_as_recorded(found[name][1], each) for name, each in rows.items())
    (tool,) = tomllib.loads((tmp_path / "study.toml").read_text())["indenters"].values()
    assert tool == {"shape": "sphere", "radius_mm": 6.0}


EXPORTS = {
    "thousandths": ({"head": ("time_ms", "depth_um", "force_mN"), "factors": (1e3, 1e3, 1e3)}, {}),
    "decimal commas, units below": (
        {
            "head": ("Zeit", "Eindringtiefe", "Kraft"),
            "units": (("s", "mm", "N"),),
            "separator": ";",
            "comma": True,
            "above": ("Prüfbericht 7;;", ""),
        },
        {"depth_zero": "TOUCH"},
    ),
    "no units, tabs": (
        {"head": ("Time", "Extension", "Load"), "separator": "\t", "factors": (1.0, 1.0, 1e3)},
        {"time_unit": "S", "depth_unit": "MM", "force_unit": "MN", "depth_zero": "TOUCH"},
    ),
    "unknown names, away from the skin": (
        {"head": ("alpha", "beta", "gamma"), "factors": (1.0, -1e3, -1.0)},
        {
            "time": "alpha",
            "depth": "beta",
            "force": "gamma",
            "time_unit": "S",
            "depth_unit": "UM",
            "force_unit": "N",
            "depth_zero": "TOUCH",
            "depth_reversed": True,
            "force_reversed": True,
        },
    ),
    "latin letters of a western code page": (
        {
            "head": ("Temps", "Déplacement", "Force"),
            "units": (("s", "mm", "N"),),
            "separator": ";",
            "comma": True,
            "encoding": "latin-1",
        },
        {"depth_zero": "TOUCH"},
    ),
}


@pytest.mark.parametrize("kind", sorted(EXPORTS))
def test_an_export_gives_the_numbers_that_were_recorded(tmp_path, kind):
    habits, answers = EXPORTS[kind]
    rows = {f"r{k}.csv": laboratory.press(k) for k in (1, 2)}
    names = [laboratory.write(tmp_path / name, each, **habits) for name, each in rows.items()]
    assert choose(tmp_path, *names) == {"FINISHED"}
    assert len(draft().columns) == bool(answers)
    answer(**answers)
    assert drafting.problem(bpy.context) == ""
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    found = read(tmp_path)
    assert all(is_as_recorded(found[name][1], each) for name, each in rows.items())


def test_a_length_of_unknown_direction_is_asked_for_and_is_a_travel_unless_it_counts_from_touch(tmp_path):
    rows = laboratory.press(1)
    laboratory.write(tmp_path / "a.csv", rows, head=("Time (s)", "Extension (mm)", "Load (N)"))
    choose(tmp_path, "a.csv")
    (head,) = draft().columns
    assert (head.asks, head.depth, head.depth_zero) == ("depth", "Extension (mm)", "ANY")
    answer()
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    listed, curve = read(tmp_path)["a.csv"]
    assert listed["columns"] == {"travel": "Extension (mm)"}
    assert is_as_recorded(curve, rows, length="travel_mm")


def test_two_lengths_are_left_for_the_user_to_tell_apart(tmp_path):
    rows = [(t, d, d + 3.0, f) for t, d, f in laboratory.press(1)]
    names = ("Time (s)", "Position (mm)", "Extension (mm)", "Load (N)")
    laboratory.write(tmp_path / "a.csv", rows, head=names, factors=(1, 1, 1, 1))
    choose(tmp_path, "a.csv")
    assert draft().columns[0].depth == ""
    assert "which column of 'a.csv' is the depth?" in drafting.problem(bpy.context)
    answer(depth="Position (mm)", depth_zero="TOUCH")
    bpy.ops.thenar.write_study()
    assert is_as_recorded(read(tmp_path)["a.csv"][1], [(t, d, f) for t, d, _, f in rows])


def test_a_unit_that_no_file_states_is_asked_for(tmp_path):
    laboratory.write(tmp_path / "a.csv", laboratory.press(1), head=("Time", "Depth", "Force"))
    choose(tmp_path, "a.csv")
    answer()
    for role, unit in (("time", "S"), ("depth", "MM"), ("force", "N")):
        assert f"'a.csv' states no unit of the {role}" in drafting.problem(bpy.context)
        setattr(draft().columns[0], f"{role}_unit", unit)
    assert drafting.problem(bpy.context) == ""


def test_presses_of_one_path_are_repeats_in_any_order_and_others_are_not(tmp_path):
    """Slow, fast, deep, and a ball of twice the size at the slow path; names say nothing, waits differ."""
    kinds = {
        "slow": {},
        "fast": {"speed_mm_s": 5.0},
        "deep": {"deepest_mm": 1.1},
        "large": {"radius_mm": 12.0},
    }
    order = ("fast", "slow", "large", "slow", "deep", "fast", "slow", "large", "deep")
    for number, kind in enumerate(order):
        rows = laboratory.press(number, wait_s=0.1 + 0.3 * (number % 3), **kinds[kind])
        shift = [(t + 7.0 * number, d, f) for t, d, f in rows]
        laboratory.write(tmp_path / f"x{number:02d}.csv", shift)
    choose(tmp_path, *(f"x{number:02d}.csv" for number in range(len(order))))
    numbers = [item.protocol for item in draft().files]
    assert {k: len({n for n, o in zip(numbers, order, strict=True) if o == k}) for k in kinds} == dict.fromkeys(
        kinds, 1
    )
    assert len(set(numbers)) == len(kinds) == len(draft().protocols)
    names = [protocol.name for protocol in draft().protocols]
    assert len(set(names)) == len(names)
    speeds = sorted(float(name.split(" mm/s")[0]) for name in names)
    assert speeds == pytest.approx([1.0, 1.0, 1.0, 5.0], rel=0.06), names


def test_the_users_own_grouping_and_tools_go_into_the_study(tmp_path):
    for number in (1, 2, 3, 4):
        laboratory.write(tmp_path / f"p{number}.csv", laboratory.press(number))
    choose(tmp_path, *(f"p{number}.csv" for number in (1, 2, 3, 4)))
    draft().files[2].protocol = draft().files[3].protocol = 2
    answer()
    draft().protocols[1].shape, draft().protocols[1].diameter_mm = "PUNCH", 5.0
    draft().files[0].protocol = 1
    assert [item.protocol for item in draft().files] == [1, 1, 2, 2]
    bpy.ops.thenar.write_study()
    written = tomllib.loads((tmp_path / "study.toml").read_text())
    tools = {each["file"]: written["indenters"][each["indenter"]] for each in written["recordings"]}
    assert tools["p1.csv"] == {"shape": "sphere", "radius_mm": 6.0}
    assert tools["p4.csv"] == {"shape": "punch", "radius_mm": 2.5}
    protocols = [each["protocol"] for each in written["recordings"]]
    assert protocols[0] == protocols[1] != protocols[2] == protocols[3]


def test_numbers_without_names_are_refused_with_file_line_and_remedy_and_nothing_changes(tmp_path):
    laboratory.write(tmp_path / "bare.csv", laboratory.press(1), head=())
    with pytest.raises(RuntimeError, match=r"'bare\.csv', line 1: no row of names.*time_s;depth_mm;force_n"):
        choose(tmp_path, "bare.csv")
    assert not draft().is_open and not len(draft().files)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "empty"),
        (b"\x89PNG\r\n\x1a\n" + bytes(64), "this is a picture"),
        (b"time_s,row,col,pressure_kpa\n0,0,0,1\n0,0,1,2\n", "holds a pressure map"),
    ],
)
def test_what_is_no_press_is_refused_by_name(tmp_path, content, words):
    (tmp_path / "odd.csv").write_bytes(content)
    with pytest.raises(RuntimeError, match="odd") as refused:
        choose(tmp_path, "odd.csv")
    assert words in str(refused.value)


def test_a_study_that_is_there_stays_without_consent(tmp_path):
    laboratory.write(tmp_path / "p.csv", laboratory.press(1))
    (tmp_path / "study.toml").write_text("mine")
    choose(tmp_path, "p.csv")
    answer()
    assert writing.in_the_way(tmp_path) == ["study.toml"]
    with pytest.raises(RuntimeError, match=r"'study\.toml' is in .* already"):
        bpy.ops.thenar.write_study()
    assert (tmp_path / "study.toml").read_text() == "mine"
    assert sorted(each.name for each in tmp_path.iterdir()) == ["p.csv", "study.toml"]
    draft().replaces = True
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    assert "mine" not in (tmp_path / "study.toml").read_text()


def test_a_study_that_the_library_refuses_leaves_the_folder_as_it_was(tmp_path):
    (tmp_path / "study.toml").write_text("mine")
    with pytest.raises(thenar.ThenarError):
        writing.write(tmp_path, {"study.toml": "[study]\n", "study_skin.ply": "ply"}, replaces=True)
    assert [(each.name, each.read_text()) for each in tmp_path.iterdir()] == [("study.toml", "mine")]


def test_awkward_names_survive_the_study(tmp_path):
    name = 'épreuve "7" #1.csv'
    laboratory.write(tmp_path / name, laboratory.press(1), head=('Weg "a"', "t (s)", "F (N)"), factors=(1, 1, 1))
    rows = laboratory.press(1)
    laboratory.write(tmp_path / name, [(d, t, f) for t, d, f in rows], head=("Weg = 'a'", "t (s)", "F (N)"))
    choose(tmp_path, name)
    draft().title = 'A "title" \\ with = [signs]'
    answer(depth_unit="MM", depth="Weg = 'a'", depth_zero="TOUCH")
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    assert thenar.Study.load(tmp_path).title == 'A "title" \\ with = [signs]'
    assert is_as_recorded(read(tmp_path)[name][1], rows)


def test_answers_survive_saving_and_reloading(tmp_path):
    laboratory.write(tmp_path / "a.csv", laboratory.press(1), head=("Time", "Depth", "Force"))
    choose(tmp_path, "a.csv")
    answer(depth_unit="MM", time_unit="S", force_unit="N")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    assert draft().is_open and draft().columns[0].depth_unit == "MM"
    assert draft().protocols[0].diameter_mm == 12.0
    assert bpy.ops.thenar.write_study() == {"FINISHED"}


def test_discarding_leaves_the_files(tmp_path):
    laboratory.write(tmp_path / "a.csv", laboratory.press(1))
    choose(tmp_path, "a.csv")
    bpy.ops.thenar.discard_study()
    assert not draft().is_open and [each.name for each in tmp_path.iterdir()] == ["a.csv"]


@pytest.mark.parametrize("shape", ["PLANE", "CYLINDER"])
def test_a_tool_without_an_end_on_flat_skin_is_refused(tmp_path, shape):
    laboratory.write(tmp_path / "a.csv", laboratory.press(1))
    choose(tmp_path, "a.csv")
    answer()
    draft().protocols[0].shape = shape
    assert "up to its edges" in drafting.problem(bpy.context)


def test_the_diagnosis_of_balls_on_gel_accuses_nothing_and_finds_its_modulus(tmp_path):
    for number in (1, 2, 3):
        laboratory.write(tmp_path / f"p{number}.csv", laboratory.press(number))
    choose(tmp_path, "p1.csv", "p2.csv", "p3.csv")
    answer()
    bpy.ops.thenar.write_study()
    found = thenar.diagnose(thenar.Study.load(tmp_path))
    assert found.verdict in {"nothing_missing", "parameters"}, found.sentence
