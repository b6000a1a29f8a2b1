"""Findings of every verdict, written by hand to the schema of findings.json, and a library that answers with them."""

import json

FINDINGS = {
    "missing_physics": {
        "schema": 1,
        "verdict": "missing_physics",
        "sentence": "The skin gives way under a held load: a third of the force is gone after 30 s.",
        "findings": [
            {
                "effect": "relaxation",
                "kind": "tissue",
                "confidence": 0.97,
                "parameters": {
                    "amplitude": {"value": 0.34, "low": 0.31, "high": 0.37, "unit": "1"},
                    "time_3_s": {"value": 1.9, "low": 1.6, "high": 2.3, "unit": "s"},
                },
                "where": {"site": "pad", "region": None, "center_mm": None, "radius_mm": None, "vertices_csv": None},
                "when": {
                    "recordings": ["slow 1", "slow 2", "fast 1", "fast 2", "hold"],
                    "phase": "hold",
                    "time_s": [0.8, 30.0],
                    "depth_mm": [1.2, 2.0],
                    "cycles": None,
                },
                "depends_on": ["time", "rate"],
                "consequences": [
                    {"sentence": "force at held depth falls with time", "holds": True},
                    {"sentence": "fast presses need more force than slow ones", "holds": False},
                ],
            },
            {
                "effect": "bone",
                "kind": "tissue",
                "confidence": 0.91,
                "parameters": {"thickness_mm": {"value": 2.0, "low": 1.8, "high": 2.3, "unit": "mm"}},
                "where": {"site": "pad", "region": None, "center_mm": None, "radius_mm": None, "vertices_csv": None},
                "when": {"recordings": ["slow 1"], "phase": "load"},
                "depends_on": ["depth", "radius"],
            },
        ],
        "names_90": [["relaxation", "bone"]],
        "cannot_tell": [],
        "fit": {
            "held_out": ["sphere 1", "sphere 2"],
            "before": {"rms": 0.21, "unit": "N", "low": 0.18, "high": 0.24},
            "after": {"rms": 0.05, "unit": "N", "low": 0.04, "high": 0.06},
            "noise_floor": {"rms": 0.03, "unit": "N", "low": 0.02, "high": 0.04},
            "reducible_error_removed": {"value": 0.96, "low": 0.91, "high": 0.998},
            "log_score": {"value": 374.5, "unit": "nats", "placebo": 35.3},
        },
        "smallest_seen": {
            "adhesion": {"value": 0.02, "unit": "J/m2"},
            "bone": {"value": 0.172, "unit": "share of the thickness"},
            "relaxation": {"value": 6.1, "unit": "share of the force"},
            "saturation": {"value": None, "unit": "share of the force"},
        },
        "record_next": [],
        "model": {
            "materials": {"default": {"g0_mpa": 0.0203, "g_lim_mpa": 0.09}},
            "effects": [{"name": "relaxation", "amplitude": 0.34, "time_2_s": 0.5, "time_3_s": 9.0}],
        },
        "rivals": [
            {"effects": ["relaxation"], "evidence": 9.0, "ledger": {"load": 1.0, "hold": 1.0}},
            {
                "effects": ["bone", "relaxation"],
                "evidence": 30.0,
                "ledger": {"load": 5.0, "hold": 15.0, "unload": -2.0, "rest": None},
            },
        ],
        "notes": ["the evidence leads by 21 nats"],
    },
    "cannot_tell": {
        "schema": 1,
        "verdict": "cannot_tell",
        "sentence": "Force fades while holding, by relaxation or by drainage; one tool cannot tell which.",
        "findings": [
            {
                "effect": "relaxation",
                "kind": "tissue",
                "confidence": 0.55,
                "parameters": {"amplitude": {"value": 0.3, "low": 0.2, "high": 0.4, "unit": "1"}},
                "where": {"site": "pad", "region": None},
                "when": {"recordings": ["hold"], "phase": "hold"},
                "depends_on": ["time"],
            }
        ],
        "names_90": [["relaxation"], ["drainage"]],
        "cannot_tell": [["relaxation", "drainage"]],
        "fit": {},
        "smallest_seen": {},
        "record_next": [
            {
                "text": "Hold a sphere of 16 mm or more at the same depth for 30 s, twice.",
                "protocol": {"indenter": "sphere", "radius_mm": 16.0, "hold_s": 30.0, "repeats": 2},
                "settles": ["relaxation", "drainage"],
                "probability": 0.87,
                "minutes": 4,
            }
        ],
        "model": {"materials": {}, "effects": []},
    },
    "instrument": {
        "schema": 1,
        "verdict": "instrument",
        "sentence": "The load cell drifts by 0.1 N a minute, with and without contact.",
        "findings": [
            {
                "effect": "drift",
                "kind": "instrument",
                "confidence": 0.99,
                "parameters": {"rate_n_per_min": {"value": 0.1, "low": 0.09, "high": 0.11, "unit": "N/min"}},
                "where": {},
                "when": {"recordings": ["hold"], "phase": "rest"},
                "depends_on": ["time"],
            }
        ],
        "names_90": [["drift"]],
        "cannot_tell": [],
        "fit": {},
        "smallest_seen": {},
        "record_next": [],
        "model": {"materials": {}, "effects": []},
    },
    "unlisted": {
        "schema": 1,
        "verdict": "unlisted",
        "sentence": "Something beats at 1.2 Hz; that is not in the list.",
        "findings": [
            {
                "effect": "unlisted",
                "kind": "tissue",
                "confidence": 0.9,
                "parameters": {},
                "where": {"site": "pad"},
                "when": {"recordings": ["hold"], "phase": "hold"},
                "depends_on": ["time"],
            }
        ],
        "names_90": [],
        "cannot_tell": [],
        "fit": {},
        "smallest_seen": {},
        "record_next": [],
        "model": {"materials": {}, "effects": []},
    },
}
"""Findings by verdict."""
for _verdict in ("nothing_missing", "parameters", "insufficient_data"):
    FINDINGS[_verdict] = {
        "schema": 1,
        "verdict": _verdict,
        "sentence": f"This is {_verdict.replace('_', ' ')}.",
        "findings": [],
        "names_90": [],
        "cannot_tell": [],
        "fit": {},
        "smallest_seen": {"bone": {"value": 0.4, "unit": "mm"}},
        "record_next": [],
        "model": {"materials": {}, "effects": []},
    }


