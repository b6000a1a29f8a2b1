"""A picture's map has the palette's published colors, and its scale bar the length of things of known size."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
import stage as scenes
from thenar_blender.hand_look import studio
from thenar_blender.picture_sets import grip_and_print
from thenar_blender.picture_sets.order import Order
from thenar_blender.picture_stage import laying, page, stage, views
from thenar_blender.picture_stage import pixels as pixels_file

VIRIDIS = {
    0.0: (0.267004, 0.004874, 0.329415),
    0.25: (0.229739, 0.322361, 0.545706),
    0.5: (0.127568, 0.566949, 0.550556),
    0.75: (0.369214, 0.788888, 0.382914),
    1.0: (0.993248, 0.906157, 0.143936),
}
"""Of the table by van der Walt & Smith 2015 (CC0), at its rows 0, 64, 128, 192 and 255."""
STEP = 5.5 / 255.0
"""How far the add-on's stops lie off that table at most, as it states."""


def bands(shares, high, unit=1e-3):
    """Squares of 10 mm in a row, each of one pressure, parted: nothing is interpolated. `unit`: units per mm."""
    points, faces, pressure = [], [], []
    for number, share in enumerate(shares):
        first = len(points)
        points += [((12 * number + x) * unit, y * unit, 0.0) for x, y in ((0, 0), (10, 0), (10, 10), (0, 10))]
        faces.append(range(first, first + 4))
        pressure += [share * high] * 4
    mesh = bpy.data.meshes.new("Bands")
    mesh.from_pydata(points, [], [list(face) for face in faces])
    for name, values in (("pressure_kpa", pressure), ("contact_edge_mm", [5.0] * len(points))):
        mesh.attributes.new(name, "FLOAT", "POINT").data.foreach_set("value", values)
    return laying.Solid(mesh, np.eye(4), "hand", True)


@pytest.mark.parametrize("unit", [1e-3, 1.0])
def test_map_has_the_published_colors_also_through_the_denoiser(unit):
    look = bpy.context.scene.thenar
    look.palette, look.range_kpa = "VIRIDIS", 80.0
    solid = bands(VIRIDIS, 80.0, unit)
    window = stage.Window((29.0, 5.0), 1.0, (80, 30))
    shot = stage.Shot(look, [solid], np.eye(3), window, 1.0 / unit, floor_mm=-5.0, samples=2)
    pixels = stage.take(shot)
    for number, wanted in enumerate(VIRIDIS.values()):
        column, row = 40 + round(12 * number + 5 - 29), 15
        np.testing.assert_allclose(pixels[row, column], wanted, atol=STEP)


def test_sheet_has_the_color_of_the_page():
    """So that a picture has no edge: lights, sky and the sheet's own color are matched in closed form."""
    solid = bands([0.5], 80.0)
    window = stage.Window((5.0, 5.0), 10.0, (80, 60))
    shot = stage.Shot(bpy.context.scene.thenar, [solid], np.eye(3), window, 1000.0, floor_mm=-1.0, samples=4)
    pixels = stage.take(shot)
    np.testing.assert_allclose(pixels[28, 14], stage.PAGE, atol=3.0 / 255.0)


def block(width_mm):
    """A block as wide, dark, 8 mm under the ball's middle."""
    plate = scenes.plate(size=width_mm, cuts=6)
    material = bpy.data.materials.new("Black")
    material.use_nodes = True
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    shader.inputs["Specular IOR Level"].default_value = 0.0
    plate.data.materials.append(material)
    return plate


def test_scale_bar_is_as_long_as_what_it_says():
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = scenes.pad(), block(30.0)
    bpy.context.view_layer.update()
    scenes.solve()
    order = Order("GRIP_AND_PRINT", "x.png", height=270, samples=2)
    subject = laying.gather(bpy.context)
    front = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    sheet = page.Page(1920.0, 1080.0, stage.PAGE)
    part = ((60.0, 128.0, 1020.0, 750.0), subject.gripped(), front)
    progress = SimpleNamespace(order=order, part=lambda *_: lambda share: None)
    mm = grip_and_print.lay(sheet, (subject, bpy.context), [part], progress)
    length = page.add_scale_bar(sheet, (64.0, 52.0), mm * order.factor, 220.0)
    pixels = page.painted(sheet, order.factor)
    bar = [item for item in sheet.items if isinstance(item, page.Text)]
    assert bar[-1].text == f"{length:g} mm"
    inked = (pixels[int(53 * order.factor)].max(axis=1) < 0.5).sum()
    dark = (pixels[round(240 * order.factor)].max(axis=1) < 0.25).sum()
    assert dark > 40, "the block is seen"
    assert abs(inked / dark - length / 30.0) < 2.5 / dark, "to a pixel or two"


def test_a_written_picture_is_read_back_as_it_was(tmp_path):
    pixels = np.random.default_rng(1).random((20, 30, 3))
    pixels_file.save_png(tmp_path / "x.png", pixels)
    image = bpy.data.images.load(str(tmp_path / "x.png"))
    assert tuple(image.size) == (30, 20)
    read = np.array(image.pixels[:]).reshape(20, 30, 4)[..., :3]
    np.testing.assert_allclose(read, pixels, atol=0.51 / 255.0)


def test_a_shot_leaves_what_it_shows_as_it_was():
    """A film takes the same parts many times."""
    solid = bands([0.5], 80.0)
    solid.has_map = False
    solid.mesh.materials.append(block(30.0).data.materials[0])
    window = stage.Window((5.0, 5.0), 1.0, (16, 16))
    shot = stage.Shot(bpy.context.scene.thenar, [solid], np.eye(3), window, 1000.0, samples=1)
    first, scenes_before = stage.take(shot), len(bpy.data.scenes)
    np.testing.assert_allclose(stage.take(shot), first, atol=1e-6)
    assert first[8, 8].max() < 0.3 and len(bpy.data.scenes) == scenes_before


def test_view_of_a_grip_goes_round_what_hides_the_hand():
    """A closed form: a wide board under a ball hides it from below, and nothing hides it from above."""
    ball, board = scenes.pad(), scenes.plate(size=200.0, cuts=2, top=-8.0)
    solids = [
        laying.Solid(obj.data, np.array(obj.matrix_world), kind, True)
        for obj, kind in ((ball, "hand"), (board, "product"))
    ]
    subject = laying.Subject(solids[0], solids[0], solids[1:], [], 1000.0)
    assert views.seen_share(subject, np.array([0.0, 0.0, -1.0])) == 0.0
    assert views.seen_share(subject, np.array([0.0, 0.0, 1.0])) == 1.0
    board.data.materials.append(studio.clear("Glass", (1.0, 1.0, 1.0, 1.0)))
    assert views.seen_share(subject, np.array([0.0, 0.0, -1.0])) == 1.0


class Bare:
    """Render settings of a Blender that was built without a denoiser: the list of denoisers is empty."""

    @property
    def denoiser(self):
        """None of an empty list."""
        return ""

    @denoiser.setter
    def denoiser(self, name):
        raise TypeError(f'bpy_struct: item.attr = val: enum "{name}" not found in ()')


def test_a_blender_without_a_denoiser_draws_all_the_same():
    assert stage.can_denoise(bpy.context.scene.cycles)
    assert not stage.can_denoise(Bare())
