"""Every panel is drawn on a layout that only listens: names exist, and no text is longer than its place."""

from types import SimpleNamespace

import bpy
import letters
import numpy as np
import pytest
import small_studies
import stage
from thenar_blender import diagnosis, hand, new_study, panels, picture_sets, recordings, status, tabs
from thenar_blender.diagnosis import settings as kept
from thenar_blender.panels import text

SIDEBAR = 291
"""Width of Blender's sidebar as it opens, pixels."""
TABS = (tabs.SETUP, tabs.RESULT, tabs.RECORD, tabs.DIAGNOSE)
ICON = 3
"""Letters that an icon takes the place of."""


class Layout:
    """What a panel draws on; `letters` is the room of a line, `said` all texts with their room."""

    def __init__(self, letters, said, factor=None):
        self.__dict__.update(letters=letters, said=said, factor=factor, count=0)

    def __setattr__(self, name, value):
        assert name in {
            "active",
            "alert",
            "alignment",
            "enabled",
            "scale_y",
            "use_property_split",
            "use_property_decorate",
        }, name

    def _child(self, **_):
        share = 1.0 if self.factor is None else self.factor if self.count == 0 else 1.0 - self.factor
        self.__dict__["count"] += 1
        return type(self)(self.letters * share, self.said)

    row = column = box = grid_flow = _child

    def split(self, factor=0.5, align=False):
        return type(self)(self._child().letters, self.said, factor)

    def separator(self, factor=1.0):
        pass

    def _say(self, words, icon="NONE"):
        self.said.append((words, self._child().letters - ICON * (icon != "NONE")))

    def label(self, text="", icon="NONE"):
        assert icon in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
        self._say(text, icon)

    def template_icon(self, icon_value=0, scale=1.0):
        assert isinstance(icon_value, int) and scale > 1.0

    def progress(self, factor=0.0, text=""):
        assert 0.0 <= factor <= 1.0
        self._say(text)

    def operator(self, name, text=None, icon="NONE", depress=False, emboss=True):
        area, _, verb = name.partition(".")
        kind = getattr(getattr(bpy.ops, area), verb).get_rna_type()
        self._say(kind.name if text is None else text, icon)
        return _Properties(kind)

    def operator_menu_enum(self, name, prop, text="", icon="NONE"):
        button = self.operator(name, text)
        assert prop in button._rna.properties
        return button

    def menu(self, name, text="", icon="NONE"):
        assert hasattr(bpy.types, name), name
        self._say(text, icon)

    def prop(self, data, name, text=None, index=-1, expand=False, **_):  # noqa: PLR0913 - Blender's
        assert name in data.bl_rna.properties, f"{data} has no '{name}'"
        if expand:
            items, room = data.bl_rna.properties[name].enum_items, self._child().letters
            self.said.extend((item.name, room / len(items)) for item in items)
            return
        told = data.bl_rna.properties[name].name if text is None else text
        self._say(told if data.bl_rna.properties[name].type != "ENUM" else "")

    def prop_search(self, data, name, where, listed, text=None, **_):
        assert listed in where.bl_rna.properties
        if text == "":
            self.said.append((getattr(data, name), self._child().letters - 2 * ICON))
        else:
            self.prop(data, name, text)

    def template_list(self, kind, _, data, name, active_data, active_name, rows=1):  # noqa: PLR0913 - Blender's
        assert hasattr(bpy.types, kind) and hasattr(data, name) and hasattr(active_data, active_name)
        for item in getattr(data, name):
            getattr(bpy.types, kind).draw_item(
                SimpleNamespace(), bpy.context, self._child(), data, item, 0, None, "", *_index(kind)
            )


class _Properties:
    """What an operator's button sets."""

    def __init__(self, kind):
        self.__dict__["_rna"] = kind

    def __setattr__(self, name, value):
        assert name in self._rna.properties, f"{self._rna.identifier} has no '{name}'"
        self.__dict__[name] = value


class Context:
    """Blender's context as the sidebar has it."""

    region = SimpleNamespace(width=SIDEBAR)
    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0), filepaths=SimpleNamespace(asset_libraries=()))

    def __getattr__(self, name):
        return getattr(bpy.context, name)


def _index(kind):
    return (0,) if kind == "THENAR_UL_regions" else ()


