"""On Glass: skin pales as published blood flow falls, the boundary is sharp, and the scale holds in perspective."""

import bpy
import numpy as np
import pytest
import stage as scenes
from thenar_blender.picture_sets import on_glass
from thenar_blender.picture_sets import order as orders
from thenar_blender.picture_stage import glass, laying, stage, values
from thenar_blender.scene.checks import Refusal

SMALL = {"height": 64, "samples": 1}
SIDE_MM = 40.0


@pytest.fixture
def solved():
    """A ball pressed on a plate."""
    scenes.scene()
    return scenes.solve()


def square(side_mm=SIDE_MM, height_mm=0.0, cuts=40):
    """A square facing z as a `Solid`, with points spread over it."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cuts, y_subdivisions=cuts, size=side_mm * 1e-3)
    mesh = bpy.context.object.data
    matrix = np.eye(4)
    matrix[2, 3] = height_mm * 1e-3
    return laying.Solid(mesh, matrix, "hand", False)


def put(mesh, pressure_kpa, edge_mm):
    """Fields of a contact, functions of x in mm."""
    x = np.array([vertex.co.x for vertex in mesh.vertices]) * 1e3
    for name, rule in (("pressure_kpa", pressure_kpa), ("contact_edge_mm", edge_mm)):
        mesh.attributes.new(name, "FLOAT", "POINT").data.foreach_set("value", rule(x).astype(np.float32))


def taken(solid, pixels=60, mm=1.0, **more):
    """The picture of one solid from above, 60 mm wide."""
    window = stage.Window((0.0, 0.0), mm, (pixels, pixels))
    return stage.take(stage.Shot(bpy.context.scene.thenar, [solid], np.eye(3), window, 1000.0, samples=16, **more))


def linear(pixels):
    return np.where(pixels <= 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4)


def test_blood_falls_as_measured_in_hands():
    """Johansson, Hägg & Fischer 2002: by 50 % at 15 to 33 kPa, by 85 % at 30 to 52 kPa."""
    pressure = np.linspace(0.0, 100.0, 10001)
    left = glass.blood_left(pressure)
    assert left[0] == 1.0 and (np.diff(left) <= 0.0).all() and left[-1] == 0.0
    assert 15.0 <= np.interp(-0.5, -left, pressure) <= 33.0
    assert 30.0 <= np.interp(-0.15, -left, pressure) <= 52.0


def test_pressed_skin_is_lighter_and_yellower_and_sharply_bounded():
    solid = square()
    put(solid.mesh, lambda x: np.full(len(x), 48.0), lambda x: np.clip(x, -5.0, 5.0))
    glass.dress(solid.mesh)
    row = linear(taken(solid, mm=0.25)[25:35].mean(axis=0))  # the boundary lies between pixels 29 and 30
    free, rim, pressed = row[7:11].mean(axis=0), row[26], row[42:48].mean(axis=0)
    gain = pressed / free
    assert gain[0] > 1.0 and gain[1] > 1.5 and gain[1] > gain[2] > gain[0], gain
    assert ((row[33:48, 1] - rim[1]) / (pressed[1] - rim[1])).min() > 0.9, "pale 0.75 mm inside the boundary"
    assert rim[1] < 0.9 * free[1], "red 1 mm outside it: the blood that is displaced"


def test_more_pressure_is_paler():
    """At equal touch the green reflected rises with the pressure, up to the bloodless one and no farther."""
    seen = []
    for kpa in (0.5, 12.0, 24.0, 48.0, 96.0):
        solid = square()
        put(solid.mesh, lambda x, kpa=kpa: np.full(len(x), kpa), lambda x: np.full(len(x), 5.0))
        glass.dress(solid.mesh)
        seen.append(linear(taken(solid)[25:35, 25:35].mean(axis=(0, 1)))[1])
    assert seen[0] < seen[1] < seen[2] < seen[3] and seen[4] == pytest.approx(seen[3], rel=0.02)


def test_legend_begins_and_ends_as_the_rendered_skin():
    """The ratio of the legend's ends is that of rendered skin at their pressures."""
    ends = glass.color_under(np.array([0.0, glass.BLOODLESS_KPA]), glass.PALE)
    seen = []
    for kpa in (0.0, glass.BLOODLESS_KPA):
        solid = square()
        put(solid.mesh, lambda x, kpa=kpa: np.full(len(x), kpa), lambda x: np.full(len(x), 5.0))
        glass.dress(solid.mesh)
        seen.append(linear(taken(solid)[25:35, 25:35].mean(axis=(0, 1))))
    assert seen[1] / seen[0] == pytest.approx(ends[1] / ends[0], rel=0.12)


def test_scale_holds_in_the_plane_of_the_glass():
    """A square of 40 mm is as wide as without perspective; one twice as far from the eye is half as wide."""

    def width(picture):
        dark = picture[28:32].max(axis=2).mean(axis=0) < 0.7
        return np.flatnonzero(dark).max() - np.flatnonzero(dark).min() + 1

    def plain(solid):
        solid.mesh.materials.clear()
        solid.mesh.materials.append(values.nothing())
        return solid

    near = width(taken(plain(square()), perspective=(0.0, 300.0), floor_mm=-400.0))
    far = width(taken(plain(square(height_mm=-300.0)), perspective=(0.0, 300.0), floor_mm=-400.0))
    assert near == pytest.approx(SIDE_MM, abs=1.5) and far == pytest.approx(SIDE_MM / 2.0, abs=1.5)


def test_picture_has_hand_map_and_both_legends(solved):
    order = orders.Order(orders.GLASS, "x.png", **SMALL)
    sheet = on_glass.draw(order, laying.gather(bpy.context), bpy.context)
    words = [item.text for item in sheet.items if hasattr(item, "text")]
    assert f"{solved.force_n:.1f} N" in words and "Pressure, kPa" in words
    assert "Color of the skin on the glass, by pressure, kPa" in words and any(word.endswith(" mm") for word in words)


def test_product_held_from_all_sides_is_refused(solved):
    subject = laying.gather(bpy.context)
    count = len(subject.hand.mesh.vertices)
    subject.hand.mesh.attributes["contact_force_n"].data.foreach_set("value", np.ones(count, np.float32))
    with pytest.raises(Refusal, match="pressed from more than one side"):
        on_glass.draw(orders.Order(orders.GLASS, "x.png", **SMALL), subject, bpy.context)
