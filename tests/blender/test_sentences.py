"""Sentences of the native module as a person reads them: with the scene's names, and those that are alike once."""

from types import SimpleNamespace

from thenar_blender import sentences

NAMES = ("thumb pad", "palm")


def job(hand, *parts):
    return SimpleNamespace(hand_name=hand, part_names=parts, region_names=NAMES)


def test_sentences_bear_the_names_of_the_objects_and_regions():
    text = "the hand lies inside the product; region 1 has no bone, region 7 neither"
    wanted = "the hand 'Ann' lies inside the product 'Mug, Lid'; region 'palm' has no bone, region '7' neither"
    assert sentences.named(text, job("Ann", "Mug", "Lid")) == wanted
    assert sentences.named(text, job("Bob", "Bar")).startswith("the hand 'Bob' lies inside the product 'Bar'")


def test_a_name_that_is_there_is_not_put_a_second_time():
    assert sentences.named("The hand 'Cid' is open", job("Ann", "Mug")) == "The hand 'Cid' is open"


def test_notes_that_differ_by_names_and_numbers_are_told_once():
    notes = ["region 'a' is 4.7 mm deep", "region 'b' is 12 mm deep", "the skin is open", "region 'c' is 3 mm deep"]
    assert list(sentences.joined(notes)) == ["region 'a' is 4.7 mm deep (2 more such)", "the skin is open"]