def inclusion(center_mm, radius_mm, region=None):
    """Findings that name one stiff place."""
    found = json.loads(json.dumps(FINDINGS["instrument"]))
    found["verdict"], found["sentence"] = "missing_physics", "One place is four times as stiff."
    found["findings"] = [
        {
            "effect": "inclusion",
            "kind": "tissue",
            "confidence": 0.95,
            "parameters": {
                "radius_mm": {"value": radius_mm, "low": 2.0, "high": 4.0, "unit": "mm"},
                "contrast": {"value": 4.0, "low": 3.0, "high": 5.0, "unit": "1"},
            },
            "where": {
                "site": "pad",
                "region": region,
                "center_mm": [float(x) for x in center_mm],
                "radius_mm": radius_mm,
            },
            "when": {"recordings": ["slow 1"], "phase": "load"},
            "depends_on": ["skin_position"],
        }
    ]
    found["names_90"] = [["inclusion"]]
    return found


class Answer:
    """What `thenar.diagnose` returns, with these findings."""

    def __init__(self, found):
        self._found = found

    @property
    def curves(self):
        time = [0.1 * k for k in range(200)]
        force = [1.0 + 0.01 * k for k in range(200)]
        rising = {"time_s": time, "measured_n": force, "before_n": [2.0] * 200, "after_n": force}
        return [{"recording": name, **rising} for name in ("other", "hold", "slow 2", "slow 1")]

    def to_json(self):
        return json.dumps(self._found, indent=1)

    def report_html(self):
        return f"<!DOCTYPE html><p>{self._found['sentence']}</p>"
