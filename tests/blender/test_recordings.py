"""Recordings in a scene: a mat laid on the product, compared with the contact by sensel, shown on both."""

import json

import bpy
import numpy as np
import pytest
import small_studies
import stage
from thenar_blender import colormap

SIDE, PITCH = 9, 1.5
DULL = (5, 3)
"""Row and column of the planted sensel, which reads 10 % of what presses on it."""


def write_asf(path, frames, units="KPa"):
    """A Tekscan export of frames (k, rows, columns)."""
    _, rows, columns = np.shape(frames)
    head = (
        f"DATA_TYPE MOVIE\nVERSION Tekscan Pressure Measurement System 6.33\nSENSOR_TYPE TEST\n"
        f"ROWS {rows}\nCOLS {columns}\n"
        f"ROW_SPACING {PITCH} mm\nCOL_SPACING {PITCH} mm\nSENSEL_AREA {PITCH**2} mm2\nNOISE_THRESHOLD 0\n"
        f"SECONDS_PER_FRAME 0.1\nSTART_FRAME 1\nEND_FRAME {len(frames)}\nUNITS {units}\n"
        "MIRROR_ROW 0\nMIRROR_COL 0\nASCII_DATA @@\n"
    )
    body = "".join(
        f"\nFrame {number}\n" + "".join(",".join(f"{cell:.3f}" for cell in row) + "\n" for row in frame)
        for number, frame in enumerate(frames, 1)
    )
    path.write_text(head + body)
    return str(path)


def read_by_hand(hand):
    """What a flat mat in the middle below the ball reads, kPa: force by cell, sorted in by position alone."""
    force, places = stage.attribute(hand, "contact_force_n"), stage.evaluated(hand)
    cells = np.floor(places[:, :2] / PITCH + SIDE / 2).astype(int)
    frame = np.zeros((SIDE, SIDE))
    inside = ((cells >= 0) & (cells < SIDE)).all(axis=1) & (force > 0)
    np.add.at(frame, (cells[inside, 1], cells[inside, 0]), force[inside])
    return frame / PITCH**2 * 1e3


def measure(name):
    rows = bpy.context.scene.thenar_recordings.comparison.measures
    return next((row.measured, row.simulated) for row in rows if row.name == name and row.group == "frame compared")


@pytest.fixture
def compared(tmp_path):
    """Ball on plate, a mat that reads the contact but for the dull sensel, laid on the plate and compared."""
    hand, product = stage.pad(fineness=5), stage.plate(top=-6.3)
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = hand, product
    bpy.context.view_layer.update()
    stage.solve()
    frame = read_by_hand(hand)
    frame[DULL] *= 0.1
    path = write_asf(tmp_path / "mat.asf", [0.5 * frame, frame, 1.5 * frame])
    assert bpy.ops.thenar.load_recording(filepath=path) == {"FINISHED"}
    placing = bpy.context.scene.thenar_recordings.items[0].placing
    placing.on, placing.axis = "PLANE", "+Z"
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    return hand, product


def test_the_dull_sensel_is_the_worst_place(compared):
    state = bpy.context.scene.thenar_recordings
    assert state.items[0].frames == 3
    worst = state.comparison.worst[0]
    assert worst.name == f"row {DULL[0]}, column {DULL[1]}"
    assert worst.residual.startswith("-") and worst.residual.endswith("kPa")
    measured, simulated = map(float, measure("Force"))
    assert measured < simulated == pytest.approx(bpy.context.scene.thenar.result.force_n, rel=0.03)
    overlap = float(measure("Overlap")[1].rstrip("%"))
    assert overlap > 75
    assert "without repeats" in state.comparison.sentence
    assert any("Nothing was fitted" in note.name for note in state.comparison.notes)


def test_residuals_lie_on_hand_and_product_below_the_mat(compared):
    hand, product = compared
    middle = (np.array(DULL[::-1]) + 0.5 - SIDE / 2) * PITCH
    for obj in compared:
        residual, on_mat = stage.attribute(obj, "residual_kpa"), stage.attribute(obj, "on_mat")
        assert set(np.unique(on_mat)) == {0.0, 1.0}
        assert (residual[on_mat == 0] == 0).all()
        lowest = stage.evaluated(obj)[residual.argmin()]
        assert np.linalg.norm(lowest[:2] - middle) < 1.5 * PITCH
    half = SIDE * PITCH / 2
    places = stage.evaluated(product)
    far = np.abs(places[:, :2]).max(axis=1) > half + PITCH
    below = places[:, 2] < -9.9
    assert not stage.attribute(product, "on_mat")[far | below].any()
    assert bpy.context.scene.thenar.maps.shown == "RESIDUAL"


