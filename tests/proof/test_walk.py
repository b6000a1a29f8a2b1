"""A protocol followed row by row: the same as in one go, in moving frames too, and what is refused."""

import numpy as np
import pytest
import thenar

from proof import meshes

ROWS = [dict(offset_mm=0.1 * k) for k in range(6)] + [dict(force_n=0.05)] * 4
EFFECTS = [thenar.Effect("relaxation", 0.6), thenar.Effect("friction", 1.0)]


@pytest.fixture
def scene():
    vertices, triangles = meshes.disc_patch(8.0, 1.0)
    skin = thenar.Skin(vertices, triangles, materials=thenar.Material.finger_layer(), effects=EFFECTS)
    ball = meshes.sphere(8.0, (0.0, 0.0, 8.0), 6.0, 0.8)
    return skin, np.asarray(vertices, float), thenar.Product(*ball)


def turned(angle, shift):
    motion = np.eye(4)
    motion[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    motion[:3, 3] = shift
    return motion


def test_rows_one_by_one_are_the_protocol(scene):
    skin, _, ball = scene
    times, slide = 0.1 * np.arange(len(ROWS)), np.outer(np.arange(len(ROWS)), [0.02, 0.0, 0.0])
    columns = {name: np.array([row.get(name, np.nan) for row in ROWS]) for name in ("offset_mm", "force_n")}
    whole = skin.run(dict(time_s=times, slide_mm=slide, **columns), ball, direction=(0, 0, -1))
    walk = skin.start(ball, direction=(0, 0, -1))
    for time, row, along in zip(times, ROWS, slide, strict=True):
        contact = walk.advance(time, slide_mm=along, **row)
        skin.press(ball)
    assert walk.rows == len(ROWS) and walk.time_s == times[-1]
    assert walk.offset_mm == pytest.approx(whole.offset_mm[-1], abs=1e-4)
    assert walk.slip_loss_mj == pytest.approx(whole.slip_loss_mj[-1], rel=1e-3)
    np.testing.assert_allclose(contact.pressure_mpa, whole.last.pressure_mpa, atol=1e-4 * whole.last.pressure_mpa.max())
    np.testing.assert_allclose(contact.displacement_mm, whole.last.displacement_mm, atol=1e-4)


def test_a_hand_that_carries_the_product_along_feels_nothing(scene):
    skin, vertices, ball = scene
    still, moving = skin.start(ball, direction=(0, 0, -1)), skin.start(ball, direction=(0, 0, -1))
    for k, row in enumerate(ROWS):
        motion = turned(0.3 * k, (5.0 * k, -2.0, 1.0))
        turn, shift = motion[:3, :3], motion[:3, 3]
        a = still.advance(0.1 * k, **row)
        b = moving.advance(0.1 * k, vertices @ turn.T + shift, motion, **row)
        np.testing.assert_allclose(b.total_force_n, turn @ a.total_force_n, atol=1e-6)
        np.testing.assert_allclose(b.displacement_mm, a.displacement_mm @ turn.T, atol=1e-6)


def test_skin_that_is_held_relaxes_and_a_copy_goes_its_own_way(scene):
    skin, vertices, ball = scene
    walk = skin.start(ball)
    pressed = vertices + [0.0, 0.0, 0.8]
    first = walk.advance(0.0, pressed).force_n.sum()
    later = [walk.advance(time, pressed).force_n.sum() for time in (0.05, 0.5, 5.0)]
    assert first > later[0] > later[1] > later[2] > 0.3 * first
    other = walk.copy()
    assert other.advance(6.0, vertices - [0.0, 0.0, 2.0]).force_n.sum() == 0.0
    assert walk.rows == 4 and other.rows == 5


def test_what_a_walk_refuses(scene):
    skin, _, ball = scene
    walk = skin.start(ball, direction=(0, 0, -1))
    walk.advance(1.0, offset_mm=0.3)
    for arguments, message in [
        (dict(time_s=1.0), "row 1: time_s is 1, but must be finite and larger"),
        (dict(time_s=2.0, force_n=1.0, depth_mm=1.0), "more than one of offset_mm, depth_mm and force_n"),
        (dict(time_s=2.0, product_motion=2.0 * np.eye(4)), "product_motion: it is not a rotation with a translation"),
        (dict(time_s=2.0, product_motion=np.eye(3)), "product_motion: expected a .4, 4. matrix"),
        (dict(time_s=2.0, force_n=-1.0), "row 1: force_n is -1, but must be 0 or more"),
    ]:
        with pytest.raises(thenar.SolveError, match=message):
            walk.advance(**arguments)
    assert walk.rows == 1
    skin.set_effects([])
    with pytest.raises(thenar.SolveError, match="effects have changed since the walk began; begin anew"):
        walk.advance(2.0)
