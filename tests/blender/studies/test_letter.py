"""Rows of a finding in the letter, from findings alone."""

import letters
import pytest
from thenar_blender.diagnosis import letter


def test_the_letter_tells_the_law_and_measure_that_the_model_switches_on():
    switched = {"name": "stiffening_law", "amplitude": 1.0, "law": "power", "measure": "depth", "reference": 1.3}
    named = {"effect": "stiffening_law", "kind": "tissue", "confidence": 0.9, "parameters": {}}
    model = {"materials": {}, "effects": [switched]}
    found = letters.FINDINGS["missing_physics"] | {"findings": [named], "model": model}
    (entry,) = letter.write(found).entries
    assert [(row.label, row.text) for row in entry.rows] == [("Law", "Power"), ("Measure", "Depth")]


def test_the_letter_tells_what_something_without_a_name_goes_with():
    depends = [{"on": "depth", "removed": 0.71}, {"on": "contact_radius", "removed": 0.3}]
    nameless = {"depends_on": depends, "correction": {"kind": "empirical"}, "rhythm": None}
    written = letter.write(letters.FINDINGS["unlisted"] | {"unlisted": nameless})
    assert [(bar.label, bar.text, bar.share) for bar in written.depends] == [
        ("depth", "71 %", 0.71),
        ("size of the contact", "30 %", 0.3),
    ]
    assert "Depends on depth: 71 %" in letter.lines(written)
    either = {"unlisted": nameless, "names_90": [["relaxation"], ["drainage"]]}
    assert letter.write(letters.FINDINGS["unlisted"] | either).rivals == ()
    beats = {
        "depends_on": [{"on": "force", "removed": None}],
        "rhythm": {"hz": 1.18, "per_minute": 70.8, "chance": 1e-5},
    }
    beating = letter.write(letters.FINDINGS["unlisted"] | {"unlisted": beats})
    assert [bar.text for bar in beating.depends] == ["1.18 Hz, 71/min"]
    assert "repeats" in beating.depends_note and "correction" in written.depends_note
    assert letter.write(letters.FINDINGS["missing_physics"]).depends == ()


def test_what_is_suspected_only_is_said_to_be_no_finding():
    """By the findings' own data: their sentence may have any words."""
    doubted = letters.FINDINGS["parameters"] | {"suspected": ["stiff_skin"], "is_more_than_noise": True}
    written = letter.write(doubted)
    assert written.heading == letter.UNNAMED and written.entries == ()
    (said,) = written.rivals
    assert "Suspected only" in said and "stiff skin" in said.lower()
    plain = letter.write(doubted | {"suspected": [], "is_more_than_noise": False})
    assert plain.heading == letter.HEADINGS["parameters"] and plain.rivals == ()
    for verdict in ("unlisted", "cannot_tell"):
        open_still = letter.write(letters.FINDINGS[verdict] | {"is_more_than_noise": True})
        assert open_still.heading == letter.HEADINGS[verdict]


@pytest.mark.parametrize("verdict", ["nothing_missing", "parameters"])
def test_findings_of_earlier_versions_have_the_heading_of_their_sentence(verdict):
    """They have no key for what is left: their sentence says it, as `verdict_sentence.rs` wrote it then as now."""
    of_then = {key: kept for key, kept in letters.FINDINGS["parameters"].items() if key != "is_more_than_noise"}
    of_then["verdict"] = verdict
    unsettled = letter.write(of_then | {"sentence": "No effect is named, though the recordings differ."})
    assert unsettled.heading == letter.UNNAMED
    for sentence in ("Nothing is missing: they agree.", "", None):
        assert letter.write(of_then | {"sentence": sentence}).heading == letter.HEADINGS[verdict]


def test_evidence_by_phase_is_that_of_force_over_depth_alone():
    """A mat's ceiling is named as a force's saturation is, and friction stands next to what the curves show."""
    named = {"kind": "tissue", "confidence": 0.9, "parameters": {}}
    law = named | {"effect": "stiffening_law", "channel": "force"}
    friction = named | {"effect": "friction", "channel": "tangential_force"}
    ceiling = named | {"effect": "saturation", "channel": "map"}
    rivals = [
        {"effects": ["stiffening_law"], "evidence": 9.0, "ledger": {"load": 3.0, "hold": 1.0}},
        {"effects": ["saturation"], "evidence": 2.0, "ledger": {"load": 1.0, "hold": 1.0}},
    ]

    def phases(*findings):
        changed = {"findings": list(findings), "rivals": rivals}
        return [bar.text for bar in letter.write(letters.FINDINGS["missing_physics"] | changed).phases]

    assert phases(law) == phases(law, friction) == ["75 %", "25 %"]
    assert phases(ceiling) == []


def test_confidence_has_its_track_record_or_is_said_not_to_be_measured():
    named = {"effect": "relaxation", "kind": "tissue", "confidence": 0.93, "posterior": 0.99, "parameters": {}}
    record = {"kind": "skin_form_known", "right": 48, "stated": 49}

    def lines(finding):
        return list(letter.lines(letter.write(letters.FINDINGS["missing_physics"] | {"findings": [finding]})))

    measured = lines(named | {"track_record": record})
    assert "1. Relaxation, 93 % confidence" in measured
    assert "   Track record: right in 48 of 49 such findings of calibration studies" in measured
    unknown = record | {"right": None, "stated": None}
    unmeasured = lines(named | {"confidence": None, "track_record": unknown})
    assert "1. Relaxation, confidence not measured" in unmeasured
    assert not any("Track record" in line or "99 % confidence" in line for line in unmeasured)


def test_a_number_of_a_list_keeps_its_place_only_next_to_others():
    finding = {"kind": "tissue", "confidence": 0.9, "effect": "relaxation", "channel": "map"}
    alone = {"amplitude": {"value": 0.2, "unit": "1"}, "time_3_s": {"value": 5.0, "unit": "s"}}
    several = alone | {"time_1_s": {"value": 0.2, "unit": "s"}}

    def labels(numbers):
        changed = {"findings": [finding | {"parameters": numbers}]}
        return [row.label for row in letter.write(letters.FINDINGS["missing_physics"] | changed).entries[0].rows]

    assert labels(alone)[:2] == ["Amplitude", "Time"]
    assert labels(several)[:3] == ["Amplitude", "Time 3", "Time 1"]