def test_a_place_selects_its_vertices(compared):
    hand, _ = compared
    assert bpy.ops.thenar.select_place(index=0) == {"FINISHED"}
    assert bpy.context.object == hand and hand.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    chosen = [vertex.index for vertex in hand.data.vertices if vertex.select]
    middle = (np.array(DULL[::-1]) + 0.5 - SIDE / 2) * PITCH
    assert chosen
    assert np.abs(stage.evaluated(hand)[chosen][:, :2] - middle).max() < 1.5 * PITCH
    with pytest.raises(RuntimeError, match="[Tt]here is no place 99"):
        bpy.ops.thenar.select_place(index=99)


def test_reports_are_written_whole(compared, tmp_path):
    page, numbers = tmp_path / "report.html", tmp_path / "comparison.json"
    assert bpy.ops.thenar.report(filepath=str(page)) == {"FINISHED"}
    assert bpy.ops.thenar.report(filepath=str(numbers)) == {"FINISHED"}
    assert page.read_text().startswith("<!DOCTYPE html>")
    told = json.loads(numbers.read_text())
    assert told["sentence"] == bpy.context.scene.thenar_recordings.comparison.sentence
    with pytest.raises(RuntimeError, match="cannot be written"):
        bpy.ops.thenar.report(filepath=str(tmp_path / "none" / "report.html"))
    with pytest.raises(RuntimeError, match="unknown extension"):
        bpy.ops.thenar.report(filepath=str(tmp_path / "report.doc"))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["comparison.json", "mat.asf", "report.html"]


