"""What the native module takes as arguments and what it refuses, with which exception and sentence."""

import numpy as np
import pressing_shapes as shapes
import pytest
import thenar

VERTICES, TRIANGLES = shapes.sheet(7)
BALL = shapes.ball(4.0, (0, 0, 3.8), 8)


def pressed(vertices=VERTICES, triangles=TRIANGLES, product=BALL):
    return thenar.Skin(vertices, triangles).press(*product).force_n


def every_other(array, axis):
    """The same numbers in an array that is not contiguous along `axis`."""
    wide = np.repeat(array, 2, axis=axis)
    view = wide[::2] if axis == 0 else wide[:, ::2]
    assert not view.flags.c_contiguous
    return view


@pytest.mark.parametrize(
    "layout",
    [
        np.asfortranarray,
        lambda a: every_other(a, 0),
        lambda a: every_other(a, 1),
        lambda a: a[::-1].copy()[::-1],
        lambda a: a.astype(a.dtype.newbyteorder(">")),
        lambda a: a.tolist(),
        lambda a: tuple(map(tuple, a.tolist())),
        lambda a: np.require(a, requirements="O").view(),
    ],
)
def test_memory_layout_does_not_change_a_bit(layout):
    product = tuple(layout(part) for part in BALL)
    assert np.array_equal(pressed(layout(VERTICES), layout(TRIANGLES), product), pressed())


@pytest.mark.parametrize("dtype", ["i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", ">i2", ">u4", ">i8", np.intp])
def test_every_integer_type_is_taken(dtype):
    assert np.array_equal(pressed(triangles=TRIANGLES.astype(dtype)), pressed())
    thenar.Skin(VERTICES, TRIANGLES, np.zeros(len(VERTICES), dtype))


def test_single_precision_is_the_same_as_its_numbers_in_double():
    single = VERTICES.astype(np.float32) * np.float32(1.1)
    assert np.array_equal(pressed(single), pressed(single.astype(float)))
    assert np.array_equal(pressed(np.float16(VERTICES)), pressed(np.float16(VERTICES).astype(float)))


def test_arguments_are_left_as_they_were():
    vertices, triangles = VERTICES.copy(), TRIANGLES.copy()
    vertices.flags.writeable = triangles.flags.writeable = False
    skin = thenar.Skin(vertices, triangles)
    skin.press(*BALL, posed_vertices_mm=vertices, force_n=0.01, direction=(0, 0, -1))
    assert np.array_equal(vertices, VERTICES) and np.array_equal(triangles, TRIANGLES)


NO_NUMBERS = [
    (np.zeros((4, 2)), r"expected an \(n, 3\) array of numbers, got float64 of shape \(4, 2\)"),
    (np.zeros(12), r"got float64 of shape \(12,\)"),
    (np.zeros((4, 3, 1)), r"got float64 of shape \(4, 3, 1\)"),
    (np.zeros((4, 3), bool), r"got bool of shape"),
    (np.zeros((4, 3), complex), r"got complex128 of shape"),
    (np.zeros((4, 3), "M8[s]"), r"got datetime64\[s\] of shape"),
    (np.zeros((4, 3), object), r"got object of shape"),
    ([["a", "b", "c"]], r"got <U1 of shape"),
    ([[1, 2, 3], [4, 5]], r"got list that numpy cannot read"),
    (None, r"got object of shape \(\)"),
    (7, r"got int64 of shape \(\)"),
    ([[0, 0, 0], [0, float("nan"), 0]], r"row 1 holds NaN in column 1; every coordinate must be finite"),
    ([[0, 0, -np.inf]], r"row 0 holds -inf in column 2"),
]


@pytest.mark.parametrize(("bad", "sentence"), NO_NUMBERS)
def test_points_that_are_none_are_refused_by_name(bad, sentence):
    skin = thenar.Skin(VERTICES, TRIANGLES)
    with pytest.raises(thenar.MeshError, match="^vertices_mm: .*" + sentence):
        thenar.Skin(bad, TRIANGLES)
    with pytest.raises(thenar.MeshError, match="^product_vertices_mm: .*" + sentence):
        skin.press(bad, BALL[1])
    with pytest.raises(thenar.MeshError, match="^points_mm: .*" + sentence):
        thenar.Product(*BALL).gap_mm(bad)
    if bad is not None:
        with pytest.raises(thenar.MeshError, match="^posed_vertices_mm: .*" + sentence):
            skin.press(*BALL, posed_vertices_mm=bad)


