"""What a failed button reports is shown in the user's language, with its names and numbers, and found in English."""

import ast
import random
import re
from types import SimpleNamespace

import bpy
import error_templates
import finding_templates
import pytest
import stage
from thenar_blender import languages, status
from thenar_blender.languages import file_words, sentences
from thenar_blender.operators import running
from thenar_blender.picture_sets import sizes
from thenar_blender.product_files import importing
from thenar_blender.recordings import filling

ENGLISH = re.compile(r"\b(?:the|is|are|and|of|inside|product|has|give|choose|press|no|cannot|which|with)\b")
"""Words that no translation holds."""


def drawn(template, number):
    """The sentence with a word of its own in each field, and the words by field."""
    draw = random.Random(f"{number} {template}")
    fields = dict.fromkeys(re.findall(r"\{(\w+)\}", template))
    values = {name: "".join(draw.choices("QXZ", k=3)) + f"{draw.uniform(0, 99):.2f}" for name in fields}
    return template.format(**values), values


def test_there_are_hundreds_of_errors_from_both_languages():
    """An extractor that loses a kind would make the tables complete by mistake."""
    found = error_templates.everything()
    assert sum(where.startswith("addon") for where in found.values()) > 300
    assert sum(where.startswith("rust") for where in found.values()) > 150
    kinds = {
        "literal": "no hand is chosen; pick the hand's mesh under Hand",
        "f-string": "the hand '{name}' has no faces; pick a mesh with a surface",
        "name in quotes": "'{name}' has no armature; add an Armature modifier that names one",
        "what a function returns": "Live keeps the contact up to date; switch it off first",
        "what a name was assigned": "the hand '{name}' hangs on the product and would be scaled too; "
        "clear its parent first",
        "part of a sentence": "has a finger in a thin wall of the product",
        "what callers give": "Certify solves",
        "error of thiserror": "there is no effect {name}; there are {known}",
        "place before a problem": "protocol, row {row}",
        "problem alone": "it cannot be painted; give its numbers",
    }
    assert not {kind: text for kind, text in kinds.items() if text not in found}


@pytest.mark.skipif(bpy.app.version < (5, 0), reason="asks nothing of Blender: once, in the newest")
def test_every_sentence_is_found_again_and_no_other_is_taken_for_it(language):
    held = languages.table(language)
    for template in {**error_templates.everything(), **finding_templates.everything()}:
        for number in range(3):
            sentence, values = drawn(template, number)
            words = sentences.shown(sentence)
            assert words == held[languages.SENTENCE, template].format(**values), template
            assert not ENGLISH.search(words), words
            assert sentences.shown(running.sentence(sentence)) == words


def test_in_english_every_error_stays_as_it_is():
    for template in error_templates.everything():
        sentence, _ = drawn(template, 0)
        assert sentences.shown(sentence) == sentence


def test_sentences_put_together_are_translated_part_by_part(language):
    held = languages.table(language)

    def words(template):
        return held[languages.SENTENCE, template]

    place, problem = "protocol, row {row}", "{name} is {value}, but must be finite"
    said = sentences.shown("'Hand: 2' on 'The product': protocol, row 4: slide_mm is inf, but must be finite")
    joined, _, rest = said.partition(": " + words(place).format(row=4))
    assert (
        rest and "'Hand: 2'" in joined and "'The product'" in joined and not ENGLISH.search(joined.replace("The p", ""))
    )
    assert said.endswith(words(problem).format(name="slide_mm", value="inf"))
    said = sentences.shown("at frame 7, 'Hand': no skin of 'Hand' lies over bone; give its materials a thickness first")
    assert "'Hand'" in said and "7" in said and not ENGLISH.search(said)
    effect = "the effects: effect friction: it needs model layer; the paper's model stays as published"
    named = languages.iface("Friction")
    assert named != "Friction" and named in sentences.shown(effect) and not ENGLISH.search(sentences.shown(effect))


