"""Sentences of results are kept in English and shown in the user's language, with the numbers and names they hold."""

import re

import bpy
import pytest
import sentence_templates
import stage
from thenar_blender import languages
from thenar_blender.languages import sentences
from thenar_blender.panels import text

ENGLISH = re.compile(r"\b(?:the|is|are|and|of|inside|product)\b")
"""Words that no translation holds."""


def filled(template):
    """The sentence with a number in each field, and the numbers."""
    names = dict.fromkeys(re.findall(r"\{(\w+)\}", template))
    values = {name: f"{3 + k}.25" for k, name in enumerate(names)}
    return template.format(**values), sorted(values.values())


def test_every_template_is_found_again_in_its_sentence_with_all_numbers(language):
    for template in sentence_templates.everything():
        sentence, numbers = filled(template)
        words = sentences.shown(sentence)
        wanted = languages.table(language)[languages.SENTENCE, template]
        assert words == wanted.format(**dict(zip(re.findall(r"\{(\w+)\}", template), numbers, strict=True))), template
        assert not ENGLISH.search(words), words
        assert sentences.shown(sentence[:1].upper() + sentence[1:]) == words


def solved(scene):
    """The reason and the notes of a solve."""
    bpy.ops.thenar.solve()
    result = scene.thenar.result
    return [each for each in (result.reason, *(note.name for note in result.warnings)) if each]


def test_reason_and_notes_of_real_results_hold_no_english(scene, language):
    """A deep press, no contact, a product inside the hand, a coarse product with a hole, and a comfort rule."""
    said = []
    hand, product = stage.scene(cuts=2)
    hand.vertex_groups.new(name="index_distal_pad").add(range(len(hand.data.vertices)), 1.0, "REPLACE")
    scene.thenar.comfort.rule = "BLOOD_FLOW"
    for move_mm in (1.0, 5.0, -20.0):
        product.location.z += move_mm * stage.MM
        said += solved(scene)
        said += [scene.thenar.result.comfort]
    product.scale = (0.05, 0.05, 0.05)
    product.location = hand.location
    said += solved(scene)
    said = [each for each in dict.fromkeys(said) if each]
    assert len(said) > 4, said
    for sentence in said:
        words = text.spoken(sentence)
        assert words != sentence and not ENGLISH.search(words), (sentence, words)
        numbers = re.findall(r"\d+\.\d+", sentence)
        assert sorted(re.findall(r"\d+\.\d+", words)) == sorted(numbers), (sentence, words)


def test_the_name_of_a_region_inside_a_sentence_is_translated(language):
    sentence = "region 'Index distal pad' is pressed 4.70 mm deep, more than its 4.00 mm of soft tissue: forces there "
    words = sentences.shown(sentence + "are not to be trusted (also: Middle distal pad, Own)")
    for name in ("Index distal pad", "Middle distal pad"):
        assert name not in words and languages.table(language)[languages.OWN, name] in words
    assert "Own" in words and "4.70" in words and "4.00" in words


@pytest.mark.parametrize(
    "sentence",
    [
        "a Mirror modifier on '{0}': only the modelled half was pressed; its mirror image repeats it",
        "'{0}' is not in this bake and shows no pressure of it",
        "renders show '{0}' of '{1}' at level 2, the view at 1: the skin was checked at the view's; set both alike for "
        "a certified picture",
        "a copy of '{0}', '{1}' in 'Thenar Results' carries the pressure: it is a curve",
        "a copy of '{0} and {1}', 'no, {0}, {1}' in 'Thenar Results' carries the pressure: it is a curve",
    ],
)
def test_names_of_objects_stay_as_the_user_finds_them_in_the_scene(language, sentence):
    """Also those that are words of the interface, which has a translation for them."""
    known = ["Product", "Light", "Hand"]
    assert any(languages.iface(name) != name for name in known)
    for first, second in zip(known, known[1:] + known[:1], strict=True):
        words = sentences.shown(sentence.format(first, second))
        assert words != sentence.format(first, second)
        for name in re.findall(r"'([^']+)'", sentence.replace("view's", "view")):
            assert name.format(first, second) in words


def test_a_sentence_of_no_template_stays_as_it_is(language):
    for sentence in (
        "",
        "something else",
        "a hand of 3 mm",
        "region",
        "the hand is in the product",
        "it is a long story",
    ):
        assert sentences.shown(sentence) == sentence


def test_in_english_every_sentence_stays_as_it_is():
    for template in sentence_templates.everything():
        assert sentences.shown(filled(template)[0]) == filled(template)[0]


def test_planted_sentences_are_extracted_from_both_languages():
    rust = 'write!(f, "left {a:.2} of \\\n   {b} and {}", if x { "one row" } else { "more rows" })'
    assert sentence_templates.of_rust(rust) == ["left {a} of {b} and one row", "left {a} of {b} and more rows"]
    python = 'def f(a):\n    """Doc string here."""\n    yield f"left {a.b:.2f} of {len(c)} and {a.b}"'
    assert sentence_templates.of_python(python, {"f"}) == ["left {b} of {len} and {b2}"]
    assert sentence_templates.of_python(python, {"g"}) == []
