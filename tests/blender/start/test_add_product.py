"""Add Product: files written byte by byte become the product in the right size; bad ones change nothing."""

import bpy
import numpy as np
import product_files as files
import pytest
import stage

MM = 1e-3


def add(path):
    """Press the button for that file."""
    return bpy.ops.thenar.add_product(filepath=str(path))


def written(folder, name, data):
    path = folder / name
    path.write_bytes(data)
    return path


def blocks():
    """How many data-blocks of each kind the file has, and what the scene is set to."""
    scene = bpy.context.scene
    kinds = {name for name in dir(bpy.data) if isinstance(getattr(bpy.data, name), bpy.types.bpy_prop_collection)}
    counts = {name: len(getattr(bpy.data, name)) for name in kinds}
    timing = (scene.frame_start, scene.frame_end, scene.render.fps, scene.camera, scene.world, scene.frame_current)
    chosen = (scene.thenar.product, scene.thenar.product_collection, scene.thenar.accepted_mm, scene.thenar.added_mm)
    selected = sorted(obj.name for obj in bpy.context.selected_objects)
    return counts, timing, chosen, selected, bpy.context.view_layer.objects.active


@pytest.mark.parametrize("name", files.WRITERS)
def test_a_box_of_every_format_is_the_product(name, tmp_path):
    before = blocks()
    assert add(written(tmp_path, f"my {name}", files.WRITERS[name](MM))) == {"FINISHED"}
    product = bpy.context.scene.thenar.product
    assert product.name == f"my {name.partition('.')[0]}" and product.type == "MESH"
    corners = np.unique(stage.evaluated(product).round(3), axis=0)
    expected = files.corners() + (0.0, 0.0, 250.0 if name.endswith("glb") else 0.0)
    assert np.allclose(corners, np.unique(expected, axis=0), atol=0.01)
    assert len(product.data.polygons) in (6, 12)
    counts = blocks()[0]
    for kind in ("cameras", "lights", "armatures", "collections", "scenes", "worlds", "actions"):
        assert counts[kind] == before[0][kind], kind
    assert counts["objects"] == 1 and blocks()[1] == before[1]


def test_an_fbx_of_another_writer_is_read(tmp_path):
    stage.plate()
    bpy.context.object.scale = (2, 1, 1)
    path = tmp_path / "handle.fbx"
    bpy.ops.export_scene.fbx(filepath=str(path))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert add(path) == {"FINISHED"}
    points = stage.evaluated(bpy.context.scene.thenar.product)
    assert np.allclose(np.ptp(points, axis=0), (60, 30, 30), atol=0.01)


def test_a_file_of_several_parts_becomes_the_collection_of_parts(tmp_path):
    bpy.ops.object.camera_add()
    bpy.context.scene.camera = bpy.context.object
    assert add(written(tmp_path, "tool.glb", files.glb(MM, count=3))) == {"FINISHED"}
    settings = bpy.context.scene.thenar
    assert settings.product is None and settings.product_collection.name == "tool"
    parts = sorted(settings.product_collection.objects, key=lambda part: part.location.x)
    assert [round(part.matrix_world.translation.x / MM) for part in parts] == [0, 100, 200]
    assert all(part.parent is None and round(part.matrix_world.translation.z, 6) == 0.25 for part in parts)
    assert len(bpy.data.cameras) == 1 and bpy.context.scene.camera is not None


def test_a_file_in_mm_is_asked_about_and_the_button_mends_it(tmp_path):
    assert add(written(tmp_path, "handle.stl", files.stl())) == {"FINISHED"}
    scene = bpy.context.scene
    assert scene.thenar.hand is None and scene.thenar.added_mm == pytest.approx(125e3)
    from thenar_blender.scene import sizes

    measured = sizes.measure(scene, None, [scene.thenar.product])
    assert measured.factors == (1e-3,)
    assert bpy.ops.thenar.scale_product(factor=measured.factors[0]) == {"FINISHED"}
    assert np.allclose(np.ptp(stage.evaluated(scene.thenar.product), axis=0), files.SIDES, atol=0.01)
    assert sizes.measure(scene, None, [scene.thenar.product]).factors == ()


