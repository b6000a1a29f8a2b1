"""Materials in Python: defaults from the table, refusals, and which region gets which."""

import copy
import math
import pickle

import numpy as np
import pressing_shapes as shapes
import pytest
import thenar

VERTICES, TRIANGLES = shapes.sheet(7)
SOFT, HARD = thenar.Material(g0_mpa=0.004), thenar.Material(g0_mpa=0.04)
REGIONS = np.where(VERTICES[:, 0] < 0, 0, 2)


def test_defaults_are_the_table():
    table = {row.name: row for row in thenar.parameters()}
    material = thenar.Material()
    for name, row in table.items():
        assert getattr(material, name) == row.default
        assert row.low <= row.default <= row.high
        assert getattr(thenar.Material(**{name: row.default / 2}), name) == row.default / 2
    swelling = [table[f"swelling_{name}"].default for name in ("height_mm_per_n", "radius_mm", "width_mm")]
    assert list(material.swelling) == swelling
    assert all(row.meaning and row.source and row.unit for row in table.values())


def test_numbers_are_kept_compared_copied_and_shown():
    given = {"g0_mpa": 0.01, "g_lim_mpa": 0.1, "d_lim_mm": 3.0, "thickness_mm": math.inf, "swelling": (1.0, 7.0, 2.0)}
    material = thenar.Material(**given)
    assert {name: getattr(material, name) for name in given} == given
    assert material == thenar.Material(**given) != material.replace(d_lim_mm=4)
    assert material == pickle.loads(pickle.dumps(material)) == copy.deepcopy(material)
    assert eval(repr(material), {"thenar": thenar, "inf": math.inf}) == material
    with pytest.raises(AttributeError):
        material.g0_mpa = 1.0


def test_presets_differ_and_are_admissible():
    presets = [
        thenar.Material.finger(),
        thenar.Material.palm(),
        thenar.Material.finger_layer(),
        thenar.Material.palm_layer(),
    ]
    assert len({repr(preset) for preset in presets}) == 4
    assert all(preset.replace() == preset for preset in presets)


@pytest.mark.parametrize(
    ("numbers", "sentence"),
    [
        ({"g0_mpa": 0}, "g0_mpa is 0, but must be positive"),
        ({"g_lim_mpa": -1.0}, "g_lim_mpa is -1"),
        ({"d_lim_mm": math.nan}, "^d_lim_mm: NaN"),
        ({"d_lim_mm": math.inf}, "d_lim_mm is inf"),
        ({"poisson_ratio": 0.6}, "poisson_ratio is 0.6, but must be from 0 to 0.5"),
        ({"thickness_mm": "5"}, "^thickness_mm: expected a number, got str"),
        ({"zone_mm": True}, "^zone_mm: expected a number, got bool"),
        ({"swelling": (1, 2)}, "^swelling: expected 3 numbers"),
        ({"swelling": None, "young_mpa": 1.0}, 'a material has no "young_mpa"; it has g0_mpa'),
    ],
)
def test_numbers_that_no_tissue_has_are_refused(numbers, sentence):
    with pytest.raises(thenar.MaterialError, match=sentence):
        thenar.Material(**numbers)


def materials(given, **keywords):
    return thenar.Skin(VERTICES, TRIANGLES, REGIONS, given, **keywords).materials


def test_materials_find_their_regions():
    names = ["left", "nothing", "right"]
    preset = thenar.Material.finger_layer()
    assert materials(None) == [preset] * 3
    assert materials(None, model="paper") == [thenar.Material.finger()] * 3
    assert materials(SOFT) == [SOFT] * 3
    assert materials([SOFT, SOFT, HARD]) == materials((SOFT, SOFT, HARD)) == [SOFT, SOFT, HARD]
    assert materials({0: SOFT, 2: HARD}) == [SOFT, preset, HARD]
    assert materials({np.int64(2): HARD, "default": SOFT}) == [SOFT, SOFT, HARD]
    assert materials({"right": HARD, "left": SOFT}, region_names=names) == [SOFT, preset, HARD]


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ([SOFT, HARD], r"^materials: region 2 has none \(2 were given\)"),
        ({0: SOFT}, r"^materials: region 2 has none \(it is not in the dict"),
        ({3: SOFT, "default": SOFT}, "^materials: there is no region 3; the keys are 0 to 2 or 'default'"),
        ({"palm": SOFT}, "^materials: there is no region 'palm'"),
        ([SOFT, 0.1, HARD], "^materials: region 1 has float, expected a thenar.Material"),
        (0.1, "^materials: expected a Material, a list or a dict of them, got float"),
    ],
)
def test_regions_without_a_material_are_refused(given, sentence):
    with pytest.raises(thenar.MaterialError, match=sentence):
        materials(given)


def test_too_few_region_names_are_refused():
    with pytest.raises(thenar.MeshError, match="^region_names: 2 names for regions 0 to 2"):
        materials(SOFT, region_names=["a", "b"])


def test_warnings_call_regions_by_their_names():
    product = shapes.ball(3.0, (0.0, 0.0, 1.5), 8)  # 1.5 mm deep
    thin = thenar.Material.finger_layer().replace(thickness_mm=2.0)
    skin = thenar.Skin(VERTICES, TRIANGLES, np.zeros(49, int), [thin], region_names=["index fingertip"])
    remarks = [each for each in skin.press(*product).remarks if each.region is not None]
    assert remarks and {each.region for each in remarks} == {0}
    assert any(each.text.startswith("region 'index fingertip' is pressed 1.") for each in remarks)


@pytest.mark.parametrize(("model", "preset"), [("layer", "finger_layer"), ("paper", "finger")])
def test_a_material_that_nobody_gave_is_said(model, preset):
    product = shapes.ball(3.0, (0.0, 0.0, 2.7), 8)
    told = thenar.Skin(VERTICES, TRIANGLES, model=model).press(*product).warnings
    assert any(f"preset {preset})" in said for said in told)
    given = getattr(thenar.Material, preset)()
    told = thenar.Skin(VERTICES, TRIANGLES, materials=given, model=model).press(*product).warnings
    assert not any("preset" in said for said in told)


def test_a_skin_tells_its_thickness_with_its_effects():
    regions = np.where(VERTICES[:, 0] < 0, 0, np.where(VERTICES[:, 1] < 0, -1, 1))
    materials = [thenar.Material(thickness_mm=6.0), thenar.Material(thickness_mm=math.inf)]
    skin = thenar.Skin(VERTICES, TRIANGLES, regions, materials)
    assert (skin.thickness_mm[regions == 0] == 6.0).all()
    assert np.isinf(skin.thickness_mm[regions == 1]).all()
    assert np.isnan(skin.thickness_mm[regions == -1]).all()
    odd = np.arange(len(VERTICES)) % 2 == 1
    one = thenar.Skin(VERTICES, TRIANGLES, materials=materials[0])  # one region: no crease over which materials blend
    one.set_effects([thenar.Effect("bone", 0.5, painted=np.where(odd, 3.0, np.nan), thickness_mm=12.0)])
    assert one.thickness_mm == pytest.approx(1.0 / (0.5 / 6.0 + 0.5 / np.where(odd, 3.0, 12.0)), rel=1e-12)
