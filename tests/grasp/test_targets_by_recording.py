"""A recording as target: made from a posture that is known, by a reading that shares nothing with the library's mat.

The cells get 5 % of noise and steps of 2 kPa; the hand is then opened by angles of a generator.
"""

import numpy as np
import pytest
from grasp import mat_readings
from handles import shapes
from mathutils import Vector
from thenar_blender.grasp_targets import explained, operators
from thenar_blender.grasp_targets.recording import Explained, Match, Recorded
from thenar_blender.hand import skinning
from thenar_blender.hand_bones import reading
from thenar_blender.hand_bones.roles import COLUMNS

RADIUS_MM = 24.0
NOISE, STEP_KPA = 0.05, 2.0
NEAR, NEAR_SHARE = 0.1, 0.015
"""Share of a finger's force, and of the sum, within which a force counts as brought back."""


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    return tmp_path_factory.mktemp("held") / "bar.blend"


@pytest.fixture
def held(blender, scene, kept):
    """A hand that holds the middle of a bar of 48 mm; searched once."""
    if not kept.exists():
        across, along = np.array([0.0, RADIUS_MM, RADIUS_MM, 0.0]), np.array([-140.0, -140.0, 140.0, 140.0])
        scene(shapes.revolved(across, along, 48))
        assert blender.ops.thenar.fit_grasp() == {"FINISHED"}
        blender.ops.wm.save_as_mainfile(filepath=str(kept))
    blender.ops.wm.open_mainfile(filepath=str(kept))
    blender.context.scene.thenar_targets.kind = "RECORDING"
    return blender


def forces(blender):
    blender.ops.thenar.solve()
    out = {row.name: row.force_n for row in blender.context.scene.thenar.result.fingers}
    blender.ops.thenar.clear()
    return out


def basis(blender, shifted=False):
    """Poses of all bones; the first joint of the index finger is first shifted by 0.1 mm if asked for."""
    armature = reading.armature_of(blender.context.scene.thenar.hand)
    if shifted:
        fit = operators.prepared(blender.context, 40.0)
        armature.pose.bones[fit.hand.rig.names[fit.hand.joints.bones["index_proximal"]]].location.x += 1e-4
        blender.context.view_layer.update()
    return [bone.matrix_basis.copy() for bone in armature.pose.bones]


def placed(blender):
    """Places of armature, hand and product."""
    chosen = blender.context.scene.thenar
    return [obj.matrix_world.copy() for obj in (reading.armature_of(chosen.hand), chosen.hand, chosen.product)]


def recorded(blender, path, rng, gain=1.0):
    """Load what a mat with noise, steps and a gain reads of the hand as it is. Returns its forces by finger."""
    blender.ops.thenar.solve()
    frame, pitch = mat_readings.read(blender.context.scene.thenar.hand, RADIUS_MM)
    noisy = np.maximum(frame * (1.0 + NOISE * rng.normal(size=frame.shape)), 0.0)
    file = mat_readings.written(path, gain * STEP_KPA * np.round(noisy / STEP_KPA), pitch)
    known = forces(blender)
    assert blender.ops.thenar.load_recording(filepath=file) == {"FINISHED"}
    placing = blender.context.scene.thenar_recordings.items[0].placing
    placing.on, placing.axis, placing.diameter_mm = "CYLINDER", "+Z", 2.0 * RADIUS_MM
    return known


def opened(blender, rng, degrees):
    """Angles (b, 3) after the fingers' joints were bent back by up to `degrees`."""
    fit = operators.prepared(blender.context, 40.0)
    angles = fit.wish.angles.copy()
    for role, bone in fit.hand.joints.bones.items():
        if role.endswith(("proximal", "middle")):
            angles[bone, COLUMNS["flexion"]] -= np.radians(rng.uniform(0.3, 1.0) * degrees)
    armature = reading.armature_of(blender.context.scene.thenar.hand)
    reading.write_angles(armature, fit.hand.rig, fit.hand.joints, angles)
    blender.context.view_layer.update()
    return angles


def test_the_forces_of_the_recorded_posture_come_back(held, tmp_path):
    rng = np.random.default_rng(0)
    known = recorded(held, tmp_path / "mat.asf", rng)
    begun = opened(held, rng, 8.0)
    assert sum(forces(held).values()) < 0.7 * sum(known.values())
    assert held.ops.thenar.reach_target() == {"FINISHED"}
    after = forces(held)
    for finger, force in known.items():
        assert after[finger] == pytest.approx(force, rel=NEAR, abs=NEAR_SHARE * sum(known.values())), finger
    said = held.context.scene.thenar_targets.explained
    assert said.startswith("Explained by posture") and "does not tell posture from tissue" in said
    ended = operators.prepared(held.context, 40.0).wish.angles
    assert np.degrees(np.abs(ended - begun).max()) <= 20.0 + 1e-6


