"""A bake follows the history of the contact: skin relaxes, sticks and drags from frame to frame at the scene's rate."""

import csv

import bpy
import numpy as np
import pytest
import stage
from thenar_blender.scene import rigid
from thenar_blender.timeline import following

FPS = 25


def turned(angle, axis=(0.3, -0.5, 0.8)):
    """Rotation (3, 3) by Rodrigues' formula."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across


def test_a_rigid_motion_is_found_and_a_change_of_shape_is_not():
    points = np.random.default_rng(3).normal(size=(40, 3)) * 20
    turn, shift = turned(2.1), np.array([300.0, -4.0, 7.0])
    whole, left = rigid.motion(points, points @ turn.T + shift)
    assert whole[:3, :3] == pytest.approx(turn, abs=1e-12) and whole[:3, 3] == pytest.approx(shift, abs=1e-10)
    assert left < 1e-10
    assert rigid.seen(rigid.moved(points, whole), whole) == pytest.approx(points, abs=1e-10)
    flat = points * [1, 1, 0]
    assert rigid.motion(flat, flat @ turn.T + shift)[0][:3, :3] == pytest.approx(turn, abs=1e-12)
    assert rigid.motion(points, points * [-1, 1, 1])[1] > 10.0, "a mirror image is no motion"
    assert rigid.motion(points, points * 1.01)[1] > 0.1


def test_what_a_cycle_loses_is_the_work_between_two_free_frames():
    force = [0, 1, 2, 1, 0, 0, 3, 0, 2]
    work = [0, 1, 4, 3, 2, 2, 9, 7, 8]
    assert following.cycles(force, work) == [(2, 4), (5, 7)]
    assert following.cycles([1, 2, 0], [0, 1, 2]) == [], "the first frame is pressed already"
    assert following.cycles([0, 2, 1], [0, 1, 2]) == [], "the last one still is"
    assert following.cycles([0, 0], [0, 0]) == following.cycles([], []) == []


def made(tmp_path, depth=1.0, **effects):
    """Ball on plate, saved, with effects {kind: numbers}."""
    hand, product = stage.scene(top=-7.5)
    stage.raise_under(hand, product, depth=depth)
    scene = bpy.context.scene
    scene.render.fps, scene.render.fps_base = FPS, 1.0
    for kind, numbers in effects.items():
        assert bpy.ops.thenar.effect_add(kind=kind) == {"FINISHED"}
        effect = hand.thenar.effects[-1]
        effect.amplitude = numbers.pop("amplitude", effect.amplitude)
        for name, value in numbers.items():
            effect.numbers[name].value = value
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "course.blend"))
    return bpy.data.objects["Pad"], bpy.data.objects["Plate"]


def keyed(obj, path, values):
    """Key `obj.path` at frames {frame: value}, in straight lines."""
    for frame, value in values.items():
        setattr(obj, path, value)
        obj.keyframe_insert(path, frame=frame)
    for layer in obj.animation_data.action.layers:
        for strip in layer.strips:
            for curve in (curve for bag in strip.channelbags for curve in bag.fcurves):
                for point in curve.keyframe_points:
                    point.interpolation = "LINEAR"


def moved(obj, **millimetres):
    """The object's location, moved by mm along x, y, z."""
    return tuple(obj.location[k] + millimetres.get(axis, 0.0) * stage.MM for k, axis in enumerate("xyz"))


def baked(tmp_path, last):
    """Bake frames 1 to `last`; the tables of its file."""
    assert bpy.ops.thenar.bake(frame_start=1, frame_end=last) == {"FINISHED"}
    (path,) = tmp_path.rglob("*.npz")
    with np.load(path) as file:
        return {name: file[name] for name in file.files}


RELAXING = {"amplitude": 0.4, "time_1_s": 0.3, "weight_1": 1.0, "weight_2": 0.0, "weight_3": 0.0}


