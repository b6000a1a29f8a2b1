"""A virtual mat around a cylinder: closed forms of a rectangle, binning that shares no code with it, and refusals."""

import bpy
import numpy as np
import pytest
import stage
from thenar_blender.hand import products
from thenar_blender.recordings import table_6, virtual_mat
from thenar_blender.scene.checks import Refusal

RADIUS = 30.0
PITCH = 10.0 / np.sqrt(4.2)
AROUND = 2.0 * np.pi * RADIUS / 39
"""188.5 mm around hold 38.6 sensels: 39 of nearly the pitch close the mat."""
STEP = 0.4
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
SHIFT = np.array([120.0, -45.0, 80.0])


def triangles(faces):
    """Polygons as fans."""
    return np.array([(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)])


def field(pressure_kpa, arc=(-60.0, 60.0), height=(-50.0, 50.0)):
    """Unrolled places, arc and height, mm, and forces, N, of `pressure_kpa(arc, height)` on small squares."""
    sides = [np.arange(low + 0.5 * STEP, high, STEP) for low, high in (arc, height)]
    x, y = (grid.ravel() for grid in np.meshgrid(*sides, indexing="ij"))
    force = 1e-3 * STEP**2 * pressure_kpa(x, y)
    return x[force > 0.0], y[force > 0.0], force[force > 0.0]


def wrapped(unrolled, load_mm2=STEP**2):
    """The same as loads on a cylinder that is turned and shifted in space, and that cylinder as the module finds it."""
    arc, height, force = unrolled
    places = np.stack([RADIUS * np.cos(arc / RADIUS), RADIUS * np.sin(arc / RADIUS), height], axis=1) @ TURN.T + SHIFT
    vertices, faces = products.cylinder(2.0 * RADIUS, 160.0)
    corners = triangles(faces) if np.linalg.det(TURN) > 0.0 else triangles(faces)[:, ::-1]
    found = virtual_mat.cylinder_of("Rod", np.asarray(vertices) @ TURN.T + SHIFT, corners, places)
    return found, np.column_stack([places, force, np.full(len(force), load_mm2)])


def binned(unrolled, threshold_kpa, count):
    """Area, mean and peak by sorting places into cells alone, at `count` random placements of the mat."""
    arc, height, force = unrolled
    out = []
    for shift in np.random.default_rng(8).uniform(size=(count, 2)):
        column = np.floor(arc / AROUND + shift[0]).astype(int) % 39
        row = np.floor(height / PITCH + shift[1]).astype(int)
        cells = np.bincount(column + 39 * (row - row.min()), force) / (PITCH * AROUND) * 1e3
        loaded = cells[cells > threshold_kpa]
        out.append((len(loaded) * PITCH * AROUND, loaded.mean(), cells.max(), loaded.sum() * PITCH * AROUND / 1e3))
    return np.array(out)


def bumps(arc, height):
    """Two pads with pressure falling off at their rims, and a faint one."""
    pads = ((-20.0, -8.0, 14.0, 90.0), (6.0, 14.0, 9.0, 160.0), (14.0, -22.0, 12.0, 6.0))
    return sum(peak * np.fmax(1.0 - ((arc - x) ** 2 + (height - y) ** 2) / r**2, 0.0) for x, y, r, peak in pads)


def test_a_rectangle_reads_its_force_and_as_many_sensels_as_it_may_touch():
    wide, tall, pressure = 40.0, 24.0, 20.0
    rectangle = field(np.vectorize(lambda x, y: pressure), (-0.5 * wide, 0.5 * wide), (-0.5 * tall, 0.5 * tall))
    read = virtual_mat.reading("Rod", *wrapped(rectangle))
    touched = read["rows"][0]
    np.testing.assert_allclose(touched["force_n"], wide * tall * pressure / 1e3, rtol=1e-9)
    # A length b meets b / pitch + 1 sensels on average: area + perimeter x pitch / 2 + pitch² for a rectangle.
    assert touched["area_mm2"][1] == pytest.approx((wide + AROUND) * (tall + PITCH), rel=0.02)
    fewest = np.ceil(wide / AROUND) * np.ceil(tall / PITCH) * AROUND * PITCH
    most = (np.ceil(wide / AROUND) + 1) * (np.ceil(tall / PITCH) + 1) * AROUND * PITCH
    assert fewest - 1e-6 <= touched["area_mm2"][0] < touched["area_mm2"][2] <= most + 1e-6
    # A sensel in its middle lies within the rectangle and reads its pressure.
    np.testing.assert_allclose(touched["peak_kpa"], pressure, rtol=1e-3)
    assert read["pitch_mm"] == pytest.approx((PITCH, AROUND), rel=1e-5)
    assert read["diameter_mm"] == pytest.approx(2.0 * RADIUS, rel=1e-5)