def draw():
    """Draw every panel of every tab. Returns {panel: [(text, room)]}."""
    chosen, drawn = bpy.context.window_manager.thenar_tabs.tab, {}
    for tab in TABS:
        for panel, said in draw_tab(tab).items():
            drawn.setdefault(panel, []).extend(each for each in said if each not in drawn[panel])
    bpy.context.window_manager.thenar_tabs.tab = chosen
    return drawn


def draw_tab(tab):
    """The same of one tab: those that show now."""
    bpy.context.window_manager.thenar_tabs.tab = tab
    context, drawn = Context(), {}
    for module in (
        *panels._MODULES,
        hand.panel,
        recordings.panel,
        diagnosis.panel,
        new_study.panel,
        picture_sets.panel,
    ):
        for cls in module.CLASSES:
            if issubclass(cls, bpy.types.Panel) and is_shown(cls, context):
                said = drawn.setdefault(cls.__name__, [])
                cls.draw(SimpleNamespace(layout=Layout(text.width(context), said)), context)
    return drawn


def is_shown(cls, context):
    """Whether Blender draws the panel: it and all above it have something to say."""
    above = getattr(bpy.types, getattr(cls, "bl_parent_id", ""), None)
    return (not hasattr(cls, "poll") or cls.poll(context)) and (above is None or is_shown(above, context))


def too_long(drawn):
    """Texts that a sidebar of default width would cut."""
    return [
        (panel, words, round(room, 1))
        for panel, said in drawn.items()
        for words, room in said
        if words and len(words) > room
    ]


def test_an_empty_scene_shows_three_cards_and_nothing_that_cannot_act():
    drawn = draw()
    assert set(drawn) == {"THENAR_PT_main"}
    said = [words for words, _ in drawn["THENAR_PT_main"]]
    cards = ["Try a sample", "I have a product: make me a hand", "I have a hand: pick it"]
    assert [words for words in said if words in cards] == cards
    assert "Add Product..." in said and "Solve" not in said and "Make Hand" not in said
    assert not too_long(drawn)


def test_the_answer_of_a_study_is_not_below_the_cards():
    bpy.ops.thenar.sample_study(kind="nothing_missing")
    drawn = draw()
    said = [words for words, _ in drawn["THENAR_PT_main"]]
    assert {"Try a Sample", "Add Product...", "Add Hand from File..."} <= set(said)
    assert "Try a sample" not in said and "I have a hand: pick it" not in said
    assert {"THENAR_PT_recordings", "THENAR_PT_diagnosis"} <= set(drawn)
    assert not too_long(drawn)
    bpy.context.scene.thenar_recordings.items[0].kind = "MAP"
    said = [words for words, _ in draw()["THENAR_PT_main"]]
    assert "I have a hand: pick it" in said, "a mat needs a hand"
    bpy.context.scene.thenar_recordings.items[0].kind = "STUDY"
    bpy.context.scene.thenar.product = stage.plate()
    said = [words for words, _ in draw()["THENAR_PT_main"]]
    assert "Make Hand" in said and "Add Product..." not in said


def test_the_cards_go_on_from_what_is_there():
    product = stage.plate()
    settings = bpy.context.scene.thenar
    settings.product, settings.added_mm = product, 30e3
    product.scale = (1000, 1000, 1000)
    bpy.context.view_layer.update()
    drawn = draw()
    said = [words for words, _ in drawn["THENAR_PT_main"]]
    assert "Scale by 0.001, to 30 mm" in said and "Keep size 30 m" in said
    assert " ".join(said).count("Is the product 30 m long?") == 1
    assert "Make Hand" not in said and "Use 'Plate'" not in said and "Add Product..." not in said
    assert not too_long(drawn)
    bpy.ops.thenar.accept_size()
    said = [words for words, _ in draw()["THENAR_PT_main"]]
    assert "Make Hand" in said and "Product 30 m" in said
    settings.product = None
    assert "Use 'Plate'" in [words for words, _ in draw()["THENAR_PT_main"]]
    settings.product = None
    settings.hand = stage.pad()
    drawn = draw()
    said = [words for words, _ in drawn["THENAR_PT_main"]]
    assert "Add Product..." in said and "Solve" not in said and "Try a sample" not in said
    assert not {"THENAR_PT_result", "THENAR_PT_display", "THENAR_PT_output"} & set(drawn)
    assert not too_long(drawn)


