"""Workers that talk, answer nonsense or are of another version; and the end of a batch by a signal."""

import json
import os
import signal
import subprocess
import sys
import time

import dask_cluster
import pytest
import stub_worker
from thenar_blender import names
from thenar_blender.batch import By, child, conductor, run
from thenar_blender.scene.checks import Refusal

NUMBERS = {name: 2.0 for name in child.NUMBERS}


def answer_of(lines, monkeypatch, hello=stub_worker.HELLO, nonsense_s=1.0):
    """What a worker gives that prints `lines` for each task."""
    monkeypatch.setattr(child, "NONSENSE_S", nonsense_s)
    prints = "; ".join(f"print({line!r}, flush=True)" for line in lines)
    command = [sys.executable, "-c", f"import sys\n{hello}\nfor line in sys.stdin: {prints}"]
    children = child.Children()
    try:
        return children.solve((command, {}), stub_worker.TASK, 20.0)
    finally:
        children.close()


def test_foreign_lines_are_no_answers(monkeypatch):
    good = {"summary": NUMBERS}
    chatter = "print('Blender 5.0.1 (hash a1b2)\\nRead prefs: \\xff', flush=True); " + stub_worker.HELLO
    assert answer_of(["Saved session", "{ half", json.dumps(good)], monkeypatch, chatter) == good
    own_json = "print('[1, 2]\\n5\\n{}', flush=True); " + stub_worker.HELLO
    assert answer_of([json.dumps(good)], monkeypatch, own_json, 20.0) == good, "another program's JSON came before"


ODD_ANSWERS = [
    *("[]", "5", "{}", '"done"', '{"summary": {}}', '{"summary": []}', '{"error": ""}', '{"error": 5}'),
    *(json.dumps({"summary": {**NUMBERS, "force_n": odd}}) for odd in (float("nan"), "2", None, True)),
]


@pytest.mark.parametrize("line", ODD_ANSWERS)
def test_nonsense_is_tried_again_and_then_the_row_fails(monkeypatch, line):
    output = answer_of([line], monkeypatch)
    assert "it answered nonsense" in output["error"] and output["error"].endswith("2 times")


@pytest.mark.parametrize("line", ["[]", "5", '"done"'])
def test_nonsense_of_what_never_says_that_it_is_a_worker_fails_too(monkeypatch, line):
    output = answer_of([line], monkeypatch, hello="")
    assert "it answered nonsense" in output["error"] and output["error"].endswith("2 times")


def test_a_worker_of_another_version_is_refused_by_name(monkeypatch):
    older = """print('{"thenar": "0.0.9", "ready": true}', flush=True)"""
    output = answer_of(["{}"], monkeypatch, older)
    assert "of Thenar 0.0.9, this batch of Thenar " + names.VERSION in output["refused"]
    output = answer_of([json.dumps({"summary": {"force_n": 123.0, "made_with": "Thenar 0.0.7"}})], monkeypatch, "")
    assert "Thenar 0.0.7" in output["refused"], "it does not even say hello"


def test_a_batch_ends_at_a_worker_of_another_version_and_keeps_what_is_done(ball, tmp_path, monkeypatch):
    jobs = tmp_path / "jobs.toml"
    jobs.write_text('blend = "ball.blend"\nsave = false\n[[sweep]]\nname = "p"\nforce_n = [1.0, 2.0]\n')

    def come(tasks, by):
        yield tasks[0]["case"]["name"], {"summary": {**NUMBERS, "files": {}}}
        yield tasks[1]["case"]["name"], {"refused": "the worker on 'farm7' is of Thenar 0.0.9"}

    monkeypatch.setattr(conductor, "_by", come)
    with pytest.raises(Refusal, match="farm7.*1 cases are left"):
        run(jobs, tmp_path / "out", By())
    assert "p-1,done" in (tmp_path / "out" / "results.csv").read_text()
    assert (tmp_path / "out" / "p-1.json").is_file() and not (tmp_path / "out" / "p-2.json").exists()


@pytest.mark.parametrize("address", ["x", "tcp://", "file:///etc/hosts", "tcp://host", "tcp://host:0", "http://a:80"])
def test_what_is_no_address_of_a_scheduler_is_refused_at_once(ball, tmp_path, address):
    jobs = tmp_path / "jobs.toml"
    jobs.write_text('blend = "ball.blend"\n[[case]]\nname = "a"\n')
    pytest.importorskip("distributed")
    began = time.monotonic()
    with pytest.raises(Refusal, match="is no address of a scheduler"):
        run(jobs, tmp_path / "out", By(scheduler=address))
    assert time.monotonic() - began < 5.0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_writes_the_tables_and_leaves_nothing_else(ball, tmp_path, number):
    jobs, out = tmp_path / "jobs.toml", tmp_path / "out"
    forces = [round(0.5 + k / 1000, 3) for k in range(2000)]
    jobs.write_text(f'blend = "ball.blend"\n[[sweep]]\nname = "p"\nforce_n = {forces}\n')
    command = [sys.executable, "-m", "thenar_blender", "batch", str(jobs), "--out", str(out), "--workers", "2"]
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=dask_cluster.environment(),
        start_new_session=True,
    )
    for line in process.stdout:
        if line.startswith("p-0005"):
            os.kill(process.pid, number)
            break
    output, errors = process.communicate(timeout=60)
    assert process.returncode == 128 + number
    assert f"stopped by {number.name}" in errors and "Traceback" not in output + errors
    done = [path.name for path in out.glob("*.json")]
    rows = (out / "results.csv").read_text().splitlines()[1:]
    assert len(rows) == len(done) >= 4 and all(",done," in row for row in rows)
    assert not [path.name for path in out.iterdir() if path.name.startswith(".") or path.name.endswith("@")]
    listed = subprocess.run(["ps", "-eo", "pgid,args"], capture_output=True, text=True).stdout
    assert not [line for line in listed.splitlines() if line.split()[0] == str(process.pid)], "a worker lives on"


def test_a_line_says_that_a_batch_goes_on(monkeypatch, capsys):
    monkeypatch.setattr(conductor, "BEAT_S", 0.1)
    with conductor._beat(7) as more:
        more()
        time.sleep(0.5)
    assert "1 of 7 cases solved" in capsys.readouterr().out