NO_TRIANGLES = [
    ([[0, 1, 49]], "triangle 0 uses vertex 49, but there are 49 vertices, numbered from 0"),
    ([[0, 1, 2], [0, -1, 2]], "triangle 1 uses vertex -1"),
    (np.array([[0, 1, 2**64 - 1]], np.uint64), "triangle 0 uses vertex 9223372036854775807"),
    ([[0.0, 1.0, 2.0]], r"expected an \(m, 3\) array of integers, got float64 of shape \(1, 3\); convert"),
    ([[True, False, True]], "got bool of shape"),
    ([[0, 1, 2, 3]], r"got int64 of shape \(1, 4\)"),
    ([[0, 1, 10**30]], "got object of shape"),
    ("abc", "got <U3 of shape"),
]


@pytest.mark.parametrize(("bad", "sentence"), NO_TRIANGLES)
def test_triangles_that_are_none_are_refused_by_name(bad, sentence):
    with pytest.raises(thenar.MeshError, match="^triangles: .*" + sentence):
        thenar.Skin(VERTICES, bad)
    if "49" not in sentence:
        with pytest.raises(thenar.MeshError, match="^product_triangles: .*" + sentence):
            thenar.Skin(VERTICES, TRIANGLES).press(VERTICES, bad)


@pytest.mark.parametrize(
    ("bad", "sentence"),
    [
        (np.zeros(48, int), r"expected an array of 49 integers, one per vertex, got int64 of shape \(48,\)"),
        (np.zeros(49), "got float64 of shape"),
        (np.zeros(49, bool), "got bool of shape"),
        (np.full(49, 10**9), "vertex 0 is in region 1000000000; number regions from 0 to 4095"),
    ],
)
def test_regions_that_are_none_are_refused(bad, sentence):
    with pytest.raises(thenar.MeshError, match="^regions: .*" + sentence):
        thenar.Skin(VERTICES, TRIANGLES, bad)


def test_empty_meshes_are_refused():
    with pytest.raises(thenar.MeshError):
        thenar.Skin(np.zeros((0, 3)), np.zeros((0, 3), int))
    with pytest.raises(thenar.MeshError):
        thenar.Product(VERTICES, np.zeros((0, 3), int))


def test_posture_of_another_mesh_is_refused():
    with pytest.raises(thenar.MeshError, match="48 vertices.*49"):
        thenar.Skin(VERTICES, TRIANGLES).press(*BALL, posed_vertices_mm=VERTICES[:-1])


@pytest.mark.parametrize(
    ("keywords", "sentence"),
    [
        ({"force_n": "much"}, "^force_n: expected a number, got str"),
        ({"force_n": True}, "^force_n: expected a number, got bool"),
        ({"force_n": float("nan")}, "^force_n: NaN"),
        ({"force_n": 0.0}, "force"),
        ({"force_n": -1.0}, "force"),
        ({"force_n": float("inf")}, "force"),
        ({"force_n": 0.1, "direction": (0, 0, 0)}, "direction"),
        ({"force_n": 0.1, "direction": (0, 0)}, r"^direction: expected 3 numbers, got int64 of shape \(2,\)"),
        ({"force_n": 0.1, "direction": (0, 0, np.inf)}, "^direction: .*finite"),
        ({"direction": (0, 0, -1)}, "^direction: it is used with force_n only"),
        ({"cancel": 7}, "^cancel: expected a callable"),
        ({"progress": "bar"}, "^progress: expected a callable"),
    ],
)
def test_impossible_presses_are_refused(keywords, sentence):
    with pytest.raises(thenar.SolveError, match=sentence):
        thenar.Skin(VERTICES, TRIANGLES).press(*BALL, **keywords)


def test_an_unknown_model_is_refused():
    with pytest.raises(thenar.SolveError, match='^model: there is no "fem"; choose "layer" or "paper"'):
        thenar.Skin(VERTICES, TRIANGLES, model="fem")


def test_product_stands_for_its_arrays():
    skin, product = thenar.Skin(VERTICES, TRIANGLES), thenar.Product(*BALL)
    assert np.array_equal(skin.press(product).force_n, pressed())
    with pytest.raises(thenar.MeshError, match="^product_triangles: a thenar.Product has its own"):
        skin.press(product, BALL[1])
    with pytest.raises(thenar.MeshError, match="^product_triangles: missing"):
        skin.press(BALL[0])