def test_a_solved_scene_with_effects_is_drawn():
    stage.scene()
    for kind in ("bone", "stiffening_law", "friction"):
        bpy.ops.thenar.effect_add(kind=kind)
    bpy.context.scene.thenar.comfort.rule = "BLOOD_FLOW"
    stage.solve()
    drawn = draw()
    assert {"THENAR_PT_regions", "THENAR_PT_comfort", "THENAR_PT_quality", "THENAR_PT_effects"} <= set(drawn)
    assert not too_long(drawn)


def test_both_sizes_are_shown_and_a_doubtful_one_has_its_buttons():
    _, product = stage.scene()
    said = [words for words, _ in draw()["THENAR_PT_main"]]
    assert "Hand 16 mm, product 30 mm" in said
    product.scale = (1000, 1000, 1000)
    bpy.context.view_layer.update()
    drawn = draw()
    said = [words for words, _ in drawn["THENAR_PT_main"]]
    assert "Scale by 0.001, to 30 mm" in said and "Keep size 30 m" in said
    assert not too_long(drawn)


def test_the_bones_of_a_made_hand_are_drawn_in_full():
    bpy.ops.thenar.make_hand(spacing_mm=6.0)
    drawn = draw()
    told = {words for words, _ in drawn["THENAR_PT_bones"]}
    assert {"Wrist", "Thumb", "Little", "Metacarpal", "Proximal", "index_metacarpal", "thumb_distal"} <= told
    assert not too_long({"THENAR_PT_bones": drawn["THENAR_PT_bones"]})


def test_comparisons_are_drawn(tmp_path):
    hand, _ = stage.scene()
    hand.data.calc_loop_triangles()
    triangles = np.array([list(each.vertices) for each in hand.data.loop_triangles])
    local = np.array([vertex.co for vertex in hand.data.vertices]) * 1e3
    path = small_studies.write_mat(tmp_path, (local, triangles), local[local[:, 2].argmin()], (4, 2))
    bpy.ops.thenar.load_recording(filepath=str(path))
    bpy.ops.thenar.compare()
    drawn = draw()
    assert "row 4, column 2" in [words for words, _ in drawn["THENAR_PT_comparison"]]
    assert not too_long(drawn)
    curves = tmp_path / "curves"
    curves.mkdir()
    bpy.ops.thenar.load_recording(filepath=str(small_studies.write(curves, small_studies.flat_skin())))
    bpy.ops.thenar.compare()
    assert not too_long(draw())


@pytest.mark.parametrize("verdict", sorted(letters.FINDINGS))
def test_every_letter_is_drawn(verdict, tmp_path):
    stage.scene()
    answer = letters.Answer(letters.FINDINGS[verdict])
    kept.fill(bpy.context.scene.thenar_diagnosis, answer.to_json(), ("A study of that name", str(tmp_path), ""))
    drawn = draw()
    told = " ".join(words for words, _ in drawn["THENAR_PT_diagnosis"])
    assert letters.FINDINGS[verdict]["sentence"] in told and "The study is no longer at" in told
    assert ("THENAR_PT_findings" in drawn) == bool(letters.FINDINGS[verdict]["findings"])
    assert not too_long(drawn)


def test_findings_that_cannot_be_read_are_told():
    state = bpy.context.scene.thenar_diagnosis
    state.is_valid, state.findings = True, "{"
    drawn = draw()
    assert any("Findings kept" in words or "findings kept" in words for words, _ in drawn["THENAR_PT_diagnosis"])
    assert "THENAR_PT_findings" not in drawn


def test_a_run_shows_its_progress_wherever_one_can_be_begun():
    bpy.context.scene.thenar_recordings.items.add().kind = recordings.settings.STUDY
    status.run.stage, status.run.fraction = "refit", 0.25
    try:
        drawn = draw()
    finally:
        status.run.stage, status.run.fraction = "", 0.0
    for panel in ("THENAR_PT_main", "THENAR_PT_recordings", "THENAR_PT_diagnosis"):
        assert "Refit 25% · Esc cancels" in [words for words, _ in drawn[panel]], panel


def test_paragraphs_keep_numbers_with_their_units():
    lines = text.wrapped("Press with a ball of 16 mm or more and hold it for 30 s, twice, at 5 % less.", 20)
    assert " ".join(lines).startswith("Press with a ball of 16 mm") and max(map(len, lines)) <= 20
    for pair in ("16 mm", "30 s,", "5 %"):
        assert any(pair in line for line in lines), lines
    assert text.wrapped("", 20) == [""]
    assert text.wrapped("/a/very/long/folder/of/studies is gone", 20) == ["/a/very/long/folder/", "of/studies is gone"]