def test_skin_relaxes_while_the_hand_holds_on(tmp_path):
    made(tmp_path, relaxation=dict(RELAXING))
    tables = baked(tmp_path, 16)
    time = np.arange(16) / FPS
    fading = 1.0 - 0.4 + 0.4 * np.exp(-time / 0.3)
    assert tables["force_n"] / tables["force_n"][0] == pytest.approx(fading, rel=1e-4)
    assert tables["peak_kpa"] / tables["peak_kpa"][0] == pytest.approx(fading, rel=1e-4)
    assert bpy.context.scene.thenar.hand.thenar.bake.follows


def test_the_frame_rate_is_the_clock(tmp_path):
    made(tmp_path, relaxation=dict(RELAXING))
    bpy.context.scene.render.fps, bpy.context.scene.render.fps_base = 30, 1.001
    force = baked(tmp_path, 4)["force_n"]
    fading = 1.0 - 0.4 + 0.4 * np.exp(-np.arange(4) * 1.001 / 30 / 0.3)
    assert force / force[0] == pytest.approx(fading, rel=1e-4)


def test_a_dragged_product_sticks_first_and_slips_at_last(tmp_path):
    hand, product = made(tmp_path, friction={"coefficient": 0.4})
    keyed(product, "location", {1: moved(product), 13: moved(product, x=3.0)})
    tables = baked(tmp_path, 13)
    shear, force = tables["shear_n"], tables["force_n"]
    assert shear[0] == 0.0 and (np.diff(shear) > -1e-6).all(), "the first frame has not been dragged yet"
    assert shear[-1] == pytest.approx(0.4 * force[-1], rel=0.01)
    assert force == pytest.approx(force[0], rel=0.01), "a plate drags without pressing more"
    margin = tables["hand/slip_margin"]
    pressed = tables["hand/pressure_kpa"] > 0
    assert margin[1][pressed[1]].max() > 0.2 and margin[-1][pressed[-1]].max() < 1e-3
    assert (margin[~pressed] == 1.0).all()
    assert tables["slip_loss_mj"][-1] > 0 and tables["work_mj"][-1] > tables["slip_loss_mj"][-1]
    bpy.context.scene.frame_set(8)
    assert stage.attribute(hand, "shear_kpa") == pytest.approx(tables["hand/shear_kpa"][7])
    assert bpy.ops.thenar.show_map(kind="SHEAR") == {"FINISHED"}
    before = stage.attribute(hand, "Thenar Map").copy()
    bpy.context.scene.frame_set(2)
    assert not np.allclose(stage.attribute(hand, "Thenar Map"), before), "playback colours the map that is shown"


def test_between_two_full_slips_all_work_is_lost_to_slip(tmp_path):
    _, product = made(tmp_path, friction={"coefficient": 0.4})
    keyed(product, "location", {1: moved(product), 11: moved(product, x=3.0), 21: moved(product)})
    tables = baked(tmp_path, 21)
    work, loss = (tables[name][20] - tables[name][10] for name in ("work_mj", "slip_loss_mj"))
    assert loss > 0.5 * tables["slip_loss_mj"][20] * 0.8, "there and back"
    assert work == pytest.approx(loss, rel=0.03), "the skin is sheared as far as before, only the other way"


def test_painted_skin_is_followed_too(tmp_path):
    hand, _ = made(tmp_path, relaxation=dict(RELAXING), bone={})
    hand.vertex_groups.new(name="some").add([0, 1, 2], 0.5, "REPLACE")
    hand.thenar.effects[1].painted = "some"
    force = baked(tmp_path, 4)["force_n"]
    assert force / force[0] == pytest.approx(1.0 - 0.4 + 0.4 * np.exp(-np.arange(4) / FPS / 0.3), rel=1e-4)