@pytest.mark.parametrize(
    "name",
    ["no end", "A: B; C", "hand and product", "it is empty", "Product", "x (y)", "O'Brien", "Bob's hand", "x, y (z)"],
)
def test_names_in_quotes_stay_whatever_they_are(language, name):
    template = "'{name}' has no shape key '{SHAPE_KEY}'; press Solve first"
    said = sentences.shown(template.format(name=name, SHAPE_KEY="Thenar"))
    assert said == languages.table(language)[languages.SENTENCE, template].format(name=name, SHAPE_KEY="Thenar")


@pytest.mark.parametrize(
    "text",
    ["something else: quite new; try it", "[Errno 13] Permission denied", "a hand of 3 mm. It was long", "; ", ": "],
)
def test_what_has_no_template_stays_in_english(language, text):
    assert sentences.shown(text) == text


def refused():
    """What Solve reports."""
    with pytest.raises(RuntimeError) as error:
        bpy.ops.thenar.solve()
    return str(error.value).removeprefix("Error: ").strip()


def test_a_refused_solve_is_reported_in_the_language_and_kept_in_english(scene, language):
    """No faces, a pinned key, a scale of zero, no region, no force in reach: Python's refusals and the library's."""
    hand, product = stage.scene(cuts=2)
    hand.name, said = "Ding Eins", []

    def take():
        words = refused()
        english = status.last_error.partition(": ")[2]
        assert words != english and not ENGLISH.search(words), words
        assert ENGLISH.search(english), english
        assert all(name in words for name in re.findall(r"'([^']+)'", english) if "Ding" in name)
        said.append(english)

    hand.shape_key_add(name="Basis")
    hand.show_only_shape_key = True
    take()
    hand.show_only_shape_key = False
    product.scale.x = 0.0
    take()
    product.scale.x = 1.0
    product.location.z += 5000.0 * stage.MM
    scene.thenar.use_force = True
    take()
    assert len(set(said)) == 3


@pytest.mark.parametrize(
    ("error", "typed"),
    [
        (
            'line 3: two columns hold force; leave one of them out, or name the one: force = "NAME" in study.toml, or '
            "--column force=NAME",
            ['force = "NAME"', "--column force=NAME"],
        ),
        (
            "line 11: shape 'middle' is not known; use one of plane, cylinder, sphere, punch, mesh",
            ["'middle'", "plane, cylinder, sphere, punch, mesh"],
        ),
        ("line 2: middle is no key of [skin]; use one of force, middle", ["force, middle"]),
        ('effect friction: law is "coulom", but must be one of coulomb, power', ['"coulom"', "coulomb, power"]),
        ('there is no effect "friktion"; there are adhesion, friction', ['"friktion"', "adhesion, friction"]),
        ("there is no column Force; the first is Time", ["Force", "Time"]),
        (
            "recording 'a' must say which of 3 mats of its file it is; add mat = \"...\" with one of Product, Force",
            ["Product, Force", 'mat = "'],
        ),
        ("no line of names holds force, depth", ["force, depth"]),
        ("no sheet of the workbook has columns time, force", ["time, force"]),
        (
            "line 1: which of its columns 'Time', 'Force' is the force, and which the depth or travel?; name them: "
            'force = "Force" and travel = "Depth" under [recordings.columns] in study.toml, or --column "force=Force" '
            '--column "travel=Depth"',
            ['force = "Force"', 'travel = "Depth"', '--column "travel=Depth"'],
        ),
        (
            "line 1: the indentation has no depth: which of 'Tool (mm)' is it; name it: travel = \"Tool (mm)\" "
            'under [recordings.columns] in study.toml, or --column "travel=Tool (mm)"; a minus before the name turns '
            "the sign",
            ['travel = "Tool (mm)"', '--column "travel=Tool (mm)"'],
        ),
        ("line 19: recording '0.5 mm/s, a' has no file; name the file, relative to the study's folder", [" file"]),
        ("line 6: g0_mpa is -1; give a number above zero", ["g0_mpa", "-1"]),
        ("line 18: direction is no list of three numbers; write it as [x, y, z]", ["direction", "[x, y, z]"]),
    ],
)
def test_what_is_to_be_typed_into_a_file_stays_as_it_is(language, error, typed):
    """Sentences of `rust/recordings` and `rust/contact`, with words that the interface has translations of."""
    words = sentences.shown("/x/study.toml, " * error.startswith("line") + error)
    rest = re.sub(r"'[^']*'|\"[^\"]*\"", "", words)
    for each in typed:
        assert each in words
        rest = rest.replace(each, "")
    assert not ENGLISH.search(rest), words


