"""What a case depends on besides its own file: libraries, images and their sequences, caches, Alembic."""

import os

import bpy
import numpy as np
import stage
from thenar_blender.batch import depends


def test_a_changed_library_is_solved_again(batch, tmp_path):
    _, product = stage.scene()
    name = product.name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "lib.blend"), copy=True)
    _, product = stage.scene()
    bpy.data.objects.remove(product)
    with bpy.data.libraries.load(str(tmp_path / "lib.blend"), link=True, relative=True) as (_, wanted):
        wanted.objects = [name]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    bpy.context.scene.thenar.product = wanted.objects[0]
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "main.blend"))
    (tmp_path / "jobs.toml").write_text('blend = "main.blend"\nsave = false\n[[case]]\nname = "linked"\n')
    code, output, first = batch(tmp_path / "out", "--workers", 1)
    assert code == 0, output
    code, output, _ = batch(tmp_path / "out", "--workers", 1)
    assert "1 of 1 cases kept" in output
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "lib.blend"))
    bpy.data.objects[name].location.z += -0.0002
    bpy.ops.wm.save_mainfile()
    code, output, again = batch(tmp_path / "out", "--workers", 1)
    assert code == 0 and "kept" not in output
    _, _, fresh = batch(tmp_path / "fresh", "--workers", 1)
    assert again[0]["force_n"] == fresh[0]["force_n"] != first[0]["force_n"]


def test_images_sequences_caches_and_alembic_are_known(tmp_path):
    stage.scene()
    bpy.ops.wm.alembic_export(filepath=str(tmp_path / "waves.abc"))
    hand, _ = stage.scene()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "main.blend"))
    for number in (1, 2, 10):
        _picture(tmp_path / f"grain_{number:04}.png")
    _picture(tmp_path / "other_0001.png")
    image = bpy.data.images.load(str(tmp_path / "grain_0001.png"))
    image.source = "SEQUENCE"
    image.use_fake_user = True
    cache = hand.modifiers.new("cache", "MESH_CACHE")
    cache.filepath = "//gone.pc2"
    bpy.ops.cachefile.open(filepath=str(tmp_path / "waves.abc"))
    found = depends.of_open_file({})
    assert set(found) == {
        str(tmp_path / name) for name in ("waves.abc", "grain_0001.png", "grain_0002.png", "grain_0010.png", "gone.pc2")
    }
    assert found[str(tmp_path / "gone.pc2")] == "" and all(found[path] for path in found if "gone" not in path)
    assert depends.are_unchanged(found, {})
    for name in ("grain_0010.png", "waves.abc", "gone.pc2"):
        path = tmp_path / name
        before = path.read_bytes() if path.exists() else None
        path.write_bytes(b"painted")
        assert not depends.are_unchanged(found, {}), name
        path.unlink() if before is None else path.write_bytes(before)
    assert depends.are_unchanged(found, {})
    assert not depends.are_unchanged([], {}) and not depends.are_unchanged(None, {})


def test_a_pipe_is_not_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert depends.digest(tmp_path / "pipe", {}) == ""


def _picture(path):
    image = bpy.data.images.new(path.stem, 2, 2)
    image.pixels.foreach_set(np.ones(16, np.float32))
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
