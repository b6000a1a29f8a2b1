"""Grasp studies whose parts do not fit each other are refused with the reason; none ends in a verdict or a panic."""

import json
import re
import shutil
from pathlib import Path

import pytest
import thenar

SAMPLE = Path(__file__).parents[3] / "addon" / "sample_studies" / "held_handle"
CELLS = re.compile(r"^[\d.,\s-]+,[\d.,\s-]+$")


def copied(folder):
    """The sample study, writable."""
    for file in SAMPLE.iterdir():
        shutil.copyfile(file, folder / file.name)
    return folder


def rewritten(path, change):
    path.write_text("\n".join(map(change, path.read_text().splitlines())) + "\n")


def moved(line):
    """A vertex of the product 300 mm aside."""
    if not line.startswith("v "):
        return line
    x, y, z = map(float, line.split()[1:4])
    return f"v {x + 300.0} {y} {z}"


def far_product(folder):
    rewritten(folder / "handle.obj", moved)


def turned_mat(folder):
    rewritten(folder / "study.toml", lambda line: line.replace('turn = "right"', 'turn = "left"'))


def mat_elsewhere(folder):
    rewritten(folder / "study.toml", lambda line: re.sub(r"origin_mm = .*", "origin_mm = [-50.7, 32.0, -322.0]", line))


def silent_mat(folder):
    for number in (1, 2, 3):
        rewritten(folder / f"hold_{number}.asf", lambda line: re.sub(r"\d+", "0", line) if CELLS.match(line) else line)


def narrow_mat(folder):
    change = {True: lambda line: ",".join(line.split(",")[:30]), False: lambda line: line}
    rewritten(folder / "hold_1.asf", lambda line: change[bool(CELLS.match(line))](line).replace("COLS 38", "COLS 30"))


def pulled(folder):
    def negative(line):
        time, _, force = line.partition(",")
        return f"{time},-{force}" if force[:1].isdigit() else line

    rewritten(folder / "force_1.csv", negative)


CASES = (
    (far_product, "the hand does not touch the product"),
    (
        turned_mat,
        r"only \d+ % of the load of 'hold, 1' lies where the hand touches the product",
    ),
    (mat_elsewhere, r"only \d+ % of the load of 'hold, 1'|'hold, 1' reads nothing"),
    (silent_mat, "'hold, 1' reads nothing"),
    (narrow_mat, "'hold, 1' and 'hold, 2' have different cells"),
    (pulled, "the force trace of 'hold, 1' does not cover the hold with forces above zero"),
)


@pytest.mark.parametrize(("damage", "reason"), CASES, ids=lambda each: getattr(each, "__name__", ""))
def test_what_does_not_fit_is_refused_with_the_reason(damage, reason, tmp_path):
    damage(copied(tmp_path))
    with pytest.raises(thenar.ThenarError, match=reason):
        thenar.diagnose(thenar.Study.load(tmp_path))


def test_a_trace_is_read_between_its_readings(tmp_path):
    """From the second reading on the trace is 0.2 s late, so that stretches of one frame hold no reading."""

    def late(line):
        time, _, force = line.partition(",")
        return f"{float(time) + 0.2:.3f},{force}" if time[:1].isdigit() and float(time) > 0.0 else line

    copied(tmp_path)
    for number in (1, 2, 3):
        rewritten(tmp_path / f"force_{number}.csv", late)
    found = json.loads(thenar.diagnose(thenar.Study.load(tmp_path)).to_json())
    assert [each["effect"] for each in found["findings"]] == ["relaxation"], found["sentence"]
    assert not any("no force trace was recorded" in note for note in found["notes"])