def test_the_words_that_stay_are_those_of_errors():
    assert not file_words.TEMPLATES - {*error_templates.everything()}


def test_a_recording_keeps_its_name_where_the_interface_has_such_a_word(language):
    assert languages.iface("Left") != "Left"
    in_one = (
        "In “Left”: Measured force lies 0.12 N above the simulation in the phase “x”, 12 standard errors of the noise "
    )
    for said in (in_one + "apart (p < 0.001).", "The handprint “Left” overlaps with simulated contact by 80 %."):
        assert "“Left”" in sentences.shown(said) != said


def test_a_comparison_of_several_recordings_keeps_their_names(scene, language):
    noise = "its depth hardly leaves the noise"
    about = {"measures": [], "worst": [], "print": None, "unknown": [noise]}
    recordings = [SimpleNamespace(name=name, **about) for name in ("Left", "Product", "Bob's hand, new")]
    state = scene.thenar_recordings.comparison
    filling.fill(state, SimpleNamespace(sentence="", notes=[], recordings=recordings), ("all", None, None))
    own = languages.table(language)[languages.SENTENCE, noise]
    assert [sentences.shown(note.name) for note in state.notes] == [f"“{each.name}”: {own}" for each in recordings]


def test_pictures_hold_errors_in_english(language):
    english = "No hand is chosen; pick the hand's mesh under Hand"
    status.set_last_error(f"thenar.solve: {english}")
    words = running.in_words(english)
    assert words != english == sizes._in_english(RuntimeError(f"Error: {words}\n"))
    assert sizes._in_english(RuntimeError("Error: another one\n")) == "another one"


def test_a_text_of_many_parts_takes_time_in_proportion_to_them(language, monkeypatch):
    """An importer's report; a look at each template for every pair of ends would hold up the window."""
    sentences.shown("Product"), sentences._shown.cache_clear()
    tried, alone = [], sentences._alone
    monkeypatch.setattr(sentences, "_alone", lambda text: tried.append(text) or alone(text))
    taken = []
    for parts in (10, 20, 400):
        tried.clear()
        sentences.shown("the file: " + "; ".join(f"line {number}: face is degenerate" for number in range(parts)))
        taken.append(len(tried))
    assert taken[0] < taken[1] < 2.5 * taken[0] and taken[2] == 1


FINDINGS = (
    "Parameters within their bounds do not explain the recordings: noise alone leaves as much with p < 0.001. In “a b”"
    ": measured force lies 0.12 N (8 % of the largest) above the simulation in the phase “x”, 12 standard errors of "
    "the noise apart (p < 0.001 after 30 looks); the simulation itself may be off by 5 %.",
    "Measured and simulated force differ by 0.1 N rms, 5 % of the largest; the noise is not known. In the frame of "
    "mean force, the areas of contact overlap by 80 %; the peak is 100 kPa measured and 120 kPa simulated.",
    "Around (1.0, 2.0, 3.0) mm (row 3, column 4 of the mat), within 5.0 mm, 'a', loading and holding at depths of "
    "0.10 to 1.00 mm, shows 3 kPa (2 to 4) more pressure than the simulation (p = 0.01); the place is known to 3.0 mm, "
    "and it stays with the skin when the mat is moved.",
    "The simulation lacks relaxation of the tissue and drainage of fluid from the tissue. It shows most while holding. "
    "At least 90 % of such findings were right in studies whose truth was known.",
    "Parameters within their bounds do not explain the recordings: noise alone leaves as much with p = 0.001. '0.5 "
    "mm/s, ball (a), number 0' and 7 more recordings, holding at depths of 1.13 to 1.14 mm, show 0.024 N (0.0192 to "
    "0.0287) more force than the simulation (p = 0.001).",
    "At the end of what is admissible lie the thickness_mm of region “a b” and mat's place of “c”.",
    "What is left of the curves is 3.0 times what noise and the simulation's own error leave; only what stands out "
    "from that was named.",
    "“Product, Force”: its depth hardly leaves the noise",
    "Something is missing, but these recordings cannot distinguish a thicker or thinner tissue over the bone from "
    "compliance of the fixture. Record next: X (settles it in 60 % of cases, takes about 30 minutes).",
)
"""As `sentence.rs` of the crate comparison and `verdict_sentence.rs` of diagnosis write them."""


