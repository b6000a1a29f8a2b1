"""Every string of the interface has its translation in every language, with the same fields, and no other is kept."""

import ast
import re
from types import SimpleNamespace

import bpy
import interface_strings
import pytest
import source_strings
import tables
from thenar_blender import languages
from thenar_blender.languages import po

NAMES = sorted(languages.LANGUAGES)
KANA, HAN = re.compile(r"[\u3040-\u30ff]"), re.compile(r"[\u4e00-\u9fff]")
COMPOSED_ENGLISH = {"addon/native.py", "addon/panels/preferences.py"}
"""Files whose composed sentences stay English: why the library did not load; the name and version."""


@pytest.fixture
def wanted(scene):
    return interface_strings.everything()


def listed(rows):
    return "\n".join(f"  {row}" for row in rows)


@pytest.mark.parametrize("name", NAMES)
def test_table_is_complete_and_holds_nothing_else(wanted, name):
    missing, unused = tables.compared(wanted, tables.entries(name))
    rows = [f"{where}: {key[1]!r}" for key, where in missing.items()]
    assert not rows, f"{name}.po has no translation of {len(rows)}:\n{listed(rows)}"
    assert not unused, f"{name}.po has entries that nothing shows any more:\n{listed(unused)}"


@pytest.mark.parametrize("name", NAMES)
def test_translations_fill_in_what_the_english_does(name):
    wrong = tables.changed_fields(tables.entries(name))
    assert not wrong, f"{name}.po:\n{listed(wrong)}"


@pytest.mark.parametrize("name", NAMES)
def test_translations_are_in_the_script_of_their_language(name):
    for (_, english), text in tables.entries(name).items():
        plain = re.sub(r"\{[^}]*\}", "", text)
        if text == english or not source_strings.is_words(plain):
            continue
        if name == "de":
            assert not (KANA.search(text) or HAN.search(text)), text
        elif name == "ja":
            assert KANA.search(text) or HAN.search(text) or not re.search("[a-z]{3}", plain), text
        else:
            assert HAN.search(text) and not KANA.search(text), text


def test_the_strings_of_buttons_panels_properties_and_reports_are_found(wanted):
    """One of each kind, by name: an extractor that loses a kind would make the tables complete by mistake."""
    found = {text for _, text in wanted}
    kinds = {
        "label of an operator": "Solve Contact",
        "tooltip of an operator": "Press the hand against the product: shape, pressure and forces of the skin",
        "property of an operator": "First frame of the bake",
        "property of a scene": "Target normal force, N",
        "item": "Layer on bone",
        "tooltip of an item": "A direction in world axes",
        "panel": "Quality and Time",
        "text of a button": "Try a Sample",
        "either text of a label": "Live running",
        "heading": "Force Target",
        "paragraph": "Recordings are loaded: see below. A hand begins here:",
        "row of a table": "Peak over 24 mm²",
        "text of a row of constants": "Light (current pose)",
        "template of a panel": "1 unit = {mm:g} mm",
        "template of a report": "{count} bones joined",
        "literal of a report": "No bone of the hand is near; click on the digit itself",
        "why a button is off": "go back to Object Mode first (Tab)",
        "why a button is off, from a function of its module": "no recording is loaded; load one first",
        "entry of a menu": "Pressure Recording or Study (Thenar)",
        "stage from Rust": "preparing",
        "effect from Rust": "Cycle softening",
        "region": "Hypothenar",
    }
    assert not {kind: text for kind, text in kinds.items() if text not in found}


def test_sentences_are_composed_of_templates(scene):
    """An f-string with words cannot be translated: `iface("... {name}", name=...)` can."""
    composed = [row for row in interface_strings.of_sources()[1] if row.partition(":")[0] not in COMPOSED_ENGLISH]
    assert not composed, listed(composed)


def of_source(text):
    found = source_strings.Sources(ast.parse(text))
    found.returned(found.polled)
    return [words for _, words in found.found], [words for _, words in found.composed]


def test_planted_strings_are_found():
    assert of_source("layout.label(text='Not there')") == (["Not there"], [])
    assert of_source("def f(a):\n    words = 'One' if a else 'Other'\n    row.operator('x.y', text=words)")[0] == [
        "One",
        "Other",
    ]
    assert of_source("self.report({'INFO'}, 'It is done')") == (["It is done"], [])
    assert of_source("self.report({'INFO'}, f'{a} of them')") == ([], ["f'{a} of them'"])
    assert of_source("label(f'{a} N')") == ([], [])
    assert of_source("row.label(text=f'{a:.1f} N')") == ([], [])
    gone = "def gone():\n    return 'no hand'\ndef poll(cls):\n    return polling.allows(cls, gone(), 'no skin')"
    assert sorted(of_source(gone)[0]) == ["no hand", "no skin"]


