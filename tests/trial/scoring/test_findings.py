"""What a findings.json must look like: a whole one passes, and every way to break it is told."""

import copy

import pytest
from trial.scoring import findings

WHOLE = {
    "schema": 1,
    "verdict": "missing_physics",
    "sentence": "Relaxation is missing.",
    "findings": [
        {
            "effect": "relaxation",
            "kind": "tissue",
            "confidence": 0.97,
            "parameters": {"time_1_s": {"value": 0.4, "low": 0.3, "high": 0.6, "unit": "s"}},
            "when": {"phase": "hold"},
        }
    ],
    "names_90": [["relaxation"], ["relaxation", "drift"]],
    "cannot_tell": [],
    "fit": {"held_out": ["slow"], "before": {"rms": 0.2, "unit": "N", "low": 0.1, "high": 0.3}},
    "record_next": [{"text": "Hold for 60 s.", "protocol": {"hold_s": 60.0}, "probability": 0.9, "minutes": 3}],
}
BROKEN = [
    ("schema", 2, "schema is 2, not 1"),
    ("verdict", "sick", "there is no verdict 'sick'"),
    ("verdict", "nothing_missing", "the verdict is nothing_missing, and there are findings"),
    ("verdict", "instrument", "the verdict is instrument, and the findings are not all of kind instrument"),
    ("verdict", "cannot_tell", "no names are told that cannot be told apart"),
    ("sentence", " ", "there is no sentence"),
    ("findings", None, "no list: findings"),
    ("findings", [], "the verdict is missing_physics, and no finding is of kind tissue"),
    ("findings.0.effect", "magic", "there is no effect 'magic'"),
    ("findings.0.kind", "instrument", "relaxation is of kind tissue, not 'instrument'"),
    ("findings.0.confidence", 1.2, "confidence is 1.2, not between 0 and 1"),
    ("findings.0.confidence", float("nan"), "findings[0].confidence is not finite"),
    ("findings.0.confidence", None, "confidence is None, not between 0 and 1"),
    ("findings.0.posterior", -0.1, "posterior is -0.1, not between 0 and 1"),
    ("findings.0.parameters.time_1_s.low", 0.5, "its value lies outside its interval"),
    ("findings.0.parameters.time_1_s.unit", None, "time_1_s has no unit"),
    ("findings.0.when.phase", "dance", "there is no phase 'dance'"),
    ("names_90", ["relaxation"], "'relaxation' is no list of names"),
    ("names_90.0.0", "magic", "names_90: there is no effect 'magic'"),
    ("suspected", ["magic"], "suspected: there is no effect 'magic'"),
    ("suspected", ["relaxation"], "relaxation is suspected, and found"),
    ("record_next.0.text", "", "it has no text"),
    ("record_next.0.probability", 90, "probability is 90, not between 0 and 1"),
    ("fit.before.low", 0.25, "fit.before: its value lies outside its interval"),
]


def test_a_whole_one_passes():
    assert findings.faults(WHOLE) == []


@pytest.mark.parametrize(("path", "value", "sentence"), BROKEN)
def test_every_break_is_told(path, value, sentence):
    broken = copy.deepcopy(WHOLE)
    *way, last = path.split(".")
    inner = broken
    for key in way:
        inner = inner[int(key) if isinstance(inner, list) else key]
    inner[int(last) if isinstance(inner, list) else last] = value
    assert any(sentence in fault for fault in findings.faults(broken)), findings.faults(broken)
