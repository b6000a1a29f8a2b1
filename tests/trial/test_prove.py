"""Running the trial: verdicts are kept and not asked for twice, wrong exits are told, advice is followed."""

import functools
import json
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest
from trial import cases, prove, running, subset
from trial.scoring import counts, following, mutations, page, score
from trial.scoring.test_score import right

ROOT = Path(__file__).parents[2]
PROGRAM = ROOT / "target/release/thenar"
NARROW = next(name for name in cases.names("trial") if len(cases.index()[name].get("published", [])) == 2)


class Counting:
    """Stands for a diagnosis: says what it is told to and counts how often it was asked."""

    def __init__(self, said, key="a"):
        self.said, self.key, self.asked = said, key, 0

    def diagnose(self, study, out):
        self.asked += 1
        if isinstance(self.said, Exception):
            raise self.said
        out.mkdir()
        (out / "findings.json").write_text(json.dumps(self.said))


def program(path, text):
    """An executable that answers like `thenar`."""
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return running.Binary(path)


def answered(diagnosis, place, case=NARROW):
    return running.answer(diagnosis, functools.partial(cases.write, case), place)


def test_a_verdict_is_kept_until_the_diagnosis_or_the_case_changes(tmp_path):
    one, other = Counting({"verdict": "parameters"}), Counting({"verdict": "unlisted"}, "b")
    for _ in range(2):
        assert json.loads(answered(one, tmp_path).read_text()) == {"verdict": "parameters"}
    assert one.asked == 1
    assert json.loads(answered(other, tmp_path).read_text()) == {"verdict": "unlisted"}
    answered(one, tmp_path)
    answered(one, tmp_path, cases.names("trial")[0])
    assert one.asked == 3 and not list(tmp_path.glob("now_*"))


def test_a_wrong_exit_says_nothing_and_is_told(tmp_path):
    out = tmp_path / "out"
    bad = program(tmp_path / "bad", 'echo "error: the skin is torn" >&2; exit 1')
    assert answered(bad, out / NARROW) is None
    assert prove.wrong_endings(prove.Who("thenar"), out, [NARROW]) == [
        f"{NARROW}: exit code 1: error: the skin is torn"
    ]
    dumb = program(tmp_path / "dumb", "exit 0")
    assert answered(dumb, out / NARROW) is None
    assert "wrote no findings.json" in prove.wrong_endings(prove.Who("thenar"), out, [NARROW])[0]
    assert prove.answers(prove.Who("thenar"), out, [NARROW]).said == {}


def test_what_was_killed_is_asked_again_and_what_failed_is_not(tmp_path):
    for lasting, asked in ((False, 2), (True, 1)):
        diagnosis = Counting(running.Fault("it ended", lasting), str(lasting))
        for _ in range(2):
            assert answered(diagnosis, tmp_path) is None
        assert diagnosis.asked == asked


def test_a_binary_without_diagnose_is_left_out(tmp_path):
    assert not program(tmp_path / "old", "exit 2").is_able()


def test_the_recording_that_is_asked_for_is_added(tmp_path):
    """The larger sphere is asked for in words of the study; what is held back comes closest to it."""
    held = cases.held_back(NARROW)
    wanted = following.described(NARROW, "wide sphere")
    larger = {"text": "larger", "protocol": dict(wanted), "probability": 0.25}
    verdict = {"verdict": "cannot_tell", "record_next": [larger]}
    assert "wide sphere" in held and following.asked_for(NARROW, verdict) == {"wide sphere": 2}
    near = wanted | {"radius_mm": 1.3 * wanted["radius_mm"], "presses": 8, "in_turn_with": "large"}
    assert following.asked_for(NARROW, {**verdict, "record_next": [{"protocol": near}]}) == {
        "wide sphere": 8,
        "large sphere": 8,
    }
    plane, first = {"protocol": {"shape": "plane"}}, verdict["record_next"][0]
    assert following.asked_for(NARROW, {**verdict, "record_next": [plane]}) is None
    assert following.met(NARROW, {**verdict, "record_next": [plane, first]}) == first
    huge = {"protocol": wanted | {"radius_mm": 16 * wanted["radius_mm"]}}
    assert following.asked_for(NARROW, {**verdict, "record_next": [huge]}) is None, "nothing alike is held back"
    assert following.asked_for(NARROW, {"verdict": "parameters"}) is None
    (by_lot,) = following.at_random(NARROW, 8).items()
    assert by_lot[0] in held and by_lot[1] == 8 and following.at_random(NARROW, 8) == dict([by_lot])
    out = tmp_path / "out"
    telling = tmp_path / "findings.json"
    telling.write_text(json.dumps(verdict))
    binary = program(tmp_path / "thenar", f'mkdir -p "$4"; cp {telling} "$4"; ls "$2" > {tmp_path}/seen; true')
    prove.job(prove.Who("thenar", binary.program), out, NARROW)
    assert (out / NARROW / "followed/findings.json").exists() and (out / NARROW / "at_random/findings.json").exists()
    found = prove.answers(prove.Who("thenar"), out, [NARROW])
    assert found.could_follow == {NARROW} and found.followed.keys() == found.at_random.keys() == {NARROW}
    assert found.foretold == {NARROW: 0.25}


