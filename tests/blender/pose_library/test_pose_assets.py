"""The asset library holds every pose for both hands, with its picture, and Blender's own posing of them agrees."""

import bpy
import numpy as np
import pytest
from thenar_blender.hand.poses import LABELS, POSES
from thenar_blender.pose_library import actions, library


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    """A data folder of the test's own; what was entered in the preferences is taken out again."""
    monkeypatch.setattr(library, "folder", lambda: tmp_path / "poses")
    yield tmp_path / "poses"
    entry = library.registered(bpy.context)
    if entry is not None:
        bpy.context.preferences.filepaths.asset_libraries.remove(entry)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The library's file, written once."""
    home = tmp_path_factory.mktemp("once")
    import thenar_blender

    thenar_blender.register()
    library._write_poses(home / library.BLEND, [])
    thenar_blender.unregister()
    return home / library.BLEND


def assets(path):
    """Name -> action of the library, loaded as the Asset Browser does."""
    with bpy.data.libraries.load(str(path), assets_only=True) as (held, wanted):
        wanted.actions = held.actions
    return {action.name: action for action in wanted.actions}


def pose_of(rig):
    """Bone -> Euler angles."""
    return {bone.name: tuple(bone.rotation_euler) for bone in rig.pose.bones}


def test_the_button_writes_and_enters_the_library_once(home):
    before = [len(bpy.data.actions), len(bpy.data.images)]
    for _ in range(2):
        assert bpy.ops.thenar.add_pose_library() == {"FINISHED"}
    assert [len(bpy.data.actions), len(bpy.data.images)] == before, "nothing is left in the open file"
    entries = [e for e in bpy.context.preferences.filepaths.asset_libraries if e.name == library.NAME]
    assert len(entries) == 1 and entries[0].path.rstrip("/\\") == str(home)
    found = assets(home / library.BLEND)
    assert set(found) == {f"{label} ({side})" for label in LABELS.values() for side in ("right", "left")}
    catalogs = (home / library.CATALOGS).read_text()
    for action in found.values():
        assert action.asset_data.catalog_id in catalogs and action.asset_data.tags["hand"]


def test_catalogs_of_ones_own_stay(home):
    home.mkdir()
    mine = "01234567-0123-0123-0123-0123456789ab:Mine:Mine"
    (home / library.CATALOGS).write_text(f"VERSION 1\n\n{mine}\n")
    bpy.ops.thenar.add_pose_library()
    lines = (home / library.CATALOGS).read_text().splitlines()
    assert mine in lines and len(lines) == 5
    bpy.ops.thenar.add_pose_library()
    assert (home / library.CATALOGS).read_text().splitlines() == lines


@pytest.mark.parametrize("side", ["right", "left"])
def test_blender_poses_the_hand_as_the_pose_menu_does(written, side):
    bpy.ops.thenar.make_hand(side=side, spacing_mm=6.0)
    rig = bpy.context.scene.thenar.hand.parent
    found = assets(written)
    for name, label in LABELS.items():
        bpy.ops.thenar.apply_pose(name=name)
        wanted = pose_of(rig)
        bpy.ops.thenar.apply_pose(name="palm_press" if name != "palm_press" else "power_48")
        rig.pose.apply_pose_from_action(found[f"{label} ({side})"], evaluation_time=actions.FRAME)
        seen = pose_of(rig)
        worst = max(np.abs(np.subtract(seen[bone], wanted[bone])).max() for bone in wanted)
        assert worst < 1e-4, (name, worst)
        assert max(np.abs(values).max() for values in wanted.values()) > 0.1, name


def test_assets_bring_their_pictures(written):
    for name, action in assets(written).items():
        size = tuple(action.preview.image_size)
        assert size == (192, 192), name
        pixels = np.empty(192 * 192 * 4, np.float32)
        action.preview.image_pixels_float.foreach_get(pixels)
        alpha = pixels.reshape(192, 192, 4)[..., 3]
        assert 0.1 < (alpha > 0.5).mean() < 0.8, f"{name}: a hand on a clear ground"
    right, left = (library.picture("power_48", side) for side in ("right", "left"))
    assert np.array_equal(left, right[:, ::-1]) and not np.array_equal(left, right)


def test_every_picture_shows_the_pose_as_it_is():
    # Fails when a pose was changed: python -m thenar_blender pose_pictures --out addon/pose_library/pictures
    assert library.stamps() == {name: actions.digest(name) for name in LABELS}
    assert all((library.PICTURES / f"{name}.png").is_file() for name in LABELS)


def test_a_pose_that_changed_has_no_picture_and_is_named(monkeypatch, capfd):
    changed = {**POSES["pinch"], "index_middle": {"flexion": 1.0}}
    monkeypatch.setitem(POSES, "pinch", changed)
    assert library.picture("pinch", "right") is None and library.picture("flat", "right") is not None
    bpy.ops.thenar.add_pose_library()
    assert "without a picture: Pinch" in capfd.readouterr().out


def test_a_folder_that_cannot_be_written_is_named(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(library, "folder", lambda: tmp_path / "file" / "poses")
    with pytest.raises(RuntimeError, match=r"(?i)the pose library cannot be written to '.*poses'"):
        bpy.ops.thenar.add_pose_library()
    assert library.registered(bpy.context) is None and not bpy.data.actions


def test_a_blend_is_the_angles_in_between_and_ends_at_the_pose():
    bpy.ops.thenar.make_hand(side="left", spacing_mm=6.0)
    rig = bpy.context.scene.thenar.hand.parent
    bpy.ops.thenar.apply_pose(name="power_48")
    end = pose_of(rig)
    bpy.ops.thenar.apply_pose(name="palm_press")
    start = pose_of(rig)
    for factor in (0.0, 0.3, 1.0):
        bpy.ops.thenar.apply_pose(name="palm_press")
        assert bpy.ops.thenar.blend_pose(name="power_48", factor=factor) == {"FINISHED"}
        for bone, seen in pose_of(rig).items():
            wanted = (1 - factor) * np.array(start[bone]) + factor * np.array(end[bone])
            assert np.abs(np.array(seen) - wanted).max() < 1e-4, (bone, factor)


def test_a_blend_of_a_hand_without_bones_is_refused():
    import stage

    bpy.context.scene.thenar.hand = stage.pad()
    with pytest.raises(RuntimeError, match="has no armature"):
        bpy.ops.thenar.blend_pose(name="flat", factor=0.5)
