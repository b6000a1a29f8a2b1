"""Live Film: frames show the forces of their solves, nothing is left next to the file, a still scene is refused."""

import bpy
import pytest
import stage as scenes
from thenar_blender.picture_sets import drawing, film
from thenar_blender.picture_sets import order as orders
from thenar_blender.picture_stage import page as pages
from thenar_blender.scene.checks import Refusal

SMALL = {"height": 64, "samples": 1}


@pytest.fixture
def sinking(tmp_path):
    """A ball that sinks into a plate in three frames, in a saved file, solved at the first."""
    hand, _ = scenes.scene()
    for frame, sunk_mm in ((1, 0.0), (3, 0.8)):
        hand.location.z = -sunk_mm * 1e-3
        hand.keyframe_insert("location", frame=frame)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 3
    scene.frame_set(1)
    scenes.solve()
    folder = tmp_path / "own"
    folder.mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "own.blend"))
    return folder


def test_every_frame_shows_the_force_of_its_own_solve(sinking, tmp_path, monkeypatch):
    monkeypatch.setattr(film, "has_ffmpeg", lambda: False)
    wanted = []
    for frame in (1, 2, 3):
        bpy.context.scene.frame_set(frame)
        wanted.append(f"{scenes.solve().force_n:.1f} N")
    assert len(set(wanted)) == 3, "the ball sinks"
    bpy.ops.wm.open_mainfile(filepath=str(sinking / "own.blend"))
    sheets, painted = [], pages.painted
    monkeypatch.setattr(pages, "painted", lambda sheet, factor: sheets.append(sheet) or painted(sheet, factor))
    made = drawing.draw(orders.Order(orders.LIVE, str(tmp_path / "film.mp4"), frames=48, **SMALL), bpy.context)
    assert [path.name for path in made] == [f"film-{number:04}.png" for number in (1, 2, 3)]
    for sheet, force in zip(sheets, wanted, strict=True):
        assert force in [item.text for item in sheet.items if isinstance(item, pages.Text)]
    assert [path.name for path in sinking.iterdir()] == ["own.blend"], "the bake is not left next to the file"


def test_curve_colors_the_frames_up_to_now(sinking, tmp_path, monkeypatch):
    monkeypatch.setattr(film, "has_ffmpeg", lambda: False)
    sheets, painted = [], pages.painted
    monkeypatch.setattr(pages, "painted", lambda sheet, factor: sheets.append(sheet) or painted(sheet, factor))
    drawing.draw(orders.Order(orders.LIVE, str(tmp_path / "film.mp4"), frames=2, **SMALL), bpy.context)
    assert len(sheets) == 2, "no more frames than asked for"
    boxes = [
        [item for item in sheet.items if isinstance(item, pages.Box) and item.box[0] >= 1330.0] for sheet in sheets
    ]
    bars = [[box for box in sheet if box.box[3] > 2.5] for sheet in boxes]
    colors = [[box.color for box in sheet[:2]] for sheet in bars]
    assert colors[0][0] != colors[0][1] and colors[1][0] == colors[1][1] == colors[0][0]
    assert bars[1][0].box[3] < bars[1][1].box[3], "a force that rises has a longer bar"


def test_film_of_a_still_scene_is_refused(tmp_path):
    scenes.scene()
    scenes.solve()
    with pytest.raises(Refusal, match="nothing moves from frame 1 to 48"):
        drawing.draw(orders.Order(orders.LIVE, str(tmp_path / "film.mp4"), **SMALL), bpy.context)
    assert list(tmp_path.iterdir()) == []


def test_film_is_h264_at_the_rate_of_the_scene(sinking, tmp_path):
    reader = pytest.importorskip("av")
    if not film.has_ffmpeg():
        pytest.skip("this Blender writes no films")
    bpy.context.scene.render.fps = 12
    drawing.draw(orders.Order(orders.LIVE, str(tmp_path / "film.mp4"), **SMALL), bpy.context)
    with reader.open(str(tmp_path / "film.mp4")) as opened:
        stream = opened.streams.video[0]
        assert stream.codec_context.name == "h264" and float(stream.average_rate) == 12.0
        assert len([frame for frame in opened.decode(stream)]) == 3


def test_order_of_one_frame_is_refused():
    with pytest.raises(Refusal, match="a film of 1 frames"):
        orders.check(orders.Order(orders.LIVE, "film.mp4", frames=1))
