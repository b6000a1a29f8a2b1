"""Where the map ends on a skin of 2.5 mm spacing, against Hertz' circle and against the same press on a finer mesh."""

import numpy as np
import pytest
import thenar
from proof import meshes, pressing
from thenar_blender.contact_fields import product_edge, skin_edge

WANTED_MM = 0.3
SPACING_MM = 2.5
FINE_COUNT = 12800
"""Vertices of the fine fingertip: a spacing of 0.31 mm, where the step from pressed to free vertices is the edge."""


def field(skin, product, material):
    """(points of the pressed skin, triangles, signed distance, pressure) of a press."""
    contact = pressing.press(skin, product, [material])
    prepared = thenar.Product(*product)
    points, pressure = skin[0] + contact.displacement_mm, np.asarray(contact.pressure_mpa)
    edge = skin_edge.signed_distance(points, skin[1], pressure, lambda p: prepared.gap_mm(p, cut_off_mm=10.0)["gap_mm"])
    assert ((edge > 0.0) == (pressure > 0.0)).all(), "all that is pressed is covered, and nothing else"
    return points, skin[1], edge, contact


def drawn(points, triangles, values):
    """Places (k, 3) on the zero of `values`, linear inside triangles as in a shader, and their weights (k,)."""
    places, weights = [], []
    for turn in range(3):
        corners = np.roll(triangles, turn, axis=1)
        a, b, c = values[corners].T
        alone = ((a > 0.0) != (b > 0.0)) & ((a > 0.0) != (c > 0.0))
        p, q, r = (points[corners[alone, k]] for k in range(3))
        a, b, c = a[alone, None], b[alone, None], c[alone, None]
        one, other = p + (q - p) * a / (a - b), p + (r - p) * a / (a - c)
        for share in (0.1, 0.5, 0.9):
            places.append(one + share * (other - one))
            weights.append(np.linalg.norm(other - one, axis=1))
    return np.concatenate(places), np.concatenate(weights)


def ending(points, pressure, angles):
    """Distance (k,) from the z axis at which a contact ends, by angle: the step that sorts its vertices best."""
    radius, upper, found = np.hypot(points[:, 0], points[:, 1]), points[:, 2] > 0.0, []
    turn = np.arctan2(points[:, 1], points[:, 0])
    for angle in angles:
        near = upper & (np.abs(radius * np.sin(turn - angle)) < 0.35) & (np.cos(turn - angle) > 0.0)
        inner, outer = radius[near & (pressure > 0.0)], radius[near & (pressure <= 0.0)]
        both = np.sort(np.concatenate([inner, outer]))
        steps = 0.5 * (both[1:] + both[:-1])
        wrong = np.array([(inner > step).sum() + (outer < step).sum() for step in steps])
        found.append(steps[wrong == wrong.min()].mean())
    return np.array(found)


def spread(deviations, weights):
    return np.average(deviations, weights=weights), np.sqrt(np.average(deviations**2, weights=weights))


@pytest.mark.parametrize(("radius", "reach"), [(40.0, 3.5), (60.0, 5.0), (60.0, 8.0), (200.0, 12.0)])
def test_the_edge_of_a_ball_on_a_half_space_is_hertz_circle(radius, reach):
    """Contacts 3 to 10 spacings across, on six meshes each."""
    off, weights, midway = [], [], []
    for seed in range(6):
        depth = reach**2 / radius
        skin = meshes.disc_patch(max(2.2 * reach, 14.0), SPACING_MM, 0.15, seed)
        ball = meshes.sphere(radius, (0.0, 0.0, radius - depth), 1.5 * reach, 0.4)
        points, triangles, edge, _ = field(skin, ball, pressing.material())
        places, weight = drawn(points, triangles, edge)
        off.append(np.hypot(places[:, 0], places[:, 1]) - reach)
        weights.append(weight)
        places, _ = drawn(points, triangles, np.sign(edge))
        midway.append(np.hypot(places[:, 0], places[:, 1]) - reach)
    mean, rms = spread(np.concatenate(off), np.concatenate(weights))
    plain = np.sqrt(np.mean(np.concatenate(midway) ** 2))
    print(
        f"ball of {radius:g} mm, contact radius {reach:g}: mean {mean:+.3f}, rms {rms:.3f} mm; halfway {plain:.3f} mm"
    )
    assert rms <= WANTED_MM and plain > 2.0 * rms


