"""`thenar.diagnose`: schema, determinism, cancellation; what it says is tested in tests/trial."""

import json
import threading

import numpy as np
import pytest
import thenar

VERDICTS = {
    "nothing_missing",
    "parameters",
    "instrument",
    "missing_physics",
    "cannot_tell",
    "unlisted",
    "insufficient_data",
}
STUDY = """
[study]
title = "Ball"
[skin]
mesh = "skin.obj"
[skin.materials.default]
g0_mpa = 0.03
g_lim_mpa = 0.05
d_lim_mm = 4.0
thickness_mm = 9.0
[indenters.ball]
shape = "sphere"
radius_mm = 8.0
[sites.middle]
point_mm = [0.0, 0.0, 0.0]
direction = [0.0, 0.0, -1.0]
"""


def study(folder, repeats):
    """A ball pressed into a flat pad and held; forces grow as depth to the power 1.5 and fade by a fifth with 1 s."""
    side = np.arange(13) - 6.0
    lines = [f"v {x} {y} 0" for y in side for x in side]
    for corner in (row * 13 + column + 1 for row in range(12) for column in range(12)):
        lines.append(f"f {corner} {corner + 1} {corner + 14} {corner + 13}")
    (folder / "skin.obj").write_text("\n".join(lines) + "\n")
    time = np.linspace(0.0, 8.0, 81)
    depth = np.clip(time, 0.0, 0.8)
    random, text = np.random.default_rng(2), STUDY
    for repeat in range(repeats):
        fades = 1.0 - 0.2 * (1.0 - np.exp(-np.maximum(time - 0.8, 0.0)))
        force = 0.3 * depth**1.5 * fades + 0.001 * random.standard_normal(len(time))
        rows = "".join(f"{t},{d},{f}\n" for t, d, f in zip(time, depth, force, strict=True))
        (folder / f"press_{repeat}.csv").write_text("time_s,depth_mm,force_n\n" + rows)
        text += f'[[recordings]]\nname = "press {repeat}"\nkind = "indentation"\nfile = "press_{repeat}.csv"\n'
        text += 'indenter = "ball"\nsite = "middle"\nprotocol = "press"\n'
    (folder / "study.toml").write_text(text)
    return thenar.Study.load(folder)


def test_findings_keep_to_their_schema_and_repeat_bit_for_bit(tmp_path):
    told = []
    found = thenar.diagnose(study(tmp_path, 3), lambda stage, share: told.append(share))
    assert told == sorted(told) and told[-1] == 1.0
    said = json.loads(found.to_json())
    assert said["schema"] == 1 and said["verdict"] in VERDICTS and said["verdict"] == found.verdict
    assert said["sentence"] == found.sentence and found.sentence in found.report_html().replace("&#39;", "'")
    keys = {"findings", "names_90", "cannot_tell", "fit", "smallest_seen", "record_next", "model"}
    assert keys <= set(said) and set(said["model"]) == {"materials", "effects"}
    for one in said["findings"]:
        assert one["kind"] in ("tissue", "instrument") and 0.0 <= one["posterior"] <= 1.0
        assert one["confidence"] is None or one["confidence"] <= one["posterior"]
        assert all({"value", "low", "high", "unit"} == set(number) for number in one["parameters"].values())
    assert thenar.diagnose(study(tmp_path, 3), seed=1).to_json() == found.to_json()


def test_one_ball_cannot_tell_two_clocks_apart(tmp_path):
    said = json.loads(thenar.diagnose(study(tmp_path, 3)).to_json())
    assert said["verdict"] == "cannot_tell" and ["relaxation", "drainage"] in said["cannot_tell"]
    assert said["findings"] == [] and said["record_next"][0]["protocol"]["radius_mm"] > 16.0


def test_one_press_is_too_little(tmp_path):
    said = json.loads(thenar.diagnose(study(tmp_path, 1)).to_json())
    assert said["verdict"] == "insufficient_data" and said["findings"] == []


def test_a_diagnosis_can_be_cancelled(tmp_path):
    event = threading.Event()
    event.set()
    with pytest.raises(thenar.Cancelled):
        thenar.diagnose(study(tmp_path, 2), cancel=event)
