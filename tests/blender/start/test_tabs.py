"""The tabs by task: each panel belongs to one, and what is done opens the tab where one goes on."""

import bpy
import pytest
import stage
import test_panels
from test_recordings import write_asf
from thenar_blender import tabs

BELONGS = {
    tabs.SETUP: {"hand", "bones", "grasp", "materials", "effects", "grip"},
    tabs.RESULT: {"result", "regions", "reference", "comfort", "quality", "notes", "display", "pictures", "output"},
    tabs.RECORD: {"no_recordings", "recordings"},
    tabs.DIAGNOSE: {"diagnosis"},
}
"""The task of each panel, by what follows THENAR_PT_ in its name."""


def shown(tab):
    """Panels that a tab shows, without the main one and those of the properties editor."""
    names = {name.removeprefix("THENAR_PT_") for name in test_panels.draw_tab(tab)}
    return {name for name in names - {"main"} if not name.startswith("physics")}


def opened():
    return bpy.context.window_manager.thenar_tabs.tab


def test_each_tab_shows_what_belongs_to_its_task():
    stage.scene()
    bpy.ops.thenar.solve()
    for tab, names in BELONGS.items():
        assert shown(tab) <= names, tab
    everywhere = [name for tab in BELONGS for name in shown(tab)]
    assert len(everywhere) == len(set(everywhere)), "a panel is in one tab"
    assert {"hand", "materials", "effects", "grip"} <= shown(tabs.SETUP)
    assert {"result", "regions", "display", "pictures", "output"} <= shown(tabs.RESULT)
    assert shown(tabs.RECORD) == {"no_recordings"} and shown(tabs.DIAGNOSE) == {"diagnosis"}


def test_every_tab_says_what_to_press_where_nothing_is_there_yet():
    stage.scene()
    said = {tab: [words for panel in test_panels.draw_tab(tab).values() for words, _ in panel] for tab in BELONGS}
    assert "Solve" in said[tabs.SETUP] and "Solve" in said[tabs.RESULT]
    for tab in (tabs.RECORD, tabs.DIAGNOSE):
        assert {"New Study from Files...", "Load Recording or Study...", "Sample Study"} <= set(said[tab]), tab
    assert "Clear" not in said[tabs.RESULT]
    bpy.ops.thenar.solve()
    assert "Clear" in [words for words, _ in test_panels.draw_tab(tabs.RESULT)["THENAR_PT_main"]]


def test_without_a_hand_there_are_no_tabs_and_nothing_is_hidden():
    bpy.ops.thenar.sample_study(kind="concealed_effect")
    for tab in BELONGS:
        assert shown(tab) == {"recordings", "diagnosis"}, tab
        assert "Set Up" not in [words for words, _ in test_panels.draw_tab(tab)["THENAR_PT_main"]]


def test_solve_from_a_button_opens_the_result_and_a_script_changes_no_tab():
    stage.scene()
    tabs.open_tab(bpy.context, tabs.SETUP)
    bpy.ops.thenar.solve()
    assert opened() == tabs.SETUP
    bpy.ops.thenar.solve(show_map=True)
    assert opened() == tabs.RESULT


def test_what_was_loaded_opens_the_tab_where_one_goes_on(tmp_path):
    stage.scene()
    bpy.ops.thenar.load_recording(filepath=write_asf(tmp_path / "mat.asf", [[[1.0, 2.0], [3.0, 4.0]]]))
    assert opened() == tabs.RECORD
    bpy.ops.thenar.sample_study(kind="nothing_missing")
    assert opened() == tabs.DIAGNOSE
    bpy.ops.thenar.make_hand(spacing_mm=6.0)
    assert opened() == tabs.SETUP


def test_a_hand_made_for_a_study_leaves_the_study_in_sight():
    bpy.context.scene.thenar_new_study.is_open = True
    bpy.ops.thenar.make_hand(spacing_mm=6.0)
    assert opened() == tabs.RECORD and bpy.types.THENAR_PT_new_study.poll(bpy.context)


@pytest.mark.parametrize("name", ["THENAR_PT_physics", "THENAR_PT_physics_result"])
def test_the_properties_editor_has_no_tabs(name):
    stage.scene()
    bpy.ops.thenar.solve()
    for tab in BELONGS:
        tabs.open_tab(bpy.context, tab)
        assert getattr(bpy.types, name).poll(bpy.context)


def test_the_tab_is_no_undo_step(tmp_path):
    stage.scene()
    bpy.ops.ed.undo_push(message="scene")
    bpy.context.scene.thenar.model = "LAYER"
    bpy.ops.ed.undo_push(message="before")
    tabs.open_tab(bpy.context, tabs.RESULT)
    bpy.ops.ed.undo()
    assert opened() == tabs.RESULT
