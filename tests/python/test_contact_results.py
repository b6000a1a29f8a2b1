"""The result of a press in Python: every public attribute, shapes, units and balances counted anew with numpy."""

import json
import multiprocessing
import threading

import numpy as np
import pressing_shapes as shapes
import pytest
import thenar

VERTICES, TRIANGLES = shapes.sheet(15, 1.0, 0.2)
BALL = shapes.ball(8.0, (0, 0, 7.2), 24)
REGIONS = np.where(VERTICES[:, 0] < 0, 0, 1)
COUNT = len(VERTICES)


@pytest.fixture(scope="module")
def skin():
    return thenar.Skin(VERTICES, TRIANGLES, REGIONS, thenar.Material(thickness_mm=6), region_names=["left", "right"])


@pytest.fixture(scope="module")
def contact(skin):
    return skin.press(*BALL)


def test_every_public_attribute_has_its_shape(contact):
    expected = {
        "displacement_mm": (COUNT, 3),
        "pressure_mpa": (COUNT,),
        "force_n": (COUNT,),
        "gap_mm": (COUNT,),
        "in_contact": (COUNT,),
        "product_normal": (COUNT, 3),
        "total_force_n": (3,),
        "total_moment_nmm": (3,),
        "center_of_pressure_mm": (3,),
        "direction": (3,),
        "product_pressure_mpa": (len(BALL[0]),),
    }
    for name, shape in expected.items():
        array = getattr(contact, name)
        assert isinstance(array, np.ndarray) and array.shape == shape and array.flags.c_contiguous, name
        assert array.dtype == (bool if name == "in_contact" else np.float64), name
        assert name == "gap_mm" or np.isfinite(array).all(), name
    for name in ["contact_area_mm2", "peak_pressure_mpa", "mean_pressure_mpa", "patch_peak_mpa", "offset_mm"]:
        assert isinstance(getattr(contact, name), float)
    assert all(isinstance(sentence, str) for sentence in contact.warnings)
    assert contact.seconds and all(time >= 0 for time in contact.seconds.values())
    assert set(contact.residual) == {"complementarity", "penetration_mm", "load_balance", "far_field"}
    assert "N on" in repr(contact)


def test_what_is_asked_for_is_made_once_and_stays_as_pressed(skin, contact):
    """Arrays and records are made when they are asked for, be it late and in any order, whatever was done since."""
    names = [name for name in dir(thenar.Contact) if not name.startswith("_")]
    early = {name: getattr(contact, name) for name in names}
    late = skin.press(*BALL)
    skin.press(BALL[0] + (0, 0, 0.3), BALL[1])
    late.force_n[:] = -1.0
    assert np.array_equal(late.in_contact, contact.in_contact), "what was written to one array is in no other"
    for name in sorted(set(names) - {"force_n", "seconds"}, reverse=True):
        made = getattr(late, name)
        assert isinstance(made, float) or getattr(late, name) is made, name
        if isinstance(made, np.ndarray):
            assert made.flags.writeable and made.dtype == early[name].dtype, name
            assert np.array_equal(made, early[name], equal_nan=made.dtype == float), name
        else:
            assert made == early[name], name
    assert np.all(late.force_n == -1.0), "an array that was written to stays as it is"
    with pytest.raises(AttributeError):
        late.force_n = contact.force_n