def test_the_field_is_as_steep_as_a_distance_on_both_sides_of_the_edge():
    """So that a line along it is equally wide everywhere."""
    reach, steep = 8.0, []
    for seed in range(4):
        skin = meshes.disc_patch(20.0, SPACING_MM, 0.15, seed)
        ball = meshes.sphere(60.0, (0.0, 0.0, 60.0 - reach**2 / 60.0), 12.0, 0.4)
        points, triangles, edge, _ = field(skin, ball, pressing.material())
        a, b, c = points[triangles].swapaxes(0, 1)
        fa, fb, fc = edge[triangles].T
        crosses = (np.sign(edge)[triangles].min(axis=1) < 0.0) & (np.sign(edge)[triangles].max(axis=1) > 0.0)
        both = np.stack([b - a, c - a], axis=1)[crosses][:, :, :2]
        slope = np.linalg.solve(both, np.stack([fb - fa, fc - fa], axis=1)[crosses][..., None])[..., 0]
        steep.append(np.linalg.norm(slope, axis=1))
    low, middle, high = np.percentile(np.concatenate(steep), [2, 50, 98])
    assert low > 0.9 and 0.96 < middle < 1.05 and high < 1.2


TOOLS = {
    "plate": lambda top: meshes.box((-30.0, -30.0, top), (30.0, 30.0, top + 20.0)),
    "cylinder": lambda top: pressing.cylinder_over(top, 24.0, 80.0),
    "ball": lambda top: meshes.sphere(15.0, (0.0, 0.0, top + 15.0), 12.0, 0.5),
}
AXES = np.array([8.0, 12.0, 7.0])


@pytest.mark.parametrize("tool", TOOLS)
@pytest.mark.parametrize("depth", [0.6, 1.5, 2.5])
def test_the_edge_on_a_fingertip_is_that_of_a_finer_mesh(tool, depth):
    """An ellipsoid of a finger's layer on bone; the coarse mesh has its vertices on it too, in three ways."""
    product, finger = TOOLS[tool](AXES[2] - depth), thenar.Material.finger_layer()
    points, _, _, contact = field(meshes.ellipsoid(AXES, FINE_COUNT), product, finger)
    angles = np.linspace(-np.pi, np.pi, 96, endpoint=False)
    truth = ending(points, np.asarray(contact.pressure_mpa), angles)
    off, weights = [], []
    for turn in range(3):
        way = meshes.rotation((1.0, 0.3 * turn, 0.5), 0.4 * turn + 0.2)
        unit, triangles = meshes.convex_mesh(meshes.fibonacci_sphere(200) @ way.T)
        points, triangles, edge, _ = field((unit * AXES, triangles), product, finger)
        places, weight = drawn(points, triangles, edge)
        angle = np.arctan2(places[:, 1], places[:, 0])
        off.append(np.hypot(places[:, 0], places[:, 1]) - np.interp(angle, angles, truth, period=2.0 * np.pi))
        weights.append(weight)
    mean, rms = spread(np.concatenate(off), np.concatenate(weights))
    print(
        f"{tool}, {depth} mm: mean {mean:+.3f}, rms {rms:.3f} mm; contact radius {truth.min():.1f} to {truth.max():.1f}"
    )
    assert rms <= WANTED_MM


