"""Sentences of the native module as a person reads them: unchanged, under the scene's names, those of one kind once."""

from types import SimpleNamespace

import thenar
from thenar_blender.results import sentences

NAMES = ("thumb_distal_pad", "palm", "Region.001")


def job(hand, *parts):
    return SimpleNamespace(hand_name=hand, part_names=parts, region_names=NAMES)


def remark(kind, text, region=None):
    return SimpleNamespace(kind=kind, text=text, region=region)


def test_an_error_keeps_its_sentence_and_its_vertices_behind_the_names_of_the_objects():
    error = thenar.SolveError("the hand lies in region 1 of the product")
    error.vertices = [3, 4]
    told = sentences.named(error, job("Ann", "Mug", "Lid"))
    assert type(told) is thenar.SolveError
    assert str(told) == "'Ann' on 'Mug, Lid': the hand lies in region 1 of the product"
    assert told.vertices == [3, 4]
    assert str(sentences.named(thenar.MeshError("a hole"), job("Ann"))) == "'Ann': a hole"


def test_remarks_of_one_kind_are_told_once_with_the_other_regions():
    contact = SimpleNamespace(
        remarks=[
            remark("beyond_theory", "region 'a' is 4.7 mm deep", 1),
            remark("beyond_theory", "region 'b' is 12 mm deep", 0),
            remark("no_contact", "no skin touches"),
            remark("beyond_theory", "region 'c' is 3 mm deep", 2),
            remark("note", "the skin is open"),
            remark("note", "the product is open"),
            remark("note", "the product is open"),
        ]
    )
    assert sentences.remarks(contact, job("Ann", "Mug")) == [
        "region 'a' is 4.7 mm deep (also: Thumb distal pad, Region.001)",
        "no skin touches",
        "the skin is open",
        "the product is open",
    ]


def test_regions_named_as_data_are_read_in_words_and_others_as_they_are():
    assert sentences.region_title("index_distal_pad") == "Index distal pad"
    assert sentences.region_title("palm") == "Palm"
    for own in ("DEF-index_01.L", "Left_Hand", "a b", "2nd_pad", "", 'f"{x}"'):
        assert sentences.region_title(own) == own