def test_threads_that_ask_at_once_get_the_same_array(skin):
    made = skin.press(*BALL)
    found, barrier = [], threading.Barrier(8)

    def ask():
        barrier.wait()
        found.append(made.displacement_mm)

    threads = [threading.Thread(target=ask) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 8 and all(array is found[0] for array in found)


def test_numbers_agree_with_each_other(contact):
    touched = contact.in_contact
    assert touched.any() and not touched.all()
    assert np.array_equal(touched, contact.force_n > 0)
    area = shapes.vertex_areas(VERTICES, TRIANGLES)
    assert np.allclose(contact.pressure_mpa * area, contact.force_n, rtol=1e-9, atol=1e-15)
    assert contact.peak_pressure_mpa == contact.pressure_mpa.max()
    assert contact.contact_area_mm2 == pytest.approx(area[touched].sum(), rel=0.1)
    assert contact.mean_pressure_mpa == pytest.approx(contact.force_n.sum() / contact.contact_area_mm2)
    assert contact.mean_pressure_mpa <= contact.patch_peak_mpa <= contact.peak_pressure_mpa
    on_product = shapes.vertex_areas(*BALL) @ contact.product_pressure_mpa
    assert on_product == pytest.approx(contact.force_n.sum(), rel=1e-9)
    pushed = (contact.force_n[:, None] * contact.product_normal).sum(axis=0)
    assert np.allclose(np.abs(contact.total_force_n), np.abs(pushed), atol=1e-12)
    assert np.all(contact.gap_mm[touched & (contact.gap_mm < 0)] < 0)


def test_records_of_regions_add_up(contact):
    assert [(row.index, row.name) for row in contact.regions] == [(0, "left"), (1, "right")]
    for row in contact.regions:
        assert {"force_n", "area_mm2", "peak_mpa", "mean_mpa", "dmax_mm", "g_mpa"} <= set(row)
        assert row.force_n == row["force_n"] == pytest.approx(contact.force_n[row.index == REGIONS].sum())
        assert row.peak_mpa == contact.pressure_mpa[row.index == REGIONS].max()
    assert json.loads(json.dumps(contact.regions)) == contact.regions
    with pytest.raises(AttributeError, match="has no 'force'; it has index, name, force_n"):
        _ = contact.regions[0].force
    assert not hasattr(contact.residual, "nothing")


def test_force_control_reaches_its_force(skin):
    contact = skin.press(*BALL, force_n=0.5, direction=(0, 0, -2))
    assert abs(contact.total_force_n[2]) == pytest.approx(0.5, rel=1e-3)
    assert np.allclose(contact.direction, (0, 0, -1))
    moved = skin.press(BALL[0] + contact.offset_mm * contact.direction, BALL[1])
    assert moved.force_n.sum() == pytest.approx(contact.force_n.sum(), rel=1e-3)


def test_no_contact_is_a_result(skin):
    contact = skin.press(BALL[0] + (0, 0, 100), BALL[1])
    assert not contact.in_contact.any() and contact.contact_area_mm2 == 0 and not contact.displacement_mm.any()


def test_vertices_without_skin_carry_nothing():
    regions = np.where(VERTICES[:, 0] < 0, -1, 0)
    contact = thenar.Skin(VERTICES, TRIANGLES, regions).press(*BALL)
    assert not contact.in_contact[regions < 0].any() and contact.in_contact[regions == 0].any()


def test_same_bits_every_time_and_with_a_reused_product(skin, contact):
    fresh = thenar.Skin(VERTICES, TRIANGLES, REGIONS, thenar.Material(thickness_mm=6))
    for again in [
        fresh.press(*BALL),
        thenar.Skin(VERTICES, TRIANGLES, REGIONS, thenar.Material(thickness_mm=6)).press(*BALL),
    ]:
        assert np.array_equal(again.displacement_mm, contact.displacement_mm)


def test_one_skin_serves_many_threads(skin):
    shifts = np.linspace(0, 0.3, 8)
    alone = [skin.press(BALL[0] - (0, 0, shift), BALL[1]).force_n.sum() for shift in shifts]
    found = [None] * len(shifts)

    def work(number):
        found[number] = skin.press(BALL[0] - (0, 0, shifts[number]), BALL[1]).force_n.sum()

    threads = [threading.Thread(target=work, args=(number,)) for number in range(len(shifts))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == pytest.approx(alone, rel=1e-6)


def _press_in_child(skin, queue):
    queue.put(float(skin.press(*BALL).force_n.sum()))


def test_a_forked_child_can_press(skin, contact):
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=_press_in_child, args=(skin, queue))
    child.start()
    try:
        assert queue.get(timeout=60) == pytest.approx(contact.force_n.sum(), rel=1e-6)
    finally:
        child.join(10)
        child.kill()


def test_distances_to_a_product():
    product = thenar.Product(*shapes.ball(5.0, (0, 0, 0), 48))
    points = np.array([[0, 0, 9.0], [0, 0, 4.0], [0, 30.0, 0]])
    found = product.gap_mm(points, cut_off_mm=10)
    assert np.allclose(found["gap_mm"][:2], [4, -1], atol=0.03) and np.isinf(found["gap_mm"][2])
    assert np.allclose(found["closest_mm"][:2], [[0, 0, 5]] * 2, atol=0.03)
    assert np.allclose(found["normal"][:2], [[0, 0, 1]] * 2, atol=0.05) and np.isnan(found["normal"][2]).all()
    assert found["triangle"][2] == -1 and (found["triangle"][:2] >= 0).all()
    assert np.isfinite(product.gap_mm(points)["gap_mm"]).all()
    assert (product.vertex_count, product.triangle_count) == (
        len(shapes.ball(rings=48)[0]),
        len(shapes.ball(rings=48)[1]),
    )
    with pytest.raises(thenar.MeshError, match="^skin_normals: 1 rows for 3 points"):
        product.gap_mm(points, skin_normals=[[0, 0, 1.0]])
    with pytest.raises(thenar.MeshError, match="^cut_off_mm: -1 is negative"):
        product.gap_mm(points, cut_off_mm=-1)
    assert product.gap_mm(np.zeros((0, 3)))["gap_mm"].shape == (0,)


def test_the_build_tells_what_it_is():
    info = thenar.build_info()
    assert info.version == thenar.__version__ and info.abi == "abi3-py311" and info.threads >= 1