def test_the_file_keeps_recordings_and_comparison(compared, tmp_path):
    before = bpy.context.scene.thenar_recordings.comparison.sentence
    path = str(tmp_path / "kept.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    state = bpy.context.scene.thenar_recordings
    assert state.comparison.sentence == before and len(state.comparison.worst) > 0
    assert state.items[0].placing.axis == "+Z"
    assert "residual_kpa" in bpy.context.scene.thenar.hand.data.attributes
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    assert state.comparison.sentence == before


def test_solving_anew_takes_the_residual_away(compared):
    hand, product = compared
    stage.solve()
    assert "residual_kpa" not in hand.data.attributes and "residual_kpa" not in product.data.attributes
    assert bpy.context.scene.thenar.maps.shown == "PRESSURE"


def test_raw_counts_are_compared_by_shape(tmp_path):
    hand, _ = stage.scene()
    stage.solve()
    path = write_asf(tmp_path / "raw.asf", [np.round(read_by_hand(hand) * 3)], units="Raw")
    bpy.ops.thenar.load_recording(filepath=path)
    placing = bpy.context.scene.thenar_recordings.items[0].placing
    placing.on, placing.axis = "PLANE", "+Z"
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    comparison = bpy.context.scene.thenar_recordings.comparison
    assert "not calibrated" in comparison.sentence
    assert not any("kPa" in row.unit for row in comparison.measures)
    assert "residual_kpa" not in hand.data.attributes


def test_a_comparison_without_a_map_does_not_leave_the_last_one_shown(compared, tmp_path):
    hand, _ = compared
    assert bpy.context.scene.thenar.maps.shown == "RESIDUAL"
    path = write_asf(tmp_path / "raw.asf", [np.round(read_by_hand(hand) * 3)], units="Raw")
    bpy.ops.thenar.load_recording(filepath=path)
    placing = bpy.context.scene.thenar_recordings.items[-1].placing
    placing.on, placing.axis = "PLANE", "+Z"
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    assert "residual_kpa" not in hand.data.attributes
    assert bpy.context.scene.thenar.maps.shown == "PRESSURE" and hand.thenar.shows_pressure


def test_a_mat_wraps_around_a_turned_cylinder(tmp_path):
    stage.scene()
    bpy.ops.mesh.primitive_cylinder_add(radius=0.012, depth=0.08, vertices=96, location=(0.01, 0.02, -0.017))
    bar = bpy.context.object
    bar.rotation_euler = (0.0, 1.2, 0.4)
    settings = bpy.context.scene.thenar
    settings.product = bar
    bpy.context.view_layer.update()
    bpy.ops.thenar.load_recording(filepath=write_asf(tmp_path / "mat.asf", np.ones((1, 6, 20))))
    placing = bpy.context.scene.thenar_recordings.items[0].placing
    assert placing.diameter_mm == pytest.approx(24, rel=1e-3)
    placing.shift_mm = (4.0, 0.0)
    assert bpy.ops.thenar.outline_mat() == {"FINISHED"}
    mat = bpy.data.objects["Thenar Mat"]
    assert len(mat.data.polygons) == 120
    inverse = np.linalg.inv(np.array(bar.matrix_world))
    corners = stage.evaluated(mat) * 1e-3 @ inverse[:3, :3].T + inverse[:3, 3]
    centers = corners.reshape(-1, 4, 3).mean(axis=1) * 1e3
    assert np.allclose(np.linalg.norm(centers[:, :2], axis=1), 12, atol=1e-3)
    assert np.isclose(0.5 * (centers[:, 2].min() + centers[:, 2].max()), 4, atol=1e-3)
    assert np.isclose(np.ptp(centers[:, 2]), 5 * PITCH, atol=1e-3)
    assert bpy.ops.thenar.outline_mat() == {"FINISHED"}
    assert len([obj for obj in bpy.data.objects if obj.name.startswith("Thenar Mat")]) == 1


def test_a_study_is_compared_with_its_own_skin(tmp_path):
    stage.scene()
    bpy.ops.thenar.load_recording(filepath=str(small_studies.write(tmp_path, small_studies.flat_skin())))
    state = bpy.context.scene.thenar_recordings
    assert (state.items[0].name, state.items[0].kind) == ("Ball", "STUDY")
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    rows, largest = {row.name: row for row in state.comparison.measures}, small_studies.hertz_n(0.8)
    assert float(rows["Largest force"].measured) == pytest.approx(largest, rel=0.01)
    assert float(rows["Force rms"].simulated) < 0.05 * largest
    with pytest.raises(RuntimeError, match="another skin than 'Pad'"):
        bpy.ops.thenar.select_place(index=0)


@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), (4.0, -7.0, 3.0)])
def test_a_study_of_the_hand_is_shown_on_it(tmp_path, shift):
    hand, _ = stage.scene()
    hand.data.calc_loop_triangles()
    triangles = np.array([list(each.vertices) for each in hand.data.loop_triangles])
    local = np.array([vertex.co for vertex in hand.data.vertices]) * 1e3
    lowest = local[local[:, 2].argmin()]
    dull = np.array((4, 2))
    path = small_studies.write_mat(tmp_path, (local + shift, triangles), lowest + shift, tuple(dull))
    bpy.ops.thenar.load_recording(filepath=str(path))
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    comparison = bpy.context.scene.thenar_recordings.comparison
    assert any("residual of 'mat'" in note.name for note in comparison.notes)
    residual, on_mat = stage.attribute(hand, "residual_kpa"), stage.attribute(hand, "on_mat")
    place = lowest[:2] + (dull[::-1] - 3) * 1.5
    assert set(np.unique(on_mat)) == {0.0, 1.0} and (residual[on_mat == 0] == 0).all()
    assert np.linalg.norm(local[residual.argmin()][:2] - place) < 1.5, "the dull sensel reads least against the model"
    assert comparison.worst[0].name == "row 4, column 2"
    assert bpy.ops.thenar.select_place(index=0) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    chosen = [vertex.index for vertex in hand.data.vertices if vertex.select]
    assert chosen and np.linalg.norm(local[chosen][:, :2] - place, axis=1).max() < 1.5


def test_what_cannot_be_done_says_why(tmp_path):
    with pytest.raises(RuntimeError, match="[Nn]o recording is loaded"):
        bpy.ops.thenar.compare()
    with pytest.raises(RuntimeError, match="none.asf"):
        bpy.ops.thenar.load_recording(filepath=str(tmp_path / "none.asf"))
    curve = tmp_path / "curve.csv"
    curve.write_text("time_s,depth_mm,force_n\n0.1,0.1,0.1\n0.2,0.2,0.3\n0.3,0.3,0.5\n")
    with pytest.raises(RuntimeError, match="press New Study from Files"):
        bpy.ops.thenar.load_recording(filepath=str(curve))
    assert len(bpy.context.scene.thenar_recordings.items) == 0
    bpy.ops.thenar.load_recording(filepath=write_asf(tmp_path / "mat.asf", np.ones((2, 3, 3))))
    with pytest.raises(RuntimeError, match="[Cc]hoose the hand"):
        bpy.ops.thenar.compare()
    stage.scene()
    item = bpy.context.scene.thenar_recordings.items[0]
    item.frame_rule, item.frame = "NUMBER", 3
    with pytest.raises(RuntimeError, match="no frame 3"):
        bpy.ops.thenar.compare()
    assert "residual_kpa" not in bpy.context.scene.thenar.hand.data.attributes
    item.frame_rule, item.placing.on, item.placing.diameter_mm = "MEAN", "CYLINDER", 1.0
    with pytest.raises(RuntimeError, match="overlaps itself"):
        bpy.ops.thenar.compare()
    assert bpy.ops.thenar.remove_recording() == {"FINISHED"}
    assert len(bpy.context.scene.thenar_recordings.items) == 0


