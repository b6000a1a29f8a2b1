"""Bad input through the Python module: a result or one clear sentence each, never a panic, never a hang."""

import faulthandler
import math

import numpy as np
import pytest
import thenar

from proof import meshes, pressing

SKIN = meshes.disc_patch(6.0, 1.0)
PLATE = meshes.box((-20, -20, -0.5), (20, 20, 20))


@pytest.fixture(autouse=True)
def no_hang():
    """Ends the process with every stack if one case takes two minutes."""
    faulthandler.dump_traceback_later(120, exit=True)
    yield
    faulthandler.cancel_dump_traceback_later()


def with_entry(mesh, row, value):
    vertices = mesh[0].copy()
    vertices[row, 1] = value
    return vertices, mesh[1]


def with_index(mesh, value):
    triangles = mesh[1].copy()
    triangles[3, 1] = value
    return mesh[0], triangles


EMPTY = (np.zeros((0, 3)), np.zeros((0, 3), np.int32))
ONE_VERTEX = (np.zeros((1, 3)), np.zeros((0, 3), np.int32))
REFUSED = {
    "NaN": lambda m: with_entry(m, 5, math.nan),
    "infinity": lambda m: with_entry(m, 5, math.inf),
    "empty": lambda m: EMPTY,
    "one vertex": lambda m: ONE_VERTEX,
    "no triangles": lambda m: (m[0], np.zeros((0, 3), np.int32)),
    "index out of range": lambda m: with_index(m, len(m[0])),
    "negative index": lambda m: with_index(m, -1),
    "only degenerate": lambda m: (m[0], np.repeat(m[1][:, :1], 3, axis=1)),
}


def sentence(error):
    """The message, after checking that it is one line of words and no panic."""
    text = str(error.value)
    assert 15 < len(text) < 400
    assert "\n" not in text
    assert "panic" not in text.lower()
    assert "unwrap" not in text
    return text


@pytest.mark.parametrize("name", REFUSED)
def test_refused_skin(name):
    with pytest.raises(thenar.ThenarError) as error:
        pressing.press(REFUSED[name](SKIN), PLATE)
    sentence(error)


@pytest.mark.parametrize("name", REFUSED)
def test_refused_product(name):
    with pytest.raises(thenar.ThenarError) as error:
        pressing.press(SKIN, REFUSED[name](PLATE))
    sentence(error)


def test_refused_arguments():
    prepared = thenar.Skin(*SKIN, regions=None, materials=[pressing.material()], model="layer")
    wrong = [
        lambda: thenar.Skin(*SKIN, regions=None, materials=[pressing.material()], model="rubber"),
        lambda: thenar.Skin(*SKIN, regions=np.zeros(3, int), materials=[pressing.material()]),
        lambda: thenar.Skin(*SKIN, regions=np.full(len(SKIN[0]), 4), materials=[pressing.material()]),
        lambda: prepared.press(*PLATE, posed_vertices_mm=SKIN[0][:-1]),
        lambda: prepared.press(*PLATE, posed_vertices_mm=SKIN[0] * math.nan),
        lambda: prepared.press(*PLATE, force_n=-1.0),
        lambda: prepared.press(*PLATE, force_n=math.nan),
        lambda: prepared.press(*PLATE, force_n=1.0, direction=(0.0, 0.0, 0.0)),
        lambda: pressing.press(SKIN, PLATE, [pressing.material(-1.0)]),
        lambda: pressing.press(SKIN, PLATE, [pressing.material(thickness=0.0)]),
        lambda: pressing.press(SKIN, PLATE, [pressing.material(math.nan)]),
    ]
    for call in wrong:
        with pytest.raises((thenar.ThenarError, ValueError)) as error:
            call()
        sentence(error)


def finite(contact):
    """The contact, after checking that all of its numbers are numbers and none of its forces pull."""
    for field in (contact.displacement_mm, contact.force_n, contact.pressure_mpa, contact.product_pressure_mpa):
        assert np.isfinite(field).all()
    assert (contact.force_n >= 0.0).all()
    assert np.isfinite(contact.total_force_n).all()
    return contact