def test_a_hand_that_is_dragged_over_the_product_is_the_same(tmp_path):
    hand, product = made(tmp_path, friction={"coefficient": 0.4})
    keyed(product, "location", {1: moved(product), 5: moved(product, x=0.6)})
    expected = baked(tmp_path, 5)
    bpy.ops.thenar.clear()
    product.animation_data_clear()
    bpy.context.scene.frame_set(1)
    product.location.x = 0.0
    keyed(hand, "location", {1: moved(hand), 5: moved(hand, x=-0.6)})
    tables = baked(tmp_path, 5)
    assert tables["shear_n"] == pytest.approx(expected["shear_n"], rel=2e-3, abs=1e-5)
    assert tables["force_n"] == pytest.approx(expected["force_n"], rel=2e-3)
    assert tables["work_mj"] == pytest.approx(expected["work_mj"], rel=1e-2, abs=1e-5)


def test_hand_and_product_that_move_as_one_do_not_drag(tmp_path):
    hand, product = made(tmp_path, friction={"coefficient": 0.4}, relaxation=dict(RELAXING))
    empty = bpy.data.objects.new("Carrier", None)
    bpy.context.scene.collection.objects.link(empty)
    for obj in (hand, product):
        obj.parent = empty
    keyed(empty, "location", {1: (0, 0, 0), 5: (0.05, -0.1, 0.2)})
    keyed(empty, "rotation_euler", {1: (0, 0, 0), 5: (0.7, -0.4, 1.1)})
    tables = baked(tmp_path, 5)
    fading = 0.6 + 0.4 * np.exp(-np.arange(5) / FPS / 0.3)
    assert tables["force_n"] / tables["force_n"][0] == pytest.approx(fading, rel=2e-3)
    assert tables["shear_n"].max() < 0.02 * tables["force_n"].max()
    assert np.abs(tables["work_mj"]).max() < 0.01, "no work: neither moves against the other"


def test_a_keyed_force_is_followed(tmp_path):
    _, product = made(tmp_path, relaxation=dict(RELAXING))
    settings = bpy.context.scene.thenar
    settings.use_force = True
    for frame, force in {1: 1.0, 5: 3.0}.items():
        settings.force_n = force
        settings.keyframe_insert("force_n", frame=frame)
    tables = baked(tmp_path, 5)
    wanted = []
    for frame in range(1, 6):
        bpy.context.scene.frame_set(frame)
        wanted.append(settings.force_n)
    assert wanted[0] == 1.0 and wanted[-1] == 3.0
    assert tables["force_n"] == pytest.approx(wanted, rel=0.01)
    assert product.thenar.is_moved


def pressed_and_released(tmp_path, **effects):
    _, product = made(tmp_path, depth=-0.2, **effects)
    keyed(product, "location", {1: moved(product), 9: moved(product, z=1.2), 17: moved(product)})
    tables = baked(tmp_path, 17)
    assert tables["force_n"][0] == tables["force_n"][-1] == 0.0 < tables["force_n"][8]
    return tables, bpy.context.scene.thenar.hand.thenar.bake


def test_an_elastic_cycle_loses_nothing(tmp_path):
    tables, told = pressed_and_released(tmp_path, friction={"coefficient": 0.4})
    depth = np.interp(np.arange(17), [0, 8, 16], [-0.2, 1.0, -0.2])
    by_hand = np.sum(0.5 * (tables["force_n"][1:9] + tables["force_n"][:8]) * np.diff(depth[:9]))
    assert tables["work_mj"][8] == pytest.approx(by_hand, rel=0.02), "force along the travel"
    assert told.cycles == 1 and abs(told.cycle_loss_mj) < 0.01 * tables["work_mj"][8]


def test_relaxing_skin_loses_energy_in_a_cycle(tmp_path):
    tables, told = pressed_and_released(tmp_path, relaxation=dict(RELAXING))
    assert told.cycles == 1 and told.cycle_loss_mj == pytest.approx(tables["work_mj"][-1])
    assert told.cycle_loss_share == pytest.approx(tables["work_mj"][-1] / tables["work_mj"].max())
    assert 0.02 * tables["work_mj"].max() < told.cycle_loss_mj < 0.5 * tables["work_mj"].max()