def test_a_settled_case_counts_and_an_unsettled_one_does_not():
    sealed = score.labels("trial")
    open_ones = [name for name, label in sealed.items() if label["stratum"] == "ambiguous" and cases.held_back(name)]
    said = {name: right(label) for name, label in sealed.items()}
    truth = {
        name: {"verdict": "missing_physics", "findings": [{"effect": sealed[name]["effect"]}]} for name in open_ones
    }
    found = counts.Answers(said, truth, {}, frozenset(open_ones), dict.fromkeys(open_ones, 0.7))
    table = {row.key: row for row in counts.table(sealed, found)}
    assert len(open_ones) >= 12 and table["followed"].value == 1.0 and table["random"].value == 0.0
    assert table["recorded"].of == len(open_ones) and table["foretold"].value == pytest.approx(0.7)
    some = {name: truth[name] for name in open_ones[:6]}
    table = {row.key: row for row in counts.table(sealed, counts.Answers(said, some, {}, frozenset(open_ones)))}
    assert table["recorded"].of == 6 and table["recorded"].value == 1.0 and table["followed"].value < 0.51


@pytest.mark.parametrize("how", mutations.MUTATIONS)
def test_every_mutation_is_noticed(how):
    sealed = score.labels("trial")
    said = {name: right(label) for name, label in sealed.items()}
    for name, label in sealed.items():
        if label["stratum"] in ("null", "unlisted"):
            said[name] = said[name] | {"names_90": [[], ["relaxation"]]}
    before = counts.table(sealed, counts.Answers(said))
    assert mutations.is_noticed(how, before, mutations.mutated(how, sealed, counts.Answers(said)))
    assert not mutations.is_noticed(how, before, before)


def test_the_fixed_subset_is_of_every_public_kind_and_does_not_need_labels():
    for split in score.SPLITS:
        chosen = subset.fixed(split)
        assert {subset.kind(case) for case in chosen} == {subset.kind(case) for case in cases.names(split)}
        assert chosen == subset.fixed(split) and 15 <= len(chosen) <= 35


def test_the_page_stands_alone_and_shows_every_row():
    sealed = score.labels("trial")
    said = {name: right(label) for name, label in sealed.items()}
    table = counts.table(sealed, counts.Answers(said))
    text = page.page(
        "trial", {"thenar": table, "bic": table[:3]}, counts.by_stratum(sealed, said), {"thenar": ["<bad>"]}
    )
    assert "http" not in text and "&lt;bad&gt;" in text
    assert all(row.name.strip().replace(">", "&gt;").replace("<", "&lt;") in text for row in table)


def test_workers_end_with_a_run_that_is_killed(tmp_path):
    code = (
        "import os, time\nfrom trial import running\n"
        f"def job(k):\n    open({str(tmp_path)!r} + '/' + str(os.getpid()), 'w').close(); time.sleep(60)\n"
        "if __name__ == '__main__':\n    running.each(job, [1], 1, 'sleep')\n"
    )
    run = subprocess.Popen([sys.executable, "-c", code], cwd=ROOT / "tests", stderr=subprocess.DEVNULL)
    worker = _soon(lambda: next((int(path.name) for path in tmp_path.iterdir()), None))
    run.kill()
    run.wait()
    assert _soon(lambda: not _lives(worker))


def _soon(test):
    """What a test gives as soon as it gives something, within half a minute."""
    end = time.monotonic() + 30.0
    while not (found := test()) and time.monotonic() < end:
        time.sleep(0.1)
    return found


def _lives(number):
    """Whether a process is there and not only waiting to be buried."""
    try:
        return Path(f"/proc/{number}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False