@pytest.mark.parametrize("spacing", [1.8, 3.7])
def test_the_edge_on_a_product_is_that_of_the_skin(spacing):
    """A ball, whose map ends on Hertz' circle too, between its own vertices."""
    radius, reach = 60.0, 8.0
    depth = reach**2 / radius
    skin = meshes.disc_patch(2.2 * reach, SPACING_MM, 0.15, 3)
    ball = meshes.sphere(radius, (0.0, 0.0, radius - depth), 1.5 * reach, 0.4)
    points, triangles, edge, _ = field(skin, ball, pressing.material())
    shown = meshes.sphere(radius, (0.0, 0.0, radius - depth), 2.5 * reach, spacing)
    across = np.hypot(shown[0][:, 0], shown[0][:, 1])
    pressure = np.where((across < reach + 3.0) & (shown[0][:, 2] < radius / 2.0), 1.0, 0.0)  # spread as the library's
    laid = product_edge.signed_distance((points, triangles, edge), (*shown, pressure), thenar.Product)
    places, weight = drawn(*shown, laid)
    mean, rms = spread(np.hypot(places[:, 0], places[:, 1]) - reach, weight)
    print(f"product of {spacing} mm: mean {mean:+.3f}, rms {rms:.3f} mm")
    assert rms <= WANTED_MM


def test_without_gaps_the_pressure_alone_places_the_edge():
    skin = meshes.disc_patch(20.0, SPACING_MM, 0.15, 1)
    points, triangles, _, contact = field(
        skin, meshes.sphere(60.0, (0.0, 0.0, 60.0 - 64.0 / 60.0), 12.0, 0.4), pressing.material()
    )
    places, weight = drawn(points, triangles, skin_edge.signed_distance(points, triangles, contact.pressure_mpa))
    _, rms = spread(np.hypot(places[:, 0], places[:, 1]) - 8.0, weight)
    assert rms <= WANTED_MM


def test_skin_without_contact_or_all_in_contact_has_no_edge():
    points, triangles = meshes.disc_patch(10.0, SPACING_MM)
    free, pressed = np.zeros(len(points)), np.ones(len(points))
    assert (skin_edge.signed_distance(points, triangles, free) == -skin_edge.REACH_MM).all()
    assert (skin_edge.signed_distance(points, triangles, pressed) == skin_edge.REACH_MM).all()
    nothing = (points, triangles, np.full(len(points), -skin_edge.REACH_MM))
    laid = product_edge.signed_distance(nothing, (points, triangles, free), thenar.Product)
    assert (laid == -skin_edge.REACH_MM).all()


@pytest.mark.parametrize("gap", [None, np.nan, np.inf, -1.0, 0.0, 1e-9])
def test_one_pressed_vertex_and_gaps_that_say_nothing_leave_the_edge_between_it_and_its_neighbors(gap):
    points, triangles = meshes.disc_patch(10.0, SPACING_MM)
    middle = int(np.hypot(points[:, 0], points[:, 1]).argmin())
    pressure = np.zeros(len(points))
    pressure[middle] = 0.03
    gaps = None if gap is None else lambda asked: np.full(len(asked), gap)
    edge = skin_edge.signed_distance(points, triangles, pressure, gaps)
    assert np.isfinite(edge).all() and ((edge > 0.0) == (pressure > 0.0)).all()
    assert 0.0 < edge[middle] < 2.0 * SPACING_MM


def test_points_that_coincide_leave_the_edge_finite():
    points, triangles = meshes.disc_patch(10.0, SPACING_MM)
    pressure = np.maximum(5.0 - np.hypot(points[:, 0], points[:, 1]), 0.0)
    squeezed = points * [1.0, 0.0, 0.0]
    squeezed[::3] = squeezed[0]
    edge = skin_edge.signed_distance(squeezed, triangles, pressure, lambda asked: np.full(len(asked), 0.1))
    assert np.isfinite(edge).all() and ((edge > 0.0) == (pressure > 0.0)).all()
