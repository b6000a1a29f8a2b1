"""Presets bring back on another scene what was saved; a file with a mistake is refused with its place."""

import json

import bpy
import pytest
import stage
from thenar_blender.presets import files, kinds
from thenar_blender.properties import effect_settings


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Presets in a folder of the test's own."""
    monkeypatch.setattr(files, "folder", lambda kind: tmp_path / "presets" / kind.lower())
    return tmp_path


def saved(kind, name="Mine", **options):
    """Save, and return the file's content."""
    assert bpy.ops.thenar.preset_save(kind=kind, name=name, **options) == {"FINISHED"}
    return json.loads((files.folder(kind) / f"{name}.json").read_text())


def put(kind, name="Mine", **options):
    """Apply a preset."""
    assert bpy.ops.thenar.preset_apply(kind=kind, name=name, **options) == {"FINISHED"}


def new_scene(regions=()):
    """An empty file with a hand, its regions, and a product."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    hand, product = stage.scene()
    for name in regions:
        hand.vertex_groups.new(name=name)
    if regions:
        bpy.ops.thenar.assign_regions()
    return hand, product


def values(group):
    """Every plain property of a group."""
    plain = {"FLOAT", "BOOLEAN", "ENUM"}
    return {p.identifier: getattr(group, p.identifier) for p in group.bl_rna.properties if p.type in plain}


def test_a_material_of_ones_own_comes_back():
    hand, _ = new_scene()
    own = hand.thenar.default_material
    own.g0_kpa, own.thickness_mm, own.stiffening = 12.5, 4.25, 0.7
    before = values(own)
    content = saved("SKIN_MATERIAL")
    assert content["version"] == 1 and content["material"]["g0_kpa"] == 12.5
    hand, _ = new_scene()
    put("SKIN_MATERIAL")
    after = values(hand.thenar.default_material)
    numbers = [name for name, value in before.items() if isinstance(value, float)]
    assert len(numbers) >= 12
    assert [after[name] for name in numbers] == pytest.approx([before[name] for name in numbers], rel=1e-5)
    assert hand.thenar.default_material.preset == "CUSTOM"


def test_a_published_material_stays_published():
    hand, _ = new_scene()
    hand.thenar.default_material.preset = "PALM_LAYER"
    saved("SKIN_MATERIAL")
    hand, _ = new_scene()
    put("SKIN_MATERIAL")
    assert hand.thenar.default_material.preset == "PALM_LAYER"


def test_all_regions_go_by_name():
    hand, _ = new_scene(["palm skin", "index tip", "thumb tip"])
    rows = hand.thenar.materials
    rows["palm skin"].g0_kpa, rows["index tip"].g0_kpa = 21.0, 22.0
    saved("SKIN_MATERIAL", all_regions=True)
    hand, _ = new_scene(["index tip", "palm skin", "elbow"])
    before = values(hand.thenar.materials["elbow"])
    put("SKIN_MATERIAL")
    rows = hand.thenar.materials
    assert (rows["palm skin"].g0_kpa, rows["index tip"].g0_kpa) == pytest.approx((21.0, 22.0))
    assert values(rows["elbow"]) == before
    new_scene(["heel"])
    with pytest.raises(RuntimeError, match="(?i)no region of the preset is on 'Pad'"):
        put("SKIN_MATERIAL")


def test_one_material_for_all_regions_leaves_their_anatomy():
    hand, _ = new_scene(["palm skin", "index tip"])
    hand.thenar.material_index = 0
    hand.thenar.materials[0].g0_kpa = 33.0
    hand.thenar.materials[0].thickness_mm, hand.thenar.materials[1].thickness_mm = 9.0, 3.0
    saved("SKIN_MATERIAL")
    put("SKIN_MATERIAL", all_regions=True)
    assert [row.g0_kpa for row in hand.thenar.materials] == pytest.approx([33.0, 33.0])
    assert [row.thickness_mm for row in hand.thenar.materials] == pytest.approx([9.0, 3.0])


def test_a_grip_comes_back_and_keeps_the_group_of_the_product():
    _, product = new_scene()
    grip = product.thenar.grip
    grip.material, grip.thickness_mm, grip.youngs_mpa, grip.poisson_ratio = "CUSTOM", 2.5, 0.35, 0.2
    grip.group = "handle"
    content = saved("SOFT_GRIP")
    assert content["grip"]["youngs_modulus_mpa"] == 0.35 and "group" not in content["grip"]
    _, product = new_scene()
    product.thenar.grip.group = "other"
    put("SOFT_GRIP")
    grip = product.thenar.grip
    assert (grip.material, grip.group) == ("CUSTOM", "other")
    assert (grip.thickness_mm, grip.youngs_mpa, grip.poisson_ratio) == pytest.approx((2.5, 0.35, 0.2))


def test_a_look_comes_back():
    new_scene()
    settings = bpy.context.scene.thenar
    settings.palette, settings.range_kpa, settings.show_legend = "CIVIDIS", 80.0, False
    settings.maps.contour, settings.maps.depth_mm = False, 3.5
    saved("MAP_LOOK")
    new_scene()
    put("MAP_LOOK")
    settings = bpy.context.scene.thenar
    assert (settings.palette, settings.range_kpa, settings.show_legend) == ("CIVIDIS", 80.0, False)
    assert (settings.maps.contour, settings.maps.depth_mm) == (False, 3.5)


def test_effects_come_back_with_numbers_and_laws():
    hand, _ = new_scene(["palm skin"])
    for kind in ("friction", "stiffening_law", "relaxation"):
        bpy.ops.thenar.effect_add(kind=kind)
    friction, law, relaxation = hand.thenar.effects
    friction.numbers["coefficient"].value, friction.region = 0.7, "palm skin"
    law.choices["law"].value, law.is_on, relaxation.amplitude = "ogden", False, 0.25
    saved("EFFECTS")
    hand, _ = new_scene(["palm skin"])
    bpy.ops.thenar.effect_add(kind="adhesion")
    put("EFFECTS")
    friction, law, relaxation = hand.thenar.effects
    assert friction.numbers["coefficient"].value == pytest.approx(0.7) and friction.region == "palm skin"
    assert (law.choices["law"].value, law.is_on) == ("ogden", False)
    assert relaxation.amplitude == pytest.approx(0.25)
    hand, _ = new_scene()
    put("EFFECTS")
    assert not hand.thenar.effects[0].is_on, "an effect of a region that is not there does not act on all skin"


@pytest.mark.parametrize(("effect", "since"), [("adhesion", "reversible"), ("drainage", "halfspace")])
def test_an_older_preset_takes_what_has_come_since(effect, since):
    hand, _ = new_scene()
    bpy.ops.thenar.effect_add(kind=effect)
    content = saved("EFFECTS")
    content["effects"][0]["choices"] = {}
    for name in ("spread", "radius_mm"):
        content["effects"][0]["numbers"].pop(name, None)
    files.path_of("EFFECTS", "Mine").write_text(json.dumps(content))
    hand.thenar.effects.clear()
    put("EFFECTS")
    came = hand.thenar.effects[0]
    assert effect_settings.chosen(came)[0][1] == since
    assert [number.name for number in came.numbers] == [
        shape["name"] for shape in effect_settings.offered()[effect]["shape"]
    ]


@pytest.mark.parametrize("kind", [item[0] for item in kinds.ITEMS])
def test_every_number_says_its_unit_or_has_none(kind):
    hand, _ = new_scene(["palm skin"])
    for name in list(bpy.ops.thenar.effect_add.get_rna_type().properties["kind"].enum_items.keys()) or ["bone"]:
        bpy.ops.thenar.effect_add(kind=name)
    units = ("_mm", "_kpa", "_mpa", "_n", "_s", "_per_n", "_per_mm", "_per_s", "_m2", "_shore_a")
    plain = ("poisson_ratio", "stiffening", "amplitude", "coefficient", "slope", "direction_", "weight_", "exponent")
    plain = (*plain, "reference_strain", "contrast", "drained_poisson_ratio")

    def numbers(node):
        for key, value in node.items() if isinstance(node, dict) else enumerate(node):
            if isinstance(value, dict | list):
                yield from numbers(value)
            elif isinstance(value, float):
                yield key

    named = [key for key in numbers({k: v for k, v in saved(kind).items() if k != "version"})]
    assert named
    for key in named:
        assert key.endswith(units) or any(key.startswith(word) for word in plain), key


def test_a_name_is_taken_once_unless_replaced():
    new_scene()
    saved("MAP_LOOK")
    with pytest.raises(RuntimeError, match="(?i)there is a preset 'Mine' already"):
        saved("MAP_LOOK", "MINE")
    bpy.context.scene.thenar.range_kpa = 60.0
    assert bpy.ops.thenar.preset_save(kind="MAP_LOOK", name="MINE", replace=True) == {"FINISHED"}
    assert files.listed("MAP_LOOK") == ["Mine"]
    assert json.loads(files.path_of("MAP_LOOK", "mine").read_text())["look"]["pressure_range_kpa"] == 60.0
    for name in ("  ", ".."):
        with pytest.raises(RuntimeError, match="cannot be the name"):
            bpy.ops.thenar.preset_save(kind="MAP_LOOK", name=name)
    bpy.ops.thenar.preset_save(kind="MAP_LOOK", name="../a/b: c")
    assert files.listed("MAP_LOOK") == ["_a_b_ c", "Mine"], "no name leaves the folder"


def test_files_go_to_others_and_come_back(folder):
    _, product = new_scene()
    product.thenar.grip.material, product.thenar.grip.thickness_mm = "CORK", 1.5
    saved("SOFT_GRIP", "Cork 1.5 mm")
    out = folder / "sent.json"
    assert bpy.ops.thenar.preset_export(kind="SOFT_GRIP", name="Cork 1.5 mm", filepath=str(out)) == {"FINISHED"}
    assert bpy.ops.thenar.preset_remove(kind="SOFT_GRIP", name="Cork 1.5 mm") == {"FINISHED"}
    assert files.listed("SOFT_GRIP") == []
    assert bpy.ops.thenar.preset_import(filepath=str(out)) == {"FINISHED"}
    _, product = new_scene()
    put("SOFT_GRIP", "sent")
    assert product.thenar.grip.material == "CORK" and product.thenar.grip.thickness_mm == pytest.approx(1.5)


GOOD = {"material": "CORK", "thickness_mm": 2.0, "hardness_shore_a": 40.0, "youngs_modulus_mpa": 1.0}
GOOD["poisson_ratio"] = 0.3
HEAD = {"format": "thenar preset", "version": 1, "kind": "soft_grip"}
LOOK = {"format": "thenar preset", "version": 1, "kind": "map_look"}
EFFECT = {"name": "friction", "is_on": True, "amplitude": 1.0, "painted_full_mm": 10.0, "region": ""}
EFFECT |= {"numbers": {"coefficient": 0.5}, "choices": {}}


def effects(**changed):
    return {**HEAD, "kind": "effects", "effects": [EFFECT, {**EFFECT, **changed}]}


BAD = [
    ('{"format": "thenar preset",\n "version" 1}', r"line 2, column 12"),
    ("[1, 2]", "no preset of Thenar"),
    ('{"format": "something"}', "no preset of Thenar"),
    ({**HEAD, "version": 2, "grip": GOOD}, r"newer Thenar \(version 2, this one reads 1\)"),
    ({**HEAD, "version": "1", "grip": GOOD}, "version: '1' is no whole number"),
    ({**HEAD, "kind": "hat", "grip": GOOD}, "kind: 'hat' is not known; write one of skin_material"),
    ({**HEAD}, "grip: a preset of this kind holds grip alone"),
    ({**HEAD, "grip": GOOD, "look": {}}, "look: a preset of this kind holds grip alone"),
    ({**HEAD, "grip": [1]}, "grip: is no group of values"),
    ({**HEAD, "grip": {**GOOD, "thickness_mm": 5000}}, r"grip\.thickness_mm: 5000 is not between 0\.1 and 1000"),
    ({**HEAD, "grip": {**GOOD, "thickness_mm": "2"}}, r"grip\.thickness_mm: '2' is no number"),
    ({**HEAD, "grip": {**GOOD, "thickness_mm": True}}, r"grip\.thickness_mm: True is no number"),
    ({**HEAD, "grip": {**GOOD, "material": "STEEL"}}, r"grip\.material: 'STEEL' is not known; write one of RIGID"),
    ({**HEAD, "grip": {**GOOD, "depth_mm": 1}}, r"grip\.depth_mm: is not known here"),
    ({**HEAD, "grip": {k: v for k, v in GOOD.items() if k != "poisson_ratio"}}, r"grip\.poisson_ratio: is missing"),
    (json.dumps({**HEAD, "grip": GOOD}).replace("2.0", "NaN"), "NaN is no number"),
    (json.dumps({**HEAD, "grip": GOOD}).replace('"poisson_ratio"', '"thickness_mm"'), '"thickness_mm" is there twice'),
    ({**LOOK, "look": {}}, r"look\.colors: is missing"),
    (effects(name="magic"), r"effects\.1\.name: 'magic' is not known"),
    (effects(numbers={"coefficient": 50}), r"effects\.1\.numbers\.coefficient: 50 is not between 0 and 10"),
    (effects(numbers={}), r"effects\.1\.numbers\.coefficient: is missing"),
    (effects(amplitude=2), r"effects\.1\.amplitude: 2 is not between"),
    (effects(choices={"law": "x"}), r"effects\.1\.choices\.law: is not known here"),
    ({**HEAD, "kind": "skin_material", "regions": {"a": {}}}, r"regions\.a\.based_on: is missing"),
    ("[" * 100000, "nested too deep"),
    (b"\xff\xfe\x00", "no text in UTF-8"),
    (b" " * 1_000_001, "larger than a preset can be"),
]


@pytest.mark.parametrize(("content", "sentence"), BAD)
def test_a_mistake_is_refused_with_its_place(folder, content, sentence):
    text = content if isinstance(content, str | bytes) else json.dumps(content)
    (folder / "bad.json").write_bytes(text if isinstance(text, bytes) else text.encode())
    new_scene()
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.thenar.preset_import(filepath=str(folder / "bad.json"))
    assert not (folder / "presets").exists()


def test_a_file_that_was_spoiled_sets_nothing():
    hand, product = new_scene()
    saved("EFFECTS") if hand.thenar.effects else bpy.ops.thenar.effect_add(kind="friction")
    saved("EFFECTS")
    path = files.path_of("EFFECTS", "Mine")
    path.write_text(path.read_text().replace('"coefficient": 0.5', '"coefficient": -3'))
    hand.thenar.effects[0].amplitude = 0.5
    with pytest.raises(RuntimeError, match="coefficient: -3 is not between"):
        put("EFFECTS")
    assert len(hand.thenar.effects) == 1 and hand.thenar.effects[0].amplitude == pytest.approx(0.5)
    path.unlink()
    with pytest.raises((RuntimeError, TypeError)):
        put("EFFECTS")


def test_what_is_missing_in_the_scene_is_named():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for kind, sentence in (("SOFT_GRIP", "choose the product"), ("EFFECTS", "choose the hand")):
        with pytest.raises(RuntimeError, match=f"(?i){sentence}"):
            bpy.ops.thenar.preset_save(kind=kind, name="x")


def test_presets_are_in_the_users_configuration(monkeypatch):
    monkeypatch.undo()
    folder = files.folder("EFFECTS")
    assert str(folder).startswith(bpy.utils.user_resource("CONFIG").rstrip("/\\"))
    assert folder.parts[-3:] == ("thenar", "presets", "effects")
