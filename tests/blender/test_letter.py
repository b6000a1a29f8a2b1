"""Rows of a finding in the letter, from findings alone."""

import letters
from thenar_blender.diagnosis import letter


def test_the_letter_tells_the_law_and_measure_that_the_model_switches_on():
    switched = {"name": "stiffening_law", "amplitude": 1.0, "law": "power", "measure": "depth", "reference": 1.3}
    named = {"effect": "stiffening_law", "kind": "tissue", "confidence": 0.9, "parameters": {}}
    model = {"materials": {}, "effects": [switched]}
    found = letters.FINDINGS["missing_physics"] | {"findings": [named], "model": model}
    (entry,) = letter.write(found).entries
    assert [(row.label, row.text) for row in entry.rows] == [("Law", "Power"), ("Measure", "Depth")]


def test_an_amplitude_that_only_says_whole_is_left_out_beside_other_numbers():
    whole = {"value": 1.0, "low": 1.0, "high": 1.0, "unit": "1"}
    modulus = {"value": 0.2, "low": 0.1, "high": 0.3, "unit": "MPa"}
    part = {"value": 0.34, "low": 0.31, "high": 0.37, "unit": "1"}

    def labels(parameters):
        named = {"effect": "stiff_skin", "kind": "tissue", "confidence": 0.9, "parameters": parameters}
        (entry,) = letter.write(letters.FINDINGS["missing_physics"] | {"findings": [named]}).entries
        return [row.label for row in entry.rows]

    assert labels({"amplitude": whole, "modulus_mpa": modulus}) == ["Modulus"]
    assert labels({"amplitude": part, "modulus_mpa": modulus}) == ["Amplitude", "Modulus"]
    assert labels({"amplitude": whole}) == ["Amplitude"]
