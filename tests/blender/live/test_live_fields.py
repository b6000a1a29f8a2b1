"""Live: fields, colors and numbers that are written frame by frame are those of the last press, as a whole."""

import bpy
import numpy as np
import stage
from thenar_blender import names
from thenar_blender.live import session, watch
from thenar_blender.skin_display import colors

MM = stage.MM


def follow():
    """What the timer does in a window; background has no timers."""
    bpy.context.view_layer.update()
    return watch.follow_now(bpy.context)


def switch_on():
    bpy.context.scene.thenar.live = True


def force():
    return bpy.context.scene.thenar.result.force_n


def test_colors_that_follow_are_those_of_the_pressure_as_a_whole(scene):
    """Only what changed is colored anew: a slide, a tilt, a jump away and a jump back leave no old color.

    The hand moves: all is colored anew where the product does.
    """
    hand, product = stage.scene()
    settings = bpy.context.scene.thenar
    switch_on()
    for move in (0.3, -0.2, 0.0, -9.0, 9.5):
        hand.location.z -= move * MM
        hand.location.x -= 0.4 * MM
        hand.rotation_euler.y -= 0.02
        assert follow()
        for obj, bare in ((hand, colors.SKIN), (product, colors.BARE)):
            whole = colors.linear((stage.attribute(obj, names.PRESSURE_KPA), None), settings, colors.ground(obj, bare))
            assert np.abs(stage.attribute(obj, names.COLOR) - whole).max() < 1e-5
    assert force() > 0.0


def test_every_field_and_number_is_that_of_the_last_press(scene, monkeypatch):
    """Whatever is written in part, kept or converted: fields, their places and the rows are those of the contact."""
    hand, product = stage.scene()
    pressed, press = [], session._press
    monkeypatch.setattr(session, "_press", lambda *given: pressed.append(press(*given)) or pressed[-1])
    switch_on()
    result, single = scene.thenar.result, np.float32
    for move, turn in ((0.3, 0.0), (-0.2, 0.3), (0.0, 0.3), (-9.0, 0.0), (9.4, -0.2)):
        product.location.z += move * MM
        product.location.x += 0.3 * MM
        hand.rotation_euler.z += turn
        assert follow()
        contact = pressed[-1]
        written = {name: stage.attribute(hand, name) for name in names.HAND_ATTRIBUTES if name in hand.data.attributes}
        assert np.array_equal(written[names.FORCE_N], contact.force_n.astype(single))
        assert np.array_equal(written[names.PRESSURE_KPA], (1e3 * contact.pressure_mpa).astype(single))
        assert np.array_equal(written[names.DEPTH_MM], np.maximum(-contact.gap_mm, 0.0).astype(single))
        assert np.array_equal(written[names.DISPLACEMENT_MM], contact.displacement_mm.astype(single))
        turned = stage.attribute(hand, names.LIVE_OFFSET) @ np.array(hand.matrix_world)[:3, :3].T / MM
        assert np.abs(turned - contact.displacement_mm).max() < 1e-5
        assert np.array_equal(
            stage.attribute(product, names.PRESSURE_KPA), (1e3 * contact.product_pressure_mpa).astype(single)
        )
        for row, record in zip(result.regions, contact.regions, strict=True):
            numbers = row.force_n, row.area_mm2, row.peak_kpa, row.mean_kpa, row.depth_mm, row.shear_modulus_kpa
            mpa = record.peak_mpa, record.mean_mpa, record.g_mpa
            peak, mean, modulus = (1e3 * number for number in mpa)
            wanted = record.force_n, record.area_mm2, peak, mean, max(record.dmax_mm, 0.0), modulus
            assert numbers == tuple(float(single(number)) for number in wanted)
        assert result.force_n == single(contact.force_n.sum())
        assert result.peak_kpa == single(1e3 * contact.pressure_mpa.max())
    assert force() > 0.0