def degenerate(mesh):
    extra = np.array([[0, 0, 1], [2, 2, 2]], np.int32)
    return mesh[0], np.concatenate([mesh[1], extra, mesh[1][:5]])


TOLERATED = {
    "degenerate and duplicated triangles": degenerate,
    "isolated vertices": lambda m: (np.concatenate([m[0], [[0.0, 0.0, 0.2], [3.0, 1.0, -40.0]]]), m[1]),
    "one triangle turned over": lambda m: (m[0], np.concatenate([m[1][:70], m[1][70:71, ::-1], m[1][71:]])),
    "non-manifold fin": lambda m: (
        np.concatenate([m[0], [[0.0, 0.0, -9.0 if len(m[0]) < 500 else 20.0]]]),
        np.concatenate([m[1], [[m[1][0, 0], m[1][0, 1], len(m[0])]]]).astype(np.int32),
    ),
}


@pytest.mark.parametrize("model", ["layer", "paper"])
@pytest.mark.parametrize("name", TOLERATED)
def test_flawed_skin_is_pressed_all_the_same(name, model):
    good = pressing.press(SKIN, PLATE, model=model)
    contact = finite(pressing.press(TOLERATED[name](SKIN), PLATE, model=model))
    assert contact.total_force_n[2] == pytest.approx(good.total_force_n[2], rel=0.1)


@pytest.mark.parametrize("name", TOLERATED)
def test_flawed_product_is_pressed_all_the_same(name):
    fine = meshes.ellipsoid((15.0, 15.0, 15.0), 1500, (0.0, 0.0, 14.2))
    good = pressing.press(SKIN, fine)
    contact = finite(pressing.press(SKIN, TOLERATED[name](fine)))
    assert contact.total_force_n[2] == pytest.approx(good.total_force_n[2], rel=0.1)


def test_open_product():
    """A box without its far face still has an inside where the skin meets it."""
    contact = finite(pressing.press(SKIN, (PLATE[0], PLATE[1][[0, 1, 4, 5, 6, 7, 8, 9, 10, 11]])))
    assert contact.total_force_n[2] == pytest.approx(pressing.press(SKIN, PLATE).total_force_n[2], rel=0.05)


def test_flipped_product():
    """Turned inside out: the same answer, or a sentence, or a warning; never a silent other answer."""
    good = pressing.press(SKIN, PLATE).total_force_n[2]
    try:
        contact = finite(pressing.press(SKIN, (PLATE[0], PLATE[1][:, ::-1].copy())))
    except thenar.ThenarError as error:
        assert len(str(error)) > 15
        return
    assert contact.total_force_n[2] == pytest.approx(good, rel=1e-6) or contact.warnings


@pytest.mark.parametrize("model", ["layer", "paper"])
def test_hand_inside_product_and_product_inside_hand(model):
    tip = pressing.fingertip(600)
    for product in (meshes.box((-60, -60, -60), (60, 60, 60)), meshes.ellipsoid((2.0, 2.0, 2.0), 200)):
        try:
            contact = finite(pressing.press(tip, product, [pressing.material(thickness=8.0)], model))
        except thenar.ThenarError as error:
            assert len(str(error)) > 15
        else:
            assert contact.warnings or contact.force_n.max() == 0.0


@pytest.mark.parametrize("model", ["layer", "paper"])
def test_no_contact(model):
    contact = finite(pressing.press(SKIN, (PLATE[0] + [0, 0, 30.0], PLATE[1]), model=model))
    assert contact.force_n.max() == 0.0
    assert not contact.in_contact.any()
    assert contact.contact_area_mm2 == 0.0
    assert contact.peak_pressure_mpa == contact.mean_pressure_mpa == contact.patch_peak_mpa == 0.0
    assert np.abs(contact.displacement_mm).max() == 0.0


def test_no_contact_under_force_control_is_a_sentence_or_reached():
    far = (PLATE[0] + [0, 0, 500.0], PLATE[1])
    try:
        contact = finite(pressing.press(SKIN, far, force_n=1.0, direction=(0.0, 0.0, -1.0)))
    except thenar.ThenarError as error:
        assert len(str(error)) > 15
    else:
        assert contact.total_force_n[2] == pytest.approx(1.0, rel=1e-3)


