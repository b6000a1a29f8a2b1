"""The binding's input, over 100,000 times at random: a result or a sentence, never a panic, a hang or a wrong shape."""

from collections import Counter

import numpy as np
import pressing_shapes as shapes
import pytest
import thenar
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

# Arrays are cheap (0.2 ms a case), whole presses are not (1 ms): most cases are arrays.
RUNS = {"refused": 92_000, "meshes": 8_000, "hypothesis": 500}
TRIED = Counter()
BALL = shapes.ball(2.0, (0, 0, 1.5), 4)
PRODUCT = thenar.Product(*BALL)
SKIN = thenar.Skin(*shapes.sheet(3))
ODD_NUMBERS = np.array([0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, np.inf, -np.inf, np.nan, 1e-8, 0.1, 2.5, 1e6])
TYPES = ["f2", "f4", "f8", ">f4", "i1", "i4", ">i8", "u1", "u8", "?", "c8", "O", "U2", "M8[s]", "g"]


def holds_its_promises(contact, count):
    assert contact.displacement_mm.shape == (count, 3) and np.isfinite(contact.displacement_mm).all()
    assert np.isfinite(contact.force_n).all() and (contact.force_n >= 0).all()
    assert np.isfinite(contact.pressure_mpa).all() and not np.isnan(contact.gap_mm).any()


def any_array(random):
    """An array of any type, shape and content, or a thing that is none."""
    kind = random.integers(12)
    if kind == 0:
        return random.choice(np.array([None, 3, "abc", b"x", [], [[]], {}, object(), [[1, 2, 3]], [1, [2]]], object))
    shape = tuple(random.integers(0, 5, random.integers(0, 4)))
    if kind < 8:
        shape = (random.integers(0, 6), 3)
    numbers = random.choice(ODD_NUMBERS, shape) if random.integers(2) else random.integers(-2, 8, shape)
    with np.errstate(all="ignore"):
        array = np.asarray(numbers).astype(random.choice(TYPES))
    if random.integers(3) == 0 and array.ndim == 2:
        array = np.asfortranarray(array)[:: random.choice([1, -1, 2])]
    return array


@pytest.mark.filterwarnings("ignore")
def test_arrays_of_any_kind_give_a_result_or_a_sentence():
    random = np.random.default_rng(20261121)
    vertices, triangles = shapes.sheet(3)
    skin = thenar.Skin(vertices, triangles)
    calls = [
        lambda: thenar.Skin(any_array(random), any_array(random)),
        lambda: thenar.Skin(vertices, any_array(random), any_array(random)),
        lambda: thenar.Skin(vertices, triangles, any_array(random), any_array(random)),
        lambda: thenar.Product(any_array(random), any_array(random)),
        lambda: PRODUCT.gap_mm(
            any_array(random), any_array(random), random.choice(ODD_NUMBERS), random.choice(ODD_NUMBERS)
        ),
        lambda: skin.press(any_array(random), any_array(random)),
        lambda: skin.press(PRODUCT, None, any_array(random), random.choice(ODD_NUMBERS), any_array(random)),
        lambda: thenar.Material(g0_mpa=any_array(random), swelling=any_array(random)),
    ]
    refused = 0
    for run in range(RUNS["refused"]):
        TRIED["arrays"] += 1
        try:
            calls[run % len(calls)]()
        except thenar.ThenarError as error:
            refused += 1
            assert str(error) and "\n" not in str(error)
            assert "error inside thenar" not in str(error), error
    assert refused > RUNS["refused"] // 2


def any_mesh(random):
    """A few random triangles, most of them bad: flat, double, far away, tiny, not manifold."""
    count = random.integers(3, 9)
    scale = random.choice([1.0, 1.0, 1.0, 1e-6, 1e5])
    vertices = random.normal(0, 1.5, (count, 3)) * scale
    if random.integers(3) == 0:
        vertices = np.round(vertices)
    if random.integers(4) == 0:
        vertices[:, random.integers(3)] = 0
    return vertices, random.integers(0, count, (random.integers(1, 9), 3))


def test_meshes_of_random_triangles_give_a_result_or_a_sentence():
    random = np.random.default_rng(20261122)
    done = 0
    for _ in range(RUNS["meshes"]):
        TRIED["meshes"] += 1
        skin_mesh, product_mesh = any_mesh(random), any_mesh(random)
        regions = random.integers(-1, 2, len(skin_mesh[0])) if random.integers(2) else None
        try:
            skin = thenar.Skin(*skin_mesh, regions, model=str(random.choice(["layer", "paper"])))
            force = 0.05 if random.integers(4) == 0 else None
            holds_its_promises(skin.press(*product_mesh, force_n=force), len(skin_mesh[0]))
            done += 1
        except thenar.ThenarError as error:
            assert "error inside thenar" not in str(error), (error, skin_mesh, regions, product_mesh)
    assert done > RUNS["meshes"] // 10


SMALL = settings(max_examples=RUNS["hypothesis"], deadline=None, suppress_health_check=list(HealthCheck))


@SMALL
@given(
    arrays.arrays(np.float64, st.tuples(st.integers(0, 6), st.just(3)), elements=st.floats(width=64)),
    arrays.arrays(np.int64, st.tuples(st.integers(0, 6), st.just(3)), elements=st.integers(-2, 7)),
)
def test_any_numbers_as_a_mesh(vertices, triangles):
    TRIED["numbers as a mesh"] += 1
    try:
        skin = thenar.Skin(vertices, triangles)
        holds_its_promises(skin.press(PRODUCT), len(vertices))
        holds_its_promises(SKIN.press(vertices, triangles), 9)
    except thenar.ThenarError as error:
        assert "error inside thenar" not in str(error)


@SMALL
@given(arrays.arrays(arrays.scalar_dtypes(), arrays.array_shapes(min_dims=0, max_dims=3, max_side=4)))
def test_any_array_as_any_argument(array):
    TRIED["array as an argument"] += 1
    for call in (
        lambda: thenar.Skin(array, array, array),
        lambda: SKIN.press(PRODUCT, posed_vertices_mm=array, direction=array, force_n=0.1),
        lambda: PRODUCT.gap_mm(array),
    ):
        try:
            call()
        except thenar.ThenarError as error:
            assert "error inside thenar" not in str(error)


NAMES = st.sampled_from(["g0_mpa", "g_lim_mpa", "d_lim_mm", "thickness_mm", "swelling", "poisson_ratio", "x"])
VALUES = st.one_of(st.none(), st.floats(), st.integers(), st.text(), st.booleans(), st.tuples(*[st.floats()] * 3))


@SMALL
@given(st.dictionaries(NAMES, VALUES))
def test_any_numbers_as_a_material(numbers):
    TRIED["numbers as a material"] += 1
    try:
        material = thenar.Material(**numbers)
    except thenar.ThenarError as error:
        assert str(error)
        return
    assert eval(repr(material), {"thenar": thenar, "inf": float("inf")}) == material


def test_a_hundred_thousand_cases_were_tried():
    """Counts the cases of the tests above; where only some of them ran, there is nothing to count."""
    if len(TRIED) < 5:
        pytest.skip("run the whole file to count its cases")
    print(dict(TRIED))
    assert TRIED.total() >= 100_000
