"""A picture of a case is small and ends in time, whatever the scene asks for."""

import bpy
import stage
from thenar_blender import pictures


def test_a_picture_is_small_and_ends_in_time(tmp_path, monkeypatch):
    stage.scene()
    stage.solve()
    scene, seen = bpy.context.scene, []
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 60, 65536, 100
    monkeypatch.setattr(
        pictures, "_render", lambda scene, path: seen.append((render.resolution_percentage, scene.cycles.time_limit))
    )
    pictures.render_scene(bpy.context, tmp_path / "a.png")
    ((percentage, limit_s),) = seen
    assert 65536 * percentage / 100 <= 1.05 * pictures.HIGHEST and 0.0 < limit_s <= 300.0
    assert (render.resolution_percentage, scene.cycles.time_limit) == (100, 0.0), "the scene's own are back"
