"""Paragraphs in Chinese and Japanese end their lines where those may end, and English ones where they did."""

import random
import re

import pytest
import tables
from thenar_blender import languages
from thenar_blender.panels import lists, text
from thenar_blender.rigs import skin_regions

OPENS, CLOSES = "「（“", "、。，；：」）”"


def plain(words, letters):
    """Lines by words alone, by its own code."""
    lines = [""]
    for word in words.split():
        if lines[-1] and len(lines[-1]) + 1 + len(word) > letters:
            lines.append("")
        lines[-1] = (lines[-1] + " " + word).strip()
    return lines


def test_english_lines_are_those_of_words():
    drawn = random.Random(4)
    letters = "abcdefghijklmnop.,;"
    for _ in range(200):
        words = " ".join("".join(drawn.choices(letters, k=drawn.randint(1, 12))) for _ in range(drawn.randint(1, 30)))
        wide = drawn.randint(14, 50)
        assert text.wrapped(words, wide) == plain(words, wide)


@pytest.mark.parametrize("name", ["ja", "zh"])
@pytest.mark.parametrize("letters", [20, 37])
def test_lines_of_every_translation_fit_and_lose_nothing(name, letters):
    for words in tables.entries(name).values():
        lines = text.wrapped(words, letters)
        assert re.sub(r"\s", "", "".join(lines)) == re.sub(r"\s", "", words)
        for line in lines:
            assert sum(2 if ord(letter) > 0x2E80 else 1 for letter in line) <= letters + 2, line
        for before, after in zip(lines, lines[1:], strict=False):
            if ord(before[-1]) > 0x2E80 or ord(after[0]) > 0x2E80:
                assert before[-1] not in OPENS and after[0] not in CLOSES, (before, after)


@pytest.mark.parametrize("name", ["de", "ja", "zh"])
def test_names_of_regions_fit_next_to_their_numbers(name):
    """13 Latin letters of Blender's font fit there at the sidebar's default width: "Middle distal" does in English."""
    held = languages.table(name)
    names = [held[languages.OWN, lists.brief(region)] for region in skin_regions.NAMES]
    assert not [each for each in names if text.room(each) > 13]


@pytest.mark.parametrize("name", ["de", "ja", "zh"])
def test_names_of_results_fit_next_to_their_numbers(name):
    held = languages.table(name)
    rows = ["Force", "Contact area", "Peak pressure", "Peak over 24 mm²", "Mean pressure", "Max. overlap"]
    rows += ["Product offset", "Grip yields", "Shear force", "Peak shear", "Slipping area", "Max. shear force"]
    rows += ["Penetration", "Write-back error", "Complementarity", "Slip dissipation", "Work on skin"]
    assert not [held[languages.OWN, row] for row in rows if text.room(held[languages.OWN, row]) > 18]
