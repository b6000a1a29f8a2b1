"""Bounds of a new study: sizes of contact on one flat piece of skin, and how many recordings and protocols."""

import bpy
import laboratory
import numpy as np
import pytest
import thenar
from thenar_blender import native
from thenar_blender.new_study import drafting, settings


def draft():
    return bpy.context.scene.thenar_new_study


def choose(folder, names):
    return bpy.ops.thenar.new_study(directory=f"{folder}/", files=[{"name": name} for name in names])


@pytest.fixture
def two(tmp_path):
    """Two presses, each a protocol of its own."""
    for number in (1, 2):
        laboratory.write(tmp_path / f"p{number}.csv", laboratory.press(number))
    choose(tmp_path, ["p1.csv", "p2.csv"])
    draft().files[1].protocol = 2
    return tmp_path


def rods(one_mm, other_mm):
    for protocol, diameter in zip(draft().protocols, (one_mm, other_mm), strict=True):
        protocol.shape, protocol.diameter_mm = "PUNCH", diameter


def test_contacts_of_very_different_size_are_refused_by_file_and_write_nothing(two):
    rods(0.22, 20.0)
    with pytest.raises(RuntimeError, match=r"'p1\.csv' \(radius about 0\.11 mm\) is too small .* 'p2\.csv' \(10 mm\)"):
        bpy.ops.thenar.write_study()
    assert sorted(each.name for each in two.iterdir()) == ["p1.csv", "p2.csv"]


def test_a_depth_in_the_wrong_unit_is_refused_at_once(tmp_path):
    """0.8 mm that are called nanometers next to 0.8 mm: a patch for both would have millions of points."""
    laboratory.write(tmp_path / "p1.csv", laboratory.press(1), head=("time_s", "depth_nm", "force_n"))
    laboratory.write(tmp_path / "p2.csv", laboratory.press(2))
    choose(tmp_path, ["p1.csv", "p2.csv"])
    for protocol in draft().protocols:
        protocol.diameter_mm = 12.0
    with pytest.raises(RuntimeError, match=r"'p1\.csv' .* check the unit of the depth"):
        bpy.ops.thenar.write_study()


def test_a_contact_that_reaches_the_edge_of_the_patch_is_refused(two):
    rods(12.0, 130.0)
    with pytest.raises(RuntimeError, match=r"'p2\.csv' touches a radius of about 65 mm, more than the 42 mm"):
        bpy.ops.thenar.write_study()


@pytest.mark.parametrize("diameters", [(1.0, 20.0), (12.0, 80.0)])
def test_a_patch_that_is_written_goes_beyond_the_largest_contact(two, diameters):
    rods(*diameters)
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    vertices = np.asarray(thenar.Study.load(two).skin.vertices_mm)
    assert len(vertices) <= 100_000
    assert np.linalg.norm(vertices, axis=1).max() >= 1.4 * max(diameters) / 2


def test_a_hundred_recordings_are_read_once_and_more_protocols_than_the_panel_holds_are_refused(tmp_path, monkeypatch):
    """Presses differ by a factor of 1.3 in time or of 1.6 in depth and force, so that none repeats another."""
    names = []
    for number in range(101):
        slower, larger = 1.3 ** (number % 17), 1.6 ** (number // 17)
        rows = [(t * slower, d * larger, f * larger) for t, d, f in laboratory.press(1)[::4]]
        names.append(laboratory.write(tmp_path / f"p{number:03d}.csv", rows))
    choose(tmp_path, names)
    assert len({item.protocol for item in draft().files}) == 101
    for protocol in draft().protocols:
        protocol.diameter_mm = 12.0
    assert "these are 101 protocols, and one study takes 99 here" in drafting.problem(bpy.context)
    whole, read = native.module.read_recording, []
    monkeypatch.setattr(
        native.module, "read_recording", lambda path, **named: read.append(path) or whole(path, **named)
    )
    draft().files[100].protocol = 1
    draft().files[99].protocol = 1
    assert read == []
    assert drafting.problem(bpy.context) == ""
    laboratory.write(tmp_path / names[7], laboratory.press(7))
    drafting.refresh(bpy.context)
    assert len(read) == 1 and str(read[0]).endswith(names[7])


def test_more_recordings_than_numbers_are_refused_and_change_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(settings, "MOST_FILES", 2)
    names = [laboratory.write(tmp_path / f"p{k}.csv", laboratory.press(k)) for k in (1, 2, 3)]
    with pytest.raises(RuntimeError, match="hese are 3 recordings, and one study takes 2 here; choose fewer"):
        choose(tmp_path, names)
    assert not draft().is_open