def test_pads_read_as_by_sorting_places_into_cells():
    unrolled = field(bumps)
    read = virtual_mat.reading("Rod", *wrapped(unrolled, 0.0))
    for row in read["rows"]:
        expected = binned(unrolled, row["threshold_kpa"], 1200)
        for column, name in enumerate(virtual_mat.QUANTITIES):
            least, mean, greatest = row[name]
            assert mean == pytest.approx(expected[:, column].mean(), rel=0.01), (row["threshold_kpa"], name)
            assert least >= 0.98 * expected[:, column].min() and greatest <= 1.02 * expected[:, column].max(), name
            assert least <= mean <= greatest and read["range"][name][0] <= least and greatest <= read["range"][name][1]
    assert [row["threshold_kpa"] for row in read["rows"]] == [0.0, 2.0, 5.0]


def test_the_mean_over_placements_is_the_same_wherever_the_mat_begins():
    """Which way the axis points, and so where the mat begins, is the linear algebra's choice, another one on another
    processor."""
    arc, height, force = field(bumps)
    means = []
    for shift in np.random.default_rng(5).uniform(size=(6, 2)) * [AROUND, PITCH]:
        read = virtual_mat.reading("Rod", *wrapped((arc + shift[0], height + shift[1], force), 0.0))
        means.append([read["rows"][0][name][1] for name in virtual_mat.QUANTITIES])
    assert (np.ptp(means, axis=0) < 0.015 * np.mean(means, axis=0)).all(), means


def test_a_threshold_only_lowers_area_and_force_and_raises_the_mean():
    rows = virtual_mat.reading("Rod", *wrapped(field(bumps)))["rows"]
    for low, high in zip(rows[:-1], rows[1:], strict=True):
        assert all(np.less_equal(high[name], low[name]).all() for name in ("area_mm2", "force_n"))
        assert high["area_mm2"][1] < low["area_mm2"][1] and high["mean_kpa"][1] > low["mean_kpa"][1]
        assert high["peak_kpa"] == low["peak_kpa"]


def test_a_patch_across_the_seam_reads_as_anywhere_else():
    here = virtual_mat.reading("Rod", *wrapped(field(bumps)))
    arc, height, force = field(bumps)
    for shift in (np.pi * RADIUS, 0.37 * RADIUS):
        there = virtual_mat.reading("Rod", *wrapped((arc + shift, height, force)))
        for name in virtual_mat.QUANTITIES:
            assert there["rows"][0][name][1] == pytest.approx(here["rows"][0][name][1], rel=0.01)


@pytest.mark.parametrize(
    "shape",
    [
        products.bottle(),
        products.grip(),
        products.plate(90.0, 70.0, 6.0),
        products.turned([(12.0, -60.0), (30.0, 60.0)]),
        products.turned([(30.0 * np.sin(a), -30.0 * np.cos(a)) for a in np.linspace(0.05, np.pi - 0.05, 40)]),
    ],
    ids=["bottle", "grip", "plate", "cone", "ball"],
)
def test_what_is_no_cylinder_is_refused_with_a_remedy(shape):
    vertices, faces = shape
    touched = np.asarray(vertices)[np.abs(np.asarray(vertices)[:, 2]) < 45.0]
    with pytest.raises(Refusal, match="'Thing' is no cylinder where it is touched: .* choose a cylinder as product"):
        virtual_mat.cylinder_of("Thing", vertices, triangles(faces), touched)


