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
