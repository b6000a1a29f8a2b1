"""Presets by region, and materials that an older version saved."""

import bpy
import pytest
import stage
import thenar
import thenar_blender
from thenar_blender import handlers
from thenar_blender.properties import material_settings

NEW = ("stiffening", "bone_half_width_mm", "bone_half_length_mm")


@pytest.fixture
def reopened(tmp_path):
    """Saves and opens the scene; with `is_old` as if a version without `NEW` and without marks had saved it."""

    def reopen(material, is_old):
        path = str(tmp_path / "old.blend")
        marking = bpy.app.handlers.save_pre[:]
        if is_old:
            for name in NEW:
                material.property_unset(name)
            bpy.app.handlers.save_pre.clear()
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.app.handlers.save_pre[:] = marking
        bpy.ops.wm.open_mainfile(filepath=path)
        return bpy.context.scene.thenar.hand.thenar.default_material

    return reopen


def test_a_preset_that_an_older_version_saved_has_the_numbers_of_today(reopened):
    hand, _ = stage.scene()
    material = hand.thenar.default_material
    material.preset, material.thickness_mm = "PALM_LAYER", 11.0
    found, palm = reopened(material, is_old=True), thenar.Material.palm_layer()
    assert (found.preset, found.thickness_mm) == ("PALM_LAYER", 11.0)
    assert found.g0_kpa == pytest.approx(1000.0 * palm.g0_mpa)
    assert found.bone_half_width_mm == palm.bone_half_width_mm and found.stiffening == palm.stiffening


def test_own_values_that_an_older_version_saved_mean_what_they_meant(reopened):
    hand, _ = stage.scene()
    material = hand.thenar.default_material
    material.g0_kpa = 12.0
    found = reopened(material, is_old=True)
    assert (found.preset, found.g0_kpa, found.g_lim_kpa) == ("CUSTOM", 12.0, 29.0)
    assert [getattr(found, name) for name in NEW] == [0.0, 0.0, 0.0]


@pytest.mark.parametrize(("name", "value"), [("g0_kpa", 12.0), ("stiffening", 2.0), ("bone_half_width_mm", 0.0)])
def test_what_this_version_saved_comes_back_as_it_was(reopened, name, value):
    hand, _ = stage.scene()
    material = hand.thenar.default_material
    setattr(material, name, value)
    numbers = [getattr(material, prop) for prop, _ in material_settings.MATERIAL_NUMBERS.values()]
    for _ in range(2):
        material = reopened(material, is_old=False)
    assert [getattr(material, prop) for prop, _ in material_settings.MATERIAL_NUMBERS.values()] == numbers


def test_an_open_file_is_brought_up_to_date_when_the_extension_is_enabled(tmp_path):
    """An older file is opened without the extension, then the extension is enabled, as from the preferences."""
    hand, _ = stage.scene()
    hand.thenar.default_material.g0_kpa = 12.0
    marking = bpy.app.handlers.save_pre[:]
    bpy.app.handlers.save_pre.clear()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "old.blend"))
    bpy.app.handlers.save_pre[:] = marking
    thenar_blender.unregister()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "old.blend"))
    thenar_blender.register()
    assert not bpy.app.timers.is_registered(handlers._objects_came), "bpy 4.5 hangs at exit if one was registered"
    assert bpy.data.objects["Pad"].thenar.default_material.stiffening == 0.0


def test_a_hand_of_this_version_is_as_it_was_when_the_extension_is_enabled_again():
    hand, _ = stage.scene()
    hand.thenar.default_material.g0_kpa = 12.0
    thenar_blender.unregister()
    thenar_blender.register()
    found = hand.thenar.default_material
    assert (found.g0_kpa, found.stiffening) == (12.0, thenar.Material.finger_layer().stiffening)


@pytest.mark.skipif(not hasattr(bpy.app.handlers, "blend_import_post"), reason="no event for appended objects")
def test_a_hand_appended_from_an_older_file_is_brought_up_to_date(reopened, tmp_path):
    hand, _ = stage.scene()
    hand.thenar.default_material.g0_kpa = 12.0
    reopened(hand.thenar.default_material, is_old=True)
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.append(directory=str(tmp_path / "old.blend" / "Object"), filename="Pad")
    found = bpy.data.objects["Pad"].thenar.default_material
    assert [getattr(found, name) for name in NEW] == [0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("region", "preset"),
    [
        ("index_distal_pad", "FINGER_LAYER"),
        ("middle_distal_pad", "FINGER_LAYER"),
        ("middle_middle_pad", "PHALANX_LAYER"),
        ("ring_proximal_pad", "PHALANX_LAYER"),
        ("index middle", "PHALANX_LAYER"),
        ("middle_pad", "FINGER_LAYER"),
        ("hypothenar", "PALM_LAYER"),
        ("palm_hollow", "PALM_LAYER"),
    ],
)
def test_published_values_follow_the_name_of_the_region(region, preset):
    hand, _ = stage.scene()
    hand.vertex_groups.new(name=region).add(range(len(hand.data.vertices)), 1.0, "REPLACE")
    bpy.ops.thenar.assign_regions()
    assert hand.thenar.materials[0].preset == preset
    bpy.context.scene.thenar.model = "PAPER"
    bpy.ops.thenar.region_preset()
    assert hand.thenar.materials[0].preset == preset.replace("PHALANX", "FINGER").removesuffix("_LAYER")


def test_bones_and_stiffening_change_the_force():
    hand, _ = stage.scene(top=-5.5)
    material = hand.thenar.default_material
    narrow = stage.solve().force_n
    material.bone_half_width_mm = 0.0
    endless = stage.solve().force_n
    assert 1.1 < endless / narrow < 1.45, "bone without end lets no tissue escape"
    material.stiffening = 0.0
    assert stage.solve().force_n < 0.97 * endless
