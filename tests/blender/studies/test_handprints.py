"""A handprint in a scene: its image laid on the product, compared with the contact, shown on both, kept and refused."""

import bpy
import numpy as np
import pytest
import small_studies
import stage
from thenar_blender.recordings import laying

PIXEL_MM, SIDE_MM = 25.4 / 254, 20.0


def save(path, is_ink):
    """The image of a sheet about the middle of the plate, black where `is_ink(x, y)` in mm; Blender writes it."""
    count = round(SIDE_MM / PIXEL_MM)
    places = (np.arange(count) + 0.5) * PIXEL_MM - SIDE_MM / 2
    x, y = np.meshgrid(places, places)
    pixels = np.ones((count, count, 4), np.float32)
    pixels[..., :3] = np.where(is_ink(x, y), 0.1, 0.9)[..., None]
    image = bpy.data.images.new("print", count, count)
    image.pixels.foreach_set(pixels.ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
    return str(path)


def load(path):
    assert bpy.ops.thenar.load_recording(filepath=path) == {"FINISHED"}
    item = bpy.context.scene.thenar_recordings.items[-1]
    item.placing.on, item.placing.axis = "PLANE", "+Z"
    item.print.dpi, item.print.cell_mm = 254, 0.5
    return item


def measure(name):
    rows = bpy.context.scene.thenar_recordings.comparison.measures
    return next((row.measured, row.simulated) for row in rows if row.name == name)


@pytest.fixture
def compared(tmp_path):
    """Ball on plate and a print of what touches, but for a corner that left no ink."""
    hand, product = stage.pad(fineness=6), stage.plate(top=-6.3)
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = hand, product
    bpy.context.view_layer.update()
    stage.solve()
    touching = stage.evaluated(hand)[stage.attribute(hand, "contact_force_n") > 0][:, :2]
    radius = np.linalg.norm(touching, axis=1).max()
    item = load(save(tmp_path / "print.png", lambda x, y: (np.hypot(x, y) < radius) & ~((x > 1) & (y > 1))))
    assert item.kind == "PRINT" and "200 x 200 pixels" in item.about
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    return hand, product, radius


def test_overlap_area_and_map(compared):
    hand, product, radius = compared
    state = bpy.context.scene.thenar_recordings.comparison
    inked, simulated = map(float, measure("Area"))
    corner = inked_corner(radius)
    assert inked == pytest.approx(np.pi * radius**2 - corner, rel=0.05)
    assert simulated == pytest.approx(np.pi * radius**2, rel=0.1)
    assert float(measure("Overlap")[1].rstrip("%")) > 65
    assert "overlaps with simulated contact" in state.sentence
    assert bpy.context.scene.thenar.maps.shown == "PRINT"
    residual, on_mat = stage.attribute(hand, "print_residual"), stage.attribute(hand, "on_mat")
    assert set(np.unique(residual)) <= {-1.0, 0.0, 1.0} and (residual[on_mat == 0] == 0).all()
    missing = stage.evaluated(hand)[residual == -1]
    assert len(missing) and (missing[:, :2] > 0).all(axis=1).mean() > 0.6, "the corner touches and left no ink"
    spread, places = stage.attribute(product, "print_residual"), stage.evaluated(product)
    is_inside = (places[:, :2] > 1.2).all(axis=1) & (np.hypot(*places[:, :2].T) < 0.8 * radius)
    is_inside &= places[:, 2] > places[:, 2].max() - 0.01
    assert is_inside.any() and (spread[is_inside] < -0.5).all() and "residual_kpa" not in hand.data.attributes


def test_ink_that_asks_for_pressure_is_compared_with_less_contact(compared):
    hand, _, _ = compared
    before = float(measure("Area")[1])
    pressure, force = stage.attribute(hand, "pressure_kpa"), stage.attribute(hand, "contact_force_n")
    limit = 0.5 * float(pressure.max())
    bpy.context.scene.thenar_recordings.items[-1].print.ink_kpa = limit
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    area = np.where(pressure > 0, 1e3 * force / np.maximum(pressure, 1e-30), 0.0)
    wanted = area[pressure > limit].sum()
    assert wanted < 0.85 * before and float(measure("Area")[1]) == pytest.approx(wanted, rel=0.15)


def test_an_image_is_read_as_the_panel_says(tmp_path):
    path = save(tmp_path / "ring.png", lambda x, y: ~((np.hypot(x - 3, y) > 4) & (np.hypot(x - 3, y) < 7)))
    item = load(path)
    ring = np.pi * (49 - 16)
    for ink, told, area in (("AUTO", "light", ring), ("DARK", "dark", SIDE_MM**2 - ring)):
        item.print.ink = ink
        read = laying.look_of(item).read(path)
        assert read.ink == told and read.inked_mm2 == pytest.approx(area, rel=0.01)
    item.print.is_mirrored = True
    behind = np.asarray(laying.look_of(item).read(path).inked).reshape(read.cells)
    assert np.array_equal(behind, np.asarray(read.inked).reshape(read.cells)[:, ::-1])


STUDY = """
[skin]
mesh = "skin.obj"
[skin.materials.default]
g0_mpa = 0.02
g_lim_mpa = 0.05
d_lim_mm = 4.0
thickness_mm = 7.0
[indenters.plate]
shape = "plane"
[sites.low]
point_mm = [0.0, 0.0, -8.0]
direction = [0.0, 0.0, 1.0]
"""
RECORDING = """
[[recordings]]
name = "{name}"
kind = "handprint"
file = "{name}.png"
dpi = 254
cell_mm = 0.5
depth_mm = 1.2
indenter = "plate"
site = "low"
[recordings.placing]
on = "plane"
origin_mm = [-10.0, -10.0, -8.0]
columns = [1.0, 0.0, 0.0]
rows = [0.0, 1.0, 0.0]
"""


def test_of_a_studys_prints_the_hand_shows_the_one_that_overlaps_least(tmp_path):
    hand, _ = stage.scene()
    hand.data.calc_loop_triangles()
    triangles = np.array([list(each.vertices) for each in hand.data.loop_triangles])
    small_studies.write_skin(tmp_path / "skin.obj", stage.evaluated(hand), triangles)
    radius = np.sqrt(2 * 8.0 * 1.2)
    save(tmp_path / "whole.png", lambda x, y: np.hypot(x, y) < radius)
    save(tmp_path / "half.png", lambda x, y: (np.hypot(x, y) < radius) & (y > 0))
    recordings = "".join(RECORDING.format(name=name) for name in ("whole", "half"))
    (tmp_path / "study.toml").write_text(STUDY + recordings)
    bpy.ops.thenar.load_recording(filepath=str(tmp_path))
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    comparison = bpy.context.scene.thenar_recordings.comparison
    assert any("differ in 'half', the print that overlaps least" in note.name for note in comparison.notes)
    residual = stage.attribute(hand, "print_residual")
    assert (residual == -1).sum() > 5 * (residual == 1).sum(), "half of what touches left no ink"


def test_the_corner_is_the_worst_place_and_selects_its_skin(compared):
    hand, _, radius = compared
    state = bpy.context.scene.thenar_recordings.comparison
    assert state.worst[0].residual.endswith("mm², no ink")
    area = float(state.worst[0].residual.split()[0])
    # The bent sides of what is missing are told to a cell of 0.5 mm.
    assert area == pytest.approx(inked_corner(radius), rel=0.25)
    assert bpy.ops.thenar.select_place(index=0) == {"FINISHED"}
    assert bpy.context.object == hand and hand.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    chosen = [vertex.index for vertex in hand.data.vertices if vertex.select]
    places = stage.evaluated(hand)[chosen]
    assert len(chosen) > 3 and (places[:, :2] > 0.3).all()
    assert (np.linalg.norm(places[:, :2], axis=1) < radius + 0.7).all()


def test_regions_are_told_apart(compared):
    """The half where x > 0 is a region of its own: the corner is missing there and nowhere else."""
    hand, _, radius = compared
    places = stage.evaluated(hand)
    for name, is_in in (("side_right", places[:, 0] > 0), ("side_left", places[:, 0] <= 0)):
        hand.vertex_groups.new(name=name).add([int(k) for k in np.flatnonzero(is_in)], 1.0, "REPLACE")
    assert bpy.ops.thenar.assign_regions() == {"FINISHED"}
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    rows = bpy.context.scene.thenar_recordings.comparison.measures
    shown = [row for row in rows if row.group == "inked area by region, mm²"]
    found = {row.name: (float(row.measured), float(row.simulated)) for row in shown}
    assert set(found) == {"Side left", "Side right"}
    half = np.pi * radius**2 / 2
    for read, simulated, expected in (
        (*found["Side left"], half),
        (*found["Side right"], half - inked_corner(radius)),
    ):
        assert read == pytest.approx(expected, rel=0.15) and simulated == pytest.approx(half, rel=0.15)


def inked_corner(radius):
    """Area of the disc beyond x = 1 and y = 1 mm."""
    x = np.linspace(1, np.sqrt(radius**2 - 1), 2001)
    height = np.sqrt(np.maximum(radius**2 - x**2, 0)) - 1
    return float(((height[1:] + height[:-1]) / 2 * np.diff(x)).sum())


def test_it_is_drawn_kept_and_reported(compared, tmp_path):
    assert bpy.ops.thenar.outline_mat() == {"FINISHED"}
    mat = bpy.data.objects["Thenar Mat"]
    assert len(mat.data.polygons) == 40 * 40 and stage.attribute(mat, "reading").max() == pytest.approx(1.0)
    page = tmp_path / "report.html"
    assert bpy.ops.thenar.report(filepath=str(page)) == {"FINISHED"}
    assert "orange: inked alone" in page.read_text()
    before = bpy.context.scene.thenar_recordings.comparison.sentence
    path = str(tmp_path / "kept.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    state = bpy.context.scene.thenar_recordings
    assert state.comparison.sentence == before and state.items[0].print.dpi == 254
    assert bpy.ops.thenar.compare() == {"FINISHED"} and state.comparison.sentence == before
    stage.solve()
    assert "print_residual" not in bpy.context.scene.thenar.hand.data.attributes


def test_what_is_no_print_says_why(tmp_path):
    stage.scene()
    plain = save(tmp_path / "plain.png", lambda x, y: np.zeros_like(x, bool))
    with pytest.raises(RuntimeError, match="no ink stands out"):
        bpy.ops.thenar.load_recording(filepath=plain)
    (tmp_path / "text.png").write_text("no image")
    with pytest.raises(RuntimeError, match="save the print as PNG, JPEG or TIFF"):
        bpy.ops.thenar.load_recording(filepath=str(tmp_path / "text.png"))
    item = load(save(tmp_path / "disc.png", lambda x, y: np.hypot(x, y) < 4))
    item.print.cell_mm = 0.1
    with pytest.raises(RuntimeError, match="scan with more dpi"):
        bpy.ops.thenar.compare()
