"""Deep tissue by the thickness where it is pressed: painted bone far away changes nothing, and a border is no step."""

import numpy as np
import pytest
import thenar

SPACING_MM, HALF_MM = 1.0, 16.0


def slab():
    """A square of skin facing +z."""
    line = np.arange(-HALF_MM, HALF_MM + 0.5 * SPACING_MM, SPACING_MM)
    x, y = np.meshgrid(line, line, indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    index = np.arange(x.size).reshape(x.shape)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    return vertices, np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])


def ball(radius, depth):
    """A ball over the middle, its lowest point at z = -`depth`."""
    turn, height = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 65)[:-1], np.linspace(0.0, np.pi, 49)[1:-1])
    ring = np.stack([np.sin(height) * np.cos(turn), np.sin(height) * np.sin(turn), -np.cos(height)], axis=-1)
    points = np.concatenate([ring.reshape(-1, 3), [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]])
    rings, around = turn.shape
    k = np.arange(rings * around).reshape(rings, around)
    a, b = k[:-1], np.roll(k[:-1], -1, axis=1)
    c, d = np.roll(k[1:], -1, axis=1), k[1:]
    sides = [np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))]
    low, high = rings * around, rings * around + 1
    caps = [np.stack([np.roll(k[0], -1), k[0], np.full(around, low)], -1)]
    caps.append(np.stack([k[-1], np.roll(k[-1], -1), np.full(around, high)], -1))
    return radius * points + [0.2, 0.1, radius - depth], np.concatenate([*sides, *caps])


def force(contact):
    return float(np.linalg.norm(contact.total_force_n))


@pytest.mark.parametrize("elsewhere_mm", [8.0, 16.0, 60.0])
def test_bone_that_is_painted_elsewhere_changes_little(elsewhere_mm):
    vertices, triangles = slab()
    tissue = thenar.Material.finger_layer().replace(thickness_mm=4.0)
    far = np.hypot(vertices[:, 0], vertices[:, 1]) > 9.0
    painted = thenar.Effect("bone", 1.0, painted=np.where(far, elsewhere_mm, 4.0))
    even = thenar.Skin(vertices, triangles, materials=tissue).press(*ball(6.0, 1.8))
    found = thenar.Skin(vertices, triangles, materials=tissue, effects=[painted]).press(*ball(6.0, 1.8))
    assert force(found) == pytest.approx(force(even), rel=0.02)


def test_the_warning_reads_the_thickness_under_the_press():
    vertices, triangles = slab()
    tissue = thenar.Material.finger_layer().replace(thickness_mm=4.0)
    far = np.hypot(vertices[:, 0], vertices[:, 1]) > 9.0
    painted = thenar.Effect("bone", 1.0, painted=np.where(far, 16.0, 4.0))
    found = thenar.Skin(vertices, triangles, materials=tissue, effects=[painted]).press(*ball(6.0, 3.0))
    assert any("over half its 4.0" in warning for warning in found.warnings), found.warnings


def test_a_border_of_two_thicknesses_is_no_step_of_pressure():
    vertices, triangles = slab()
    thin = thenar.Material.finger_layer().replace(thickness_mm=6.0)
    regions = (vertices[:, 0] > 0.0).astype(np.int32)
    found = thenar.Skin(vertices, triangles, regions=regions, materials=[thin, thin.replace(thickness_mm=7.1)])
    row = np.asarray(found.press(*ball(12.0, 3.0)).pressure_mpa).reshape(33, 33)[:, 16]
    steps = row[15:18] / row[16:19]
    print(np.round(1e3 * row[12:21], 1))
    assert np.abs(np.log(steps)).max() < 0.2, "a row's neighbors are within 20 %"