def test_a_disc_and_a_tube_are_cylinders_too():
    touched = np.array([[24.0, 0.0, -5.0], [0.0, 24.0, 5.0]])
    vertices, faces = products.cylinder(48.0, 20.0)
    assert virtual_mat.cylinder_of("Disc", vertices, triangles(faces), touched).radius_mm == pytest.approx(24.0)
    (outer, faces), (inner, hidden) = products.cylinder(48.0, 200.0), products.cylinder(40.0, 200.0)
    both = np.concatenate([outer, inner]), np.concatenate([triangles(faces), triangles(hidden)[:, ::-1] + len(outer)])
    assert virtual_mat.cylinder_of("Tube", *both, touched).radius_mm == pytest.approx(24.0)


def test_force_on_the_end_of_a_cylinder_is_refused():
    found, loads = wrapped(field(bumps))
    ends = np.tile([*found.point, 0.0, 1.0], (1, 1))
    ends[0, 3] = 0.5 * loads[:, 3].sum()
    with pytest.raises(Refusal, match="33% of the force acts outside the side .* 'Rod'.* grasp it between"):
        virtual_mat.reading("Rod", found, np.concatenate([loads, ends]))


@pytest.fixture
def pressed():
    """A soft ball of 8 mm held 1 mm deep in a rod of 48 mm."""
    vertices, faces = products.cylinder(48.0, 60.0)
    mesh = bpy.data.meshes.new("Rod")
    mesh.from_pydata((np.asarray(vertices) * stage.MM).tolist(), [], faces)
    rod = bpy.data.objects.new("Rod", mesh)
    bpy.context.scene.collection.objects.link(rod)
    rod.location, rod.rotation_euler = (0.0, 0.0, -31.0 * stage.MM), (np.pi / 2, 0.0, 0.3)
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = stage.pad(), rod
    bpy.context.view_layer.update()
    return settings


@pytest.mark.parametrize("force_n", [None, 0.4])
def test_a_scene_reads_its_force_on_more_area_than_the_skins(pressed, monkeypatch, force_n):
    given, reading = [], virtual_mat.reading
    monkeypatch.setattr(virtual_mat, "reading", lambda *asked: given.append(asked) or reading(*asked))
    if force_n is not None:
        pressed.use_force, pressed.force_n = True, force_n
    with pytest.raises(Refusal, match="no contact of this scene that a mat could read; press Solve first"):
        table_6.read_scene(bpy.context)
    result = stage.solve()
    read = table_6.read_scene(bpy.context)
    assert read["diameter_mm"] == pytest.approx(48.0, rel=1e-3)
    np.testing.assert_allclose(read["rows"][0]["force_n"], result.force_n, rtol=1e-5)
    assert read["rows"][0]["area_mm2"][0] > result.area_mm2 == read["skin"]["area_mm2"]
    assert read["rows"][0]["mean_kpa"][2] < result.mean_kpa and read["range"]["peak_kpa"][1] < result.peak_kpa
    (_, found, loads), *_ = given
    np.testing.assert_allclose(found.rolled(loads[:, :3])[2], 24.0, atol=0.02)  # on the rod as it lay before it moved
    assert 1e3 * (loads[:, 3] / loads[:, 4]).max() == pytest.approx(result.peak_kpa, rel=1e-4)
    pressed.hand.location.z += 0.5 * stage.MM
    bpy.context.view_layer.update()
    with pytest.raises(Refusal, match="press Solve first"):
        table_6.read_scene(bpy.context)


def test_the_table_names_skin_and_mat_apart(pressed):
    result = stage.solve()
    lines = {line[:26].strip(): line[28:].split() for line in table_6.lines(table_6.read_scene(bpy.context))}
    assert lines["measured (Xie Table 6)"] == ["102", "33.0", "165", "337"]
    assert lines["paper's simulation"] == ["115", "28.0", "165", "323"]
    assert lines["the skin itself, no mat"][1] == f"{result.mean_kpa:.1f}"
    assert {"sensels over 0 kPa", "sensels over 2 kPa", "sensels over 5 kPa", "over all thresholds"} <= set(lines)


def test_the_paper_has_no_row_for_other_diameters():
    assert table_6.measured(55.0) is None and table_6.measured(59.9)["area_mm2"][0] == pytest.approx(8966, abs=1)
