"""Mats and instrument effects in Python: force kept, what a set-up shows, energy lost in cycles, and refusals."""

import numpy as np
import pytest
import thenar
from proof import meshes

PITCH, SIDE = 3.0, 5
BALL = (8.0, (0.0, 0.0, 8.0), 6.0, 0.5)


def grid():
    steps = PITCH * (np.arange(SIDE) - 0.5 * (SIDE - 1))
    x, y = np.meshgrid(steps, steps)
    return np.stack([x.ravel(), y.ravel(), np.zeros(SIDE**2)], axis=1)


@pytest.fixture(scope="module")
def mat():
    return thenar.Mat(
        grid(), np.full(SIDE**2, PITCH**2), normals=np.tile([0.0, 0.0, 1.0], (SIDE**2, 1)), along=(1, 0, 0)
    )


@pytest.fixture(scope="module")
def skin():
    return thenar.Skin(*meshes.disc_patch(8.0, 0.8), materials=thenar.Material.finger_layer())


@pytest.fixture(scope="module")
def course(skin):
    depth = 0.8 * np.sin(np.linspace(0.0, np.pi, 60)) - 1e-6
    protocol = {"time_s": 0.02 * np.arange(60), "depth_mm": depth}
    relaxation = [thenar.Effect("relaxation", 0.5)]
    return skin.run(protocol, *meshes.sphere(*BALL), direction=(0, 0, -1), effects=relaxation, keep="loads")


def test_the_catalogue_tells_instruments_from_tissue():
    kinds = {entry.name: entry.kind for entry in thenar.effects()}
    assert kinds["gain"] == kinds["misregistration"] == kinds["dead_cells"] == "instrument"
    assert kinds["bone"] == kinds["friction"] == "tissue"
    assert list(kinds.values()).count("instrument") == 10


def test_a_mat_reads_the_force_of_a_contact_wherever_force_control_took_the_product(skin, mat):
    vertices = np.asarray(meshes.disc_patch(8.0, 0.8)[0], float)
    contact = skin.press(*meshes.sphere(*BALL), force_n=0.2, direction=(0, 0, -1))
    frame = mat.read(contact, vertices)
    assert frame.shape == (len(mat),) and frame.argmax() == SIDE**2 // 2
    assert mat.force_n(frame) == pytest.approx(contact.force_n.sum(), rel=1e-9)
    assert mat.area_mm2(frame) >= contact.contact_area_mm2
    # A point in the middle of a sensel is read by that one alone: N over mm2 in kPa.
    assert mat.read(np.array([[0.0, 0.0, 0.0, 0.9, 1.0]]))[SIDE**2 // 2] == pytest.approx(1e3 * 0.9 / PITCH**2)


def test_a_set_up_shows_what_its_effects_make_of_a_course(course, mat):
    signals = {name: getattr(course, name) for name in ("time_s", "depth_mm", "force_n", "loads")}
    bare = thenar.observe(signals, mat)
    assert bare.frames_kpa.shape == (60, len(mat))
    totals = [mat.force_n(frame) for frame in bare.frames_kpa]
    np.testing.assert_allclose(totals, [load[:, 3].sum() for load in course.loads], rtol=1e-9, atol=1e-12)
    for entry in (entry for entry in thenar.effects() if entry.kind == "instrument"):
        off = thenar.observe(signals, mat, [thenar.Effect(entry.name, 0.0)])
        np.testing.assert_array_equal(off.frames_kpa, bare.frames_kpa)
        np.testing.assert_array_equal(off.depth_mm, bare.depth_mm)
    shown = thenar.observe(signals, mat, [thenar.Effect("offset", offset_kpa=3.0), thenar.Effect("gain", error=0.5)])
    np.testing.assert_allclose(shown.frames_kpa, 1.5 * bare.frames_kpa + 3.0)
    fixture = thenar.Effect("fixture_compliance", compliance_mm_per_n=2.0)
    np.testing.assert_allclose(thenar.observe(signals, mat, [fixture]).depth_mm, course.depth_mm + 2.0 * course.force_n)
    moved = thenar.observe(signals, mat, [thenar.Effect("misregistration", shift_1_mm=PITCH)])
    inside = np.arange(SIDE**2).reshape(SIDE, SIDE)[:, : SIDE - 1].ravel()
    np.testing.assert_allclose(moved.frames_kpa[:, inside], bare.frames_kpa[:, inside + 1], atol=1e-9)


def test_a_closed_cycle_tells_the_energy_it_lost(course):
    (cycle,) = course.cycles
    work = np.concatenate(
        [[0.0], np.cumsum(0.5 * (course.force_n[1:] + course.force_n[:-1]) * np.diff(course.offset_mm))]
    )
    off = np.flatnonzero(course.force_n <= 1e-4 * course.force_n.max())
    end = off[off > course.force_n.argmax()][0]
    assert cycle.loss_mj == pytest.approx(work[end], rel=1e-9) and cycle.work_mj == pytest.approx(work.max(), rel=1e-9)
    assert 0.1 < cycle.loss_share < 0.5 and cycle.end_s == pytest.approx(course.time_s[end])


def test_what_mats_and_set_ups_refuse(mat, skin):
    with pytest.raises(thenar.MeshError, match="mat: sensel 1 has an area of 0 mm2; give one above 0"):
        thenar.Mat(grid(), np.where(np.arange(SIDE**2) == 1, 0.0, 9.0))
    with pytest.raises(thenar.SolveError, match="effect bone: it acts on the skin, not on readings"):
        thenar.observe({"time_s": [0.0]}, effects=[thenar.Effect("bone")])
    with pytest.raises(thenar.SolveError, match="effect gain: it acts on readings, not on the skin"):
        skin.set_effects([thenar.Effect("gain")])
    with pytest.raises(thenar.SolveError, match='there is no channel "force"; there are time_s, depth_mm'):
        thenar.observe({"time_s": [0.0], "force": [1.0]})
    with pytest.raises(thenar.SolveError, match="frames or loads, but no mat"):
        thenar.observe({"time_s": [0.0], "loads": [np.zeros((0, 5))]})
    with pytest.raises(thenar.SolveError, match="frames_kpa: expected an .1, 25. array"):
        thenar.observe({"time_s": [0.0], "frames_kpa": [[1.0, 2.0]]}, mat)
    with pytest.raises(thenar.SolveError, match="vertices_mm: missing"):
        mat.read(skin.press(*meshes.sphere(*BALL)))
    for entry in (entry for entry in thenar.effects() if entry.kind == "instrument"):
        for number in entry.shape:
            effect = thenar.Effect(entry.name, 0.5, **{number.name: np.nextafter(number.low, -np.inf)})
            with pytest.raises(thenar.SolveError, match=f"effect {entry.name}: {number.name} is .*, but must be"):
                thenar.observe({"time_s": [0.0]}, mat, [effect])
