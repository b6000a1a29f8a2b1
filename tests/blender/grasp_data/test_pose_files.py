"""Files of data sets: keys, widths, sides, PCA, means; what cannot be read is refused by name."""

import json
import pickle

import bpy
import model_files
import numpy as np
import pytest
from thenar_blender.grasp_data import containers, parameters
from thenar_blender.scene.checks import Refusal

RIGHT = parameters.Wish("right")
LEFT = parameters.Wish("left")
POSE = model_files.grips(5)


def found(values, wish=RIGHT):
    """Turns (f, 45) of the wanted side."""
    return parameters.find(values, wish, "data.npz").turns.reshape(-1, 45)


@pytest.mark.parametrize(
    "values",
    [
        {"hand_pose": POSE},
        {"hand_pose": POSE.reshape(5, 15, 3)},
        {"pose": np.hstack([np.ones((5, 3)), POSE])},
        {"mano_pose": np.hstack([np.ones((5, 3)), POSE, np.ones((5, 3))])},
        {"right_hand_pose": POSE, "left_hand_pose": -POSE},
        {"pose_hand": np.hstack([-POSE, POSE])},
        {"poses": np.hstack([np.zeros((5, 66)), -POSE, POSE])},
        {"poses": np.hstack([np.zeros((5, 75)), -POSE, POSE])},
        {"rhand": {"params": {"fullpose": POSE, "hand_pose": np.zeros((5, 24))}}, "lhand": {"params": {}}},
        {"right": {"pose": POSE.tolist()}, "left": None},
        {"0": {str(f): {"right": {"pose": POSE[f].tolist()}, "left": None} for f in range(5)}},
        [{"hand_pose": row.tolist()} for row in POSE],
    ],
    ids=["mano", "joints", "48", "51", "smplx", "amass_hands", "smplh", "body", "grab", "arctic", "interhand", "list"],
)
def test_layouts_of_data_sets(values):
    assert np.allclose(found(values), POSE)


def test_left_numbers_are_those_of_the_left():
    both = {"poses": np.hstack([np.zeros((5, 75)), -POSE, POSE])}
    assert np.allclose(found(both, LEFT), -POSE)


def test_rotation_matrices():
    from mathutils import Quaternion, Vector

    matrices = np.array(
        [[Quaternion(Vector(v).normalized(), Vector(v).length).to_matrix() for v in row.reshape(15, 3)] for row in POSE]
    )
    assert np.allclose(found({"hand_pose": matrices}), POSE, atol=1e-5)
    with pytest.raises(Refusal, match="no rotation"):
        found({"hand_pose": matrices * 1.1})


def test_coefficients_are_read_by_the_components_that_the_file_brings():
    random = np.random.default_rng(1)
    components, mean = random.normal(0, 0.1, (45, 45)), random.normal(0, 0.1, 45)
    few = random.normal(0, 0.5, (4, 12))
    model = {"hands_components": components, "hands_mean": mean}
    expected = sum(few[:, k : k + 1] * components[k] for k in range(12))
    assert np.allclose(found({"right_hand_pose": few, **model}), expected + mean)
    assert np.allclose(found({"right_hand_pose": few, **model, "flat_hand_mean": np.array(True)}), expected)
    assert np.allclose(found({"right_hand_pose": few, **model}, parameters.Wish("right", adds_mean=False)), expected)
    assert np.allclose(found({"right_hand_pose": POSE, "hands_mean": mean}), POSE + mean)
    assert np.allclose(found({"fullpose": POSE, "hands_mean": mean}), POSE), "a full pose holds the mean already"
    with pytest.raises(Refusal, match="12 PCA coefficients.*no hands_components"):
        found({"right_hand_pose": few})
    with pytest.raises(Refusal, match="hands_components.*45 by 45"):
        found({"right_hand_pose": few, "hands_components": components[:6]})


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"betas": np.zeros(10)}, "no pose of a hand"),
        ({"left_hand_pose": POSE}, "no right hand, only: left"),
        ({"hand_pose": POSE * 57.3}, r"joint \d+ of 'hand_pose' in frame 0 is no angle in radians"),
        ({"hand_pose": np.where(np.arange(45) == 7, np.nan, POSE)}, "joint 3 of 'hand_pose' in frame 0"),
        ({"hand_pose": [[0.1] * 45, [0.1] * 44]}, "not of one length"),
        ({"0": {"0": {"pose": [0.1] * 45}, "1": {"pose": [0.1] * 45}}, "1": {"0": {"pose": [0] * 45}}}, "several sequ"),
    ],
)
def test_what_cannot_be_read_is_refused_with_its_place(values, sentence):
    with pytest.raises(Refusal, match=sentence):
        found(values)


def test_files_of_every_kind_pose_alike(tmp_path):
    model_files.make("right")
    rig = bpy.context.scene.thenar.hand.parent
    pose = POSE[0]
    np.savez(tmp_path / "a.npz", right_hand_pose=pose)
    np.savez(tmp_path / "b.npz", rhand=np.array({"params": {"fullpose": pose}}, dtype=object))
    np.save(tmp_path / "c.npy", np.array({"right": {"pose": pose[None]}}, dtype=object))
    np.save(tmp_path / "d.npy", pose)
    (tmp_path / "e.json").write_text(json.dumps({"right_hand_pose": pose.tolist()}))
    (tmp_path / "f.pkl").write_bytes(pickle.dumps({"right_hand_pose": pose, "gender": "female"}))
    seen = []
    for file in sorted(tmp_path.iterdir()):
        bpy.ops.thenar.load_hand_pose(filepath=str(file))
        seen.append([tuple(bone.rotation_euler) for bone in rig.pose.bones])
    assert len(seen) == 6 and np.allclose(seen, seen[0], atol=1e-6) and np.abs(seen[0]).max() > 0.5


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("a.txt", b"", "no file of pose parameters"),
        ("a.npz", b"PK\x03\x04 cut", "no complete .npz file"),
        ("a.npy", b"\x93NUMPY\x01\x00", "no complete array"),
        ("a.json", b'{"hand_pose": [1,\n2', "line 2, column"),
        ("a.json", b"\xff\xfe", "no JSON text"),
        ("a.pkl", b"\x80\x04", "no pickle of arrays"),
    ],
)
def test_broken_files_are_refused(tmp_path, name, content, sentence):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(Refusal, match=sentence):
        containers.read(tmp_path / name)
    with pytest.raises(Refusal, match="there is no file"):
        containers.read(tmp_path / "none.npz")