def test_a_thin_sheet_in_mm_is_asked_about_as_well(tmp_path):
    """As read it is 4 m long and 0.3 m thick: a rail could be so, but not what was just read for a hand."""
    data = files.ply().replace(b"-20.0", b"-0.15").replace(b" 20.0", b" 0.15").replace(b"\n20.0", b"\n0.15")
    data = data.replace(b"62.5", b"2")
    add(written(tmp_path, "sheet.ply", data))
    from thenar_blender.scene import sizes

    scene = bpy.context.scene
    assert sizes.measure(scene, None, [scene.thenar.product]).factors
    assert bpy.ops.thenar.accept_size() == {"FINISHED"}
    assert not sizes.measure(scene, None, [scene.thenar.product]).factors


def test_a_scene_in_millimetres_takes_a_file_in_mm_as_it_is(tmp_path):
    bpy.context.scene.unit_settings.scale_length = MM
    add(written(tmp_path, "handle.stl", files.stl()))
    from thenar_blender.scene import sizes

    scene = bpy.context.scene
    assert scene.thenar.added_mm == pytest.approx(125)
    assert not sizes.measure(scene, None, [scene.thenar.product]).factors


def _cut(name, share):
    data = files.WRITERS[name]()
    return data[: int(share * len(data))]


BAD = {
    "cut.stl": (lambda: _cut("bytes.stl", 0.6), "triangles need"),
    "cut_text.stl": (lambda: _cut("text.stl", 0.6), "endsolid"),
    "cut.ply": (lambda: _cut("bytes.ply", 0.8), "promises"),
    "cut_text.ply": (lambda: _cut("text.ply", 0.8), "lines of 20"),
    "cut.glb": (lambda: _cut("box.glb", 0.9), "bytes of"),
    "cut.usda": (lambda: _cut("box.usda", 0.5), "cut.usda"),
    "empty.obj": (lambda: b"", "it is empty"),
    "points.obj": (lambda: b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "3 points and 0 faces"),
    "numbers.obj": (lambda: b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "point 2 is no number"),
    "numbers.stl": (lambda: files.stl()[:100] + b"\xff" * 12 + files.stl()[112:], "no numbers"),
    "noise.stl": (lambda: bytes(range(256)) * 5, "triangles need"),
    "noise.ply": (lambda: bytes(range(256)) * 5, "no PLY header"),
    "noise.obj": (lambda: bytes(range(256)) * 5, "no text"),
    "noise.glb": (lambda: bytes(range(256)) * 5, "begin as one"),
    "noise.fbx": (lambda: bytes(range(256)) * 5, "begin as one"),
    "noise.usd": (lambda: bytes(range(256)) * 5, "begin as one"),
    "noise.gltf": (lambda: bytes(range(256)) * 5, "JSON"),
    "head.fbx": (lambda: b"Kaydara FBX Binary  \x00\x1a\x00" + b"\1" * 200, "head.fbx"),
    "head.glb": (lambda: b"glTF" + b"\2\0\0\0" + b"\x1c\0\0\0" + b"\0" * 16, "head.glb"),
    "head.usdc": (lambda: b"PXR-USDC" + b"\3" * 200, "head.usdc"),
    "head.usdz": (lambda: b"PK\x03\x04" + b"\3" * 200, "head.usdz"),
    "camera.usda": (lambda: b'#usda 1.0\ndef Camera "eye"\n{\n}\n', "no surface"),
    "part.step": (lambda: b"ISO-10303-21;", "'.step' files cannot be read"),
    "part": (lambda: b"ISO-10303-21;", "without an extension"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_file_is_refused_in_words_and_changes_nothing(name, tmp_path):
    stage.scene()
    before = blocks()
    make, said = BAD[name]
    with pytest.raises(RuntimeError) as refused:
        add(written(tmp_path, name, make()))
    text = str(refused.value).strip()
    assert text.startswith("Error: ") and text.count("\n") == 0, text
    assert said in text and "Traceback" not in text, text
    assert blocks() == before


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(RuntimeError, match=r"There is no file 'gone\.stl'"):
        add(tmp_path / "gone.stl")


def test_one_undo_takes_the_product_out_again(tmp_path):
    path = written(tmp_path, "handle.stl", files.stl(MM))
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.thenar.add_product("EXEC_DEFAULT", True, filepath=str(path)) == {"FINISHED"}
    assert bpy.context.scene.thenar.product is not None
    bpy.ops.ed.undo()
    assert bpy.context.scene.thenar.product is None and len(bpy.data.objects) == 0


def test_files_can_be_dropped_on_the_view():
    handler = bpy.types.FileHandler.bl_rna_get_subclass_py("THENAR_FH_product")
    assert handler.bl_import_operator == "thenar.add_product"
    assert {".stl", ".glb", ".usdz", ".fbx"} <= set(handler.bl_file_extensions.split(";"))