@pytest.mark.parametrize(
    ("turn", "mirrored", "along_columns", "along_rows"),
    [(0.0, False, (1, 0), (0, 1)), (90.0, False, (0, 1), (-1, 0)), (0.0, True, (-1, 0), (0, 1))],
)
def test_a_flat_mat_turns_and_mirrors(tmp_path, turn, mirrored, along_columns, along_rows):
    stage.scene()
    bpy.ops.thenar.load_recording(filepath=write_asf(tmp_path / "mat.asf", np.ones((1, 3, 5))))
    placing = bpy.context.scene.thenar_recordings.items[0].placing
    placing.on, placing.axis, placing.turn_deg, placing.is_mirrored = "PLANE", "+Z", turn, mirrored
    assert bpy.ops.thenar.outline_mat() == {"FINISHED"}
    mat = bpy.data.objects["Thenar Mat"]
    corners = stage.evaluated(mat)[:, :2].reshape(3, 5, 4, 2)
    centers = corners.mean(axis=2)
    assert np.allclose(centers[0, 1] - centers[0, 0], PITCH * np.array(along_columns), atol=1e-3)
    assert np.allclose(centers[1, 0] - centers[0, 0], PITCH * np.array(along_rows), atol=1e-3)
    assert np.allclose(np.ptp(corners, axis=2), 0.9 * PITCH, atol=1e-3), "sensels are drawn a tenth smaller"


def test_the_rule_chooses_the_frame(compared):
    item = bpy.context.scene.thenar_recordings.items[0]
    forces = {}
    for rule, number in (("MEAN", 1), ("LARGEST", 1), ("NUMBER", 1)):
        item.frame_rule, item.frame = rule, number
        assert bpy.ops.thenar.compare() == {"FINISHED"}
        forces[rule] = float(measure("Force")[0])
    assert forces["LARGEST"] == pytest.approx(1.5 * forces["MEAN"], rel=1e-3)
    assert forces["NUMBER"] == pytest.approx(0.5 * forces["MEAN"], rel=1e-3)


def test_a_product_that_moves_to_its_force_takes_the_mat_along(compared):
    """The mat lies on the product as it stands; the skin is seen from there however far the product moved."""
    settings = bpy.context.scene.thenar
    plate = settings.product
    plate.location.z += 3.0 * stage.MM
    settings.use_force, settings.force_n = True, settings.result.force_n
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    assert abs(settings.result.offset_mm) == pytest.approx(3.0, abs=0.3), "the product goes back to where it was"
    _, simulated = map(float, measure("Force"))
    assert simulated == pytest.approx(settings.result.force_n, rel=0.03)
    assert bpy.context.scene.thenar_recordings.comparison.worst[0].name == f"row {DULL[0]}, column {DULL[1]}"


def test_the_residual_is_white_where_there_is_none_and_red_above(compared):
    hand, _ = compared
    high = bpy.context.scene.thenar.maps.residual_kpa
    residual, on_mat = stage.attribute(hand, "residual_kpa"), stage.attribute(hand, "on_mat")
    shown = stage.attribute(hand, "Thenar Map")[:, :3]
    below = on_mat == 1.0
    wanted = colormap.to_linear(colormap.srgb("COOLWARM", 0.5 + 0.5 * residual[below] / high))
    assert np.abs(shown[below] - wanted).max() < 2e-3
    assert residual.min() < -0.5 * high, "the dull sensel stands out"


def test_what_clips_counts_as_the_ceiling_on_both_sides(compared, tmp_path):
    """A mat whose range ends below the peak does not differ there by what it cannot show."""
    hand, _ = compared
    frame = read_by_hand(hand)
    ceiling = 0.5 * frame.max()
    path = write_asf(tmp_path / "low.asf", [np.minimum(frame, ceiling)])
    text = (tmp_path / "low.asf").read_text().replace("UNITS", f"SATURATION_PRESSURE {ceiling:.3f} KPa\nUNITS")
    (tmp_path / "low.asf").write_text(text)
    bpy.ops.thenar.load_recording(filepath=path)
    placing = bpy.context.scene.thenar_recordings.items[1].placing
    placing.on, placing.axis = "PLANE", "+Z"
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    residual = stage.attribute(hand, "residual_kpa")
    assert np.abs(residual).max() < 0.3 * ceiling