def test_planted_faults_of_a_table_are_listed():
    wanted = {
        ("*", "Solve"): "a.py:1",
        ("Operator", "Solve"): "b",
        (languages.FORCE, "Light"): "c",
        ("*", "Light"): "d",
    }
    table = {("", "Solve"): "Berechnen", ("", "Light"): "Hell", (languages.FORCE, "Light"): "Leicht"}
    assert tables.compared(wanted, table) == ({}, [])
    assert tables.compared(wanted, {**table, ("", "Old"): "Alt"}) == ({}, [("", "Old")])
    assert tables.compared(wanted, {**table, ("", "Solve"): ""})[0] == {("", "Solve"): "a.py:1"}
    assert tables.compared(wanted, {("", "Light"): "Hell"})[0] == {("", "Solve"): "a.py:1"}
    assert tables.changed_fields({("", "{n} of {m:.1f} %d"): "%d {m:.1f} von {n}"}) == []
    for text in ("{n} von {m:.2f} %d", "{n} von {m:.1f}", "{n} von %d {m:.1f} {m:.1f}", "{n von {m:.1f} %d"):
        assert tables.changed_fields({("", "{n} of {m:.1f} %d"): text})


def test_po_files_read_as_they_were_written(tmp_path):
    table = {("", 'a "b"\\c\n\td'): "x", ("ctx", "a"): 'ü "皮膚"\n', ("", "empty"): ""}
    po.write(tmp_path / "t.po", ["first line", ""], table)
    assert po.read(tmp_path / "t.po") == table
    lines = 'msgid "one "\n"two"\nmsgstr ""\n"eins "\n"zwei"\n'
    (tmp_path / "t.po").write_text(lines, "utf-8")
    assert po.read(tmp_path / "t.po") == {("", "one two"): "eins zwei"}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('msgid "a"\nmsgstr x\n', "line 2: not a line"),
        ('"a"\n', "line 1: not a line"),
        ('msgid "a"\nmsgid "b"\n', "line 2: a second msgid"),
        ('msgid "a"\nmsgstr "b"\nmsgid "a"\nmsgstr "c"\n', "given twice"),
        ('msgid "a"\n', "no msgid or no msgstr"),
    ],
)
def test_damaged_po_files_are_refused_with_their_line(tmp_path, text, words):
    (tmp_path / "t.po").write_text(text, "utf-8")
    with pytest.raises(po.PoError, match=re.escape(words)):
        po.read(tmp_path / "t.po")


@pytest.fixture
def translated(monkeypatch):
    """`languages` as in a Blender that speaks the language of the table; bpy as a module has no translations."""

    def speak(name):
        def look_up(text, context="*"):
            return languages.table(name).get((context, text), text)

        said = {f"pgettext_{kind}": look_up for kind in ("iface", "tip", "rpt")}
        monkeypatch.setattr(
            languages, "bpy", SimpleNamespace(app=SimpleNamespace(translations=SimpleNamespace(**said)))
        )

    return speak


@pytest.mark.parametrize("name", NAMES)
def test_every_template_of_ours_can_be_filled_in(translated, name):
    translated(name)
    for _, english in tables.entries(name):
        names = set(re.findall(r"\{(\w+)", english))
        numbers = {each: 3 for each in names}
        words = languages.iface(english, **numbers)
        assert not names or "{" not in words


def test_sentences_with_numbers_and_words_in_the_middle_are_translated(translated):
    translated("de")
    assert languages.stage("frame 3 of 24, solving") == "Bild 3 von 24, Lösung"
    assert languages.stage("Force 45 N") == "Kraft 45 N"
    assert languages.stage("something new") == "something new"
    assert languages.inside("Pressure") == "Druck"
    assert languages.inside("Not in it") == "not in it"
    assert languages.bone("Middle") == "Mittelglied" != languages.iface("Middle")
    assert languages.iface("{share:.0%} of the area", share=0.25) == "25% der Fläche"


def test_blender_gets_every_language_in_every_context_and_gives_it_back(monkeypatch):
    held = {}
    said = SimpleNamespace(register=held.__setitem__, unregister=held.pop)
    monkeypatch.setattr(languages, "bpy", SimpleNamespace(app=SimpleNamespace(translations=said)))
    monkeypatch.setattr(languages, "claim", lambda: None)
    languages.register()
    (given,) = held.values()
    assert set(given) == {"ja_JP", "de_DE", "zh_HANS", "zh_CN"}
    for table in given.values():
        assert {("*", "Solve Contact"), ("Operator", "Solve Contact"), (languages.OWN, "Solve Contact")} <= set(table)
        assert all(isinstance(text, str) and text for text in table.values())
    assert given["de_DE"]["*", "Light"] == "Hell" and given["de_DE"][languages.FORCE, "Light"] == "Leicht"
    languages.unregister()
    assert not held


def test_words_that_mean_something_else_in_blender_are_looked_up_in_our_context(scene):
    """*Age* is a time that has passed in Blender's Japanese, *Index* a number, *Fast* an insertion in its German."""
    assert scene.thenar.bl_rna.properties["hand"].translation_context == languages.OWN
    solve = bpy.ops.thenar.solve.get_rna_type()
    assert solve.translation_context == languages.OWN
    assert solve.properties["show_map"].translation_context == languages.OWN
    fit = bpy.ops.thenar.fit_grasp.get_rna_type().properties
    assert fit["strength"].translation_context == languages.FORCE
    assert fit["digits"].translation_context == languages.OWN
    held = languages.table("ja")
    assert held["*", "Thenar"] == "Thenar" and held[languages.OWN, "Thenar"] == "母指球"