@pytest.mark.parametrize("sentence", FINDINGS)
def test_whole_findings_hold_no_english_and_every_number(language, sentence):
    words = sentences.shown(sentence)
    assert not ENGLISH.search(words), words
    assert all(name in words for name in re.findall(r"(?<!\w)'[^']+'|“Product[^”]*”", sentence))
    assert sorted(re.findall(r"\d+(?:\.\d+)?", words)) == sorted(re.findall(r"\d+(?:\.\d+)?", sentence))


def test_no_error_quotes_a_name_by_its_representation():
    """`{name!r}` of O'Brien has other quotes than the template. What a file holds instead of a number may."""
    found = []
    for path in sorted((error_templates.ROOT / "addon").rglob("*.py")):
        if not path.relative_to(error_templates.ROOT).as_posix().startswith(error_templates.UNSEEN):
            values = [
                node for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.FormattedValue)
            ]
            found += [f"{path.name}: {ast.unparse(each.value)}" for each in values if each.conversion == ord("r")]
    numbers = ["settings.py: protocol.diameter_mm", "settings.py: protocol.turn_deg"]
    types = ["plain_pickle.py: found.text", "plain_pickle.py: self.text"]
    assert sorted(found) == ["files.py: version", *types, *numbers]


def test_planted_errors_are_extracted():
    python = (
        "def helper(side):\n    return f'no {side} there'\n"
        "def f(a, b):\n    why = 'it is wet' if a else f'it is {b.c:.2f} mm dry'\n"
        "    raise Refusal(f'the {a!r} failed: {why}; wait a bit')\n"
        "def g():\n    raise checks.Refusal(helper('left'))\n"
        "def h():\n    raise type(error)(f'in row {n}, {error}')\n"
        "def k():\n    raise AssertionError('never seen at all')\n"
    )
    tree = ast.parse(python)
    found = list(error_templates.raised(tree, error_templates.Sources([tree])))
    wanted = [
        "the '{a}' failed",
        "wait a bit",
        "it is wet",
        "it is {c} mm dry",
        "no {side} there",
        "in row {n}, {error}",
    ]
    assert sorted(set(found)) == sorted(wanted)
    rust = (
        '#[error("{}, line {line}: {problem}; look \\\n   at it")]\nlet x = format!("{:.2} of {n} is wet; dry it", y);'
    )
    assert list(error_templates.of_text(rust)) == [
        "{value1}, line {line}",
        "look at it",
        "{value1} of {n} is wet; dry it",
    ]


@pytest.mark.parametrize(("word", "raised"), [("Fehler", "Fehler: Boden: das\n"), ("エラー", "エラー: Boden: das\n")])
def test_what_another_operator_reported_loses_the_word_for_an_error(monkeypatch, word, raised):
    """As Blender 5.2.2 raises a report "Boden: das" in German and Japanese."""
    words = SimpleNamespace(pgettext_rpt=lambda _: word, pgettext_tip=lambda _: word)
    monkeypatch.setattr(languages, "bpy", SimpleNamespace(app=SimpleNamespace(translations=words)))
    assert languages.reported(RuntimeError(raised)) == "Boden: das"
    assert languages.reported(RuntimeError("Error: Boden: das\n")) == "Boden: das"
    assert importing.reason(RuntimeError(f"Info: read\n{raised}{word}: second.\n")) == "Boden: das"