def test_product_of_500_000_triangles():
    product = meshes.cylinder(24.0, 80.0, 500, 499)
    assert len(product[1]) == 500_000
    vertices = product[0] @ meshes.rotation((1, 0, 0), np.pi / 2).T + [0, 0, 24.0 - 0.5]
    contact = finite(pressing.press(SKIN, (vertices, product[1])))
    assert contact.total_force_n[2] > 0.0


def test_product_of_several_parts():
    parts = [meshes.box((-20, -20, -0.5), (-1.0, 20, 5)), meshes.box((1.0, -20, -0.5), (20, 20, 5))]
    both = finite(pressing.press(SKIN, meshes.joined(*parts)))
    x = SKIN[0][:, 0]
    assert both.force_n[x < -1.0].sum() > 0.0
    assert both.force_n[x > 1.0].sum() > 0.0
    assert both.force_n[np.abs(x) < 1.0].max() == 0.0


@pytest.mark.parametrize("model", ["layer", "paper"])
def test_thin_walled_cup(model):
    """Skin pressed 3 mm into a wall of 2 mm: depth does not saturate at half the wall, nothing leaves behind it."""
    cup = meshes.revolved(np.array([(0.0, 0.0), (30.0, 0.0), (30.0, 60.0), (28.0, 60.0), (28.0, 2.0), (0.0, 2.0)]), 96)
    tip = meshes.ellipsoid((8.0, 12.0, 7.0), 1500)
    skin = tip[0] + [0.0, 0.0, -7.0 + 3.0], tip[1]
    contact = finite(pressing.press(skin, cup, [pressing.material(thickness=8.0)], model))
    assert -contact.gap_mm.min() == pytest.approx(3.0, abs=0.05)
    assert pressing.written(skin, contact)[contact.force_n > 0.0, 2].max() < 0.1


@pytest.mark.parametrize("model", ["layer", "paper"])
def test_far_from_the_origin(model):
    shift = np.array([4.0e6, -4.0e6, 2.0e6])
    near = pressing.press(SKIN, PLATE, model=model)
    far = finite(pressing.press((SKIN[0] + shift, SKIN[1]), (PLATE[0] + shift, PLATE[1]), model=model))
    assert np.allclose(far.force_n, near.force_n, rtol=0, atol=1e-5 * near.force_n.max())


@pytest.mark.parametrize("factor", [0.001, 1000.0])
def test_scale_a_thousand_off(factor):
    """Meters or micrometers given as millimeters: said in words."""
    tip, plate = pressing.fingertip(1500), pressing.plate_over(6.0)
    try:
        contact = finite(pressing.press((tip[0] * factor, tip[1]), (plate[0] * factor, plate[1])))
    except thenar.ThenarError as error:
        assert len(str(error)) > 15
    else:
        assert contact.warnings


def test_arrays_of_every_kind():
    """f32 and f64, any integer type, strided and Fortran-ordered arrays give the same press."""
    good = pressing.press(SKIN, PLATE).force_n
    vertices, triangles = SKIN
    padded = np.zeros((len(vertices), 6))
    padded[:, ::2] = vertices
    for kind in (np.int64, np.uint32, np.uint64, np.int16):
        assert np.array_equal(pressing.press((vertices, triangles.astype(kind)), PLATE).force_n, good)
    assert np.array_equal(pressing.press((padded[:, ::2], np.asfortranarray(triangles)), PLATE).force_n, good)
    single = pressing.press((vertices.astype(np.float32), triangles), PLATE).force_n
    assert np.allclose(single, good, rtol=0, atol=1e-4 * good.max())


def test_wrong_shapes_and_types():
    prepared = thenar.Skin(*SKIN, regions=None, materials=[pressing.material()], model="layer")
    for vertices, triangles in (
        (PLATE[0][:, :2], PLATE[1]),
        (PLATE[0].ravel(), PLATE[1]),
        (PLATE[0], PLATE[1][:, :2]),
        (PLATE[0], PLATE[1].astype(float) + 0.5),
        (PLATE[0].astype(complex), PLATE[1]),
        ("plate", PLATE[1]),
        (None, None),
    ):
        with pytest.raises((thenar.ThenarError, TypeError, ValueError)):
            prepared.press(vertices, triangles)
