"""Entries of menus, preferences and debug info: each leads to an operator, has words, and tells no private path."""

import re

import bpy
import product_files as files
import pytest
import stage
from thenar_blender.panels import preferences
from thenar_blender.start import debug_info, menus


class _Listening:
    """A layout that notes operators and menus."""

    def __init__(self):
        self.said = []

    def operator(self, name, text="", icon="NONE"):
        area, _, verb = name.partition(".")
        assert getattr(getattr(bpy.ops, area), verb).get_rna_type().description, name
        self.said.append(name)
        return type("Properties", (), {})()

    def menu(self, name):
        assert hasattr(bpy.types, name)
        self.said.append(name)

    def separator(self):
        pass


def entries(draw):
    layout = _Listening()
    draw(type("Menu", (), {"layout": layout})(), bpy.context)
    return layout.said


def test_blenders_menus_hold_the_entries():
    found = {place: entries(draw) for place, draw in menus._PLACES}
    assert found["VIEW3D_MT_mesh_add"] == ["thenar.make_hand"]
    imports = ["add_product", "add_hand", "load_hand_pose", "load_recording", "new_study"]
    assert found["TOPBAR_MT_file_import"] == [f"thenar.{name}" for name in imports]
    assert found["VIEW3D_MT_object"] == ["THENAR_MT_object"]
    for place, draw in menus._PLACES:
        assert draw in getattr(bpy.types, place)._dyn_ui_initialize(), place
    assert {"thenar.solve", "thenar.look", "thenar.fit_grasp"} <= set(entries(menus.THENAR_MT_object.draw))


def test_every_preference_has_a_tooltip_and_lengths_their_unit():
    kinds = preferences.ThenarPreferences.__annotations__
    assert set(kinds) == {field for _, fields in preferences._GROUPS for field in fields}
    for name, made in kinds.items():
        assert len(made.keywords["description"]) > 15, name
    assert "kPa" in kinds["range_kpa"].keywords["name"] and "percent" in kinds["percentile"].keywords["description"]


def test_preferences_fill_only_what_nobody_set(monkeypatch):
    chosen = type("Chosen", (), {"palette": "CIVIDIS", "range_kpa": 60.0})()
    addon = type("Addon", (), {"preferences": chosen})()
    context = type(
        "Context", (), {"preferences": type("P", (), {"addons": {preferences.ThenarPreferences.bl_idname: addon}})()}
    )()
    settings = bpy.context.scene.thenar
    settings.range_kpa = 90.0
    preferences.fill(context, settings, {"palette": "palette", "range_kpa": "range_kpa"})
    assert settings.palette == "CIVIDIS" and settings.range_kpa == 90.0
    assert preferences.get(context, "palette", "EMBER") == "CIVIDIS"
    assert preferences.get(bpy.context, "palette", "EMBER") == "EMBER"


def test_debug_info_says_what_is_needed_and_no_path(tmp_path):
    stage.scene()
    stage.solve()
    folder = tmp_path / "Jane Doe's secret project"
    folder.mkdir()
    (folder / "cut.stl").write_bytes(files.stl()[:200])
    for name in ("cut.stl", "gone.stl"):
        with pytest.raises(RuntimeError):
            bpy.ops.thenar.add_product(filepath=str(folder / name))
    text = debug_info.written(bpy.context)
    for wanted in (
        "Thenar 0.1.0",
        f"Blender {bpy.app.version_string}",
        "Python",
        "result force_n: ",
        "no file 'gone.stl'",
    ):
        assert wanted in text, text
    assert not re.search(r"Jane|secret|pytest|/tmp", text), text
    assert "Pad" not in text and "Plate" not in text
    assert bpy.ops.thenar.copy_debug_info() == {"FINISHED"}


@pytest.mark.parametrize(
    "path", ["/home/jane doe's/a.stl", r"C:\Users\Jane Doe\a.stl", r"\\server\share\a.stl", "~/jane/a.stl"]
)
def test_paths_of_every_system_are_left_out(path):
    assert debug_info.without_paths(f"'{path}' is empty; 5 N/mm") == "'<path>.stl' is empty; 5 N/mm"