def test_a_gain_of_the_mat_bends_no_finger_far_and_is_said(held, tmp_path):
    """1.3 times the pressure of the hand as it is."""
    gain = 1.3
    known = recorded(held, tmp_path / "mat.asf", np.random.default_rng(1), gain)
    begun = operators.prepared(held.context, 40.0).wish.angles
    assert held.ops.thenar.reach_target() == {"FINISHED"}
    ended = operators.prepared(held.context, 40.0).wish.angles
    assert np.degrees(np.abs(ended - begun).max()) < 10.0
    assert sum(forces(held).values()) < 1.1 * gain * sum(known.values())
    said = held.context.scene.thenar_targets.explained
    assert not said.startswith("Explained by posture")
    found = float(said.partition("A gain of ")[2].partition(" ")[0])
    assert found == pytest.approx(gain, abs=0.05)
    assert "kPa rms by cell" in said, "what is left over"


def test_a_posture_that_explains_its_recording_is_left_alone(held, tmp_path):
    """Bones are not even written: a bone's own shift, which a written pose has not, stays."""
    recorded(held, tmp_path / "mat.asf", np.random.default_rng(2))
    poses = basis(held, shifted=True)
    assert held.ops.thenar.reach_target() == {"FINISHED"}
    assert basis(held) == poses
    assert "as it is, within the noise assumed" in held.context.scene.thenar_targets.explained


def test_where_no_posture_explains_the_recording_the_hand_stays(held, tmp_path):
    """Every second row of 5 mm reads nothing and the others twice as much: skin cannot press so."""
    rows = np.tile([0.0, 2.0], mat_readings.ROWS)[: mat_readings.ROWS]
    recorded(held, tmp_path / "mat.asf", np.random.default_rng(4), gain=rows[:, None])
    poses, places = basis(held), placed(held)
    assert held.ops.thenar.reach_target() == {"FINISHED"}
    said = held.context.scene.thenar_targets.explained
    assert said.startswith("No posture near this one") and "moved" not in said
    assert basis(held) == poses and placed(held) == places


def test_a_hand_moves_no_farther_than_the_guide_says(held, tmp_path):
    """Put 12 mm along the bar and 12 mm off its axis: the way back is longer than the 10 mm that are searched."""
    recorded(held, tmp_path / "mat.asf", np.random.default_rng(5))
    armature = reading.armature_of(held.context.scene.thenar.hand)
    armature.location += Vector((0.0, 0.009, 0.012))
    held.context.view_layer.update()
    fit = operators.prepared(held.context, 40.0)
    before = placed(held)[0]
    rows = np.concatenate([pad.rows for pad in fit.hand.pads])
    middle = skinning.skin(fit.hand.rig, skinning.pose_matrices(fit.hand.rig, fit.wish.angles))[rows].mean(axis=0) / 1e3
    assert held.ops.thenar.reach_target() == {"FINISHED"}
    moved = 1e3 * (placed(held)[0] @ before.inverted() @ Vector(middle) - Vector(middle)).length
    said = held.context.scene.thenar_targets.explained
    assert 9.0 < moved < 10.05
    assert f"moved {moved:.1f} mm" in said and "stopped at its bounds of 20 degrees and 10 mm" in said
    assert not said.startswith("Explained by posture")


NOTHING = Match(10.0, 0.0, np.nan, 10.0)


@pytest.mark.parametrize(
    ("before", "is_gain_named"),
    [(NOTHING, False), (Match(10.0, 50.0, 2.0, 9.5), False), (Match(10.0, 50.0, 2.0, 5.0), True)],
)
def test_a_gain_is_named_only_where_it_explains_something(blender, before, is_gain_named):
    """A gain that leaves 95 % of the difference explains nothing, nor does one of a hand that cannot be pressed."""
    one = {"area_mm2": np.array([25.0]), "center_mm": np.zeros((1, 3))}
    found = Explained(None, before, before, Recorded(one, np.array([100.0]), {}))
    said = " ".join(explained.lines(found))
    assert ("A gain of 2.00" in said) == is_gain_named and "nan" not in said


def test_a_recording_far_from_the_hand_is_refused(held, tmp_path):
    recorded(held, tmp_path / "mat.asf", np.random.default_rng(3))
    armature = reading.armature_of(held.context.scene.thenar.hand)
    armature.location.y += 0.3
    held.context.view_layer.update()
    with pytest.raises(RuntimeError, match="more than 30 mm from the hand"):
        held.ops.thenar.reach_target()


def test_without_a_recording_of_a_mat_nothing_is_searched(held, tmp_path):
    with pytest.raises(RuntimeError, match="[Nn]o recording is loaded"):
        held.ops.thenar.reach_target()
    recorded(held, tmp_path / "mat.asf", np.random.default_rng(3))
    item = held.context.scene.thenar_recordings.items[0]
    item.placing.shift_mm[0] = 5000.0
    with pytest.raises(RuntimeError, match="off the product"):
        held.ops.thenar.reach_target()
    item.kind = "STUDY"
    with pytest.raises(RuntimeError, match="no recording of a mat"):
        held.ops.thenar.reach_target()