@pytest.mark.parametrize("bonds", ["reversible", "touched"])
def test_bonds_that_touch_made_hold_on_in_later_frames(tmp_path, bonds):
    """Skin clings within 0.5 mm. Forces are those that press, also against what clings: more on the way out."""
    _, product = made(tmp_path, depth=-0.2, adhesion={"work_j_per_m2": 0.2, "range_mm": 0.5})
    hand = bpy.context.scene.thenar.hand
    hand.thenar.effects[0].choices["bonds"].value = bonds
    keyed(product, "location", {1: moved(product), 9: moved(product, z=1.2), 17: moved(product)})
    force = baked(tmp_path, 17)["force_n"]
    there, back = force[2:6], force[14:10:-1]
    if bonds == "reversible":
        assert not hand.thenar.bake.follows and there == pytest.approx(back, rel=1e-6)
    else:
        assert hand.thenar.bake.follows and (back > 1.02 * there).all()
    assert hand.thenar.bake.cycles == 0, "attraction is in no vertex's force, so what a cycle loses is not known"


def test_what_cannot_be_followed_is_told_and_leaves_nothing(tmp_path):
    hand, product = made(tmp_path, friction={"coefficient": 0.4})
    keyed(product, "scale", {1: (1, 1, 1), 3: (1, 1.1, 1)})
    bpy.context.scene.frame_set(1)
    with pytest.raises(RuntimeError, match="(?s)t frame 2, the product .'Plate'. changes.*as a whole"):
        bpy.ops.thenar.bake(frame_start=1, frame_end=3)
    assert not hand.modifiers and not hand.thenar.bake_path and bpy.context.scene.frame_current == 1
    assert not [path for path in tmp_path.rglob("*") if path.suffix in (".pc2", ".npz", ".partial")]
    product.animation_data_clear()
    hand.thenar.effects[0].keyframe_insert("amplitude", frame=1)
    hand.thenar.effects[0].amplitude = 0.5
    hand.thenar.effects[0].keyframe_insert("amplitude", frame=3)
    with pytest.raises(RuntimeError, match="(?s)t frame 2, the skin of 'Pad' changes.*remove those keys"):
        bpy.ops.thenar.bake(frame_start=1, frame_end=3)


def test_a_bake_that_remembers_is_kept_in_the_file(tmp_path):
    _, product = made(tmp_path, friction={"coefficient": 0.4})
    keyed(product, "location", {1: moved(product), 3: moved(product, x=1.0)})
    tables = baked(tmp_path, 3)
    path = str(tmp_path / "course.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    hand = bpy.data.objects["Pad"]
    told = hand.thenar.bake
    assert (told.frame_start, told.frame_end, told.follows) == (1, 3, True)
    assert told.slip_loss_mj == pytest.approx(tables["slip_loss_mj"][-1])
    assert bpy.ops.thenar.export_bake(filepath=str(tmp_path / "frames.csv")) == {"FINISHED"}
    rows = list(csv.DictReader((tmp_path / "frames.csv").open()))
    assert [row["frame"] for row in rows] == ["1", "2", "3"]
    assert [float(row["time_s"]) for row in rows] == pytest.approx([0.0, 1 / FPS, 2 / FPS])
    assert [float(row["shear_n"]) for row in rows] == pytest.approx(tables["shear_n"])
    for frame in (3, 1, 2):
        bpy.context.scene.frame_set(frame)
        assert stage.attribute(hand, "shear_kpa") == pytest.approx(tables["hand/shear_kpa"][frame - 1])
    bpy.ops.thenar.clear()
    assert "shear_kpa" not in hand.data.attributes and not hand.thenar.bake_path
    with pytest.raises(RuntimeError, match="press Bake Frames first"):
        bpy.ops.thenar.export_bake(filepath=str(tmp_path / "none.csv"))
