"""Parts of a batch alone: what a case's digest depends on, what counts as done, fresh processes, groups, stiffness."""

import csv
import json
import os
import sys

import pytest
import stage
import stub_worker
from thenar_blender.batch import child, cluster, conductor, depends, here, jobs, processors, rows, worker

SUMMARY = {name: 21.0 for name in child.NUMBERS}


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "grip.blend"
    path.write_bytes(b"one")
    return {"name": "grip", "blend": str(path), "force_n": 2.0}


def test_the_digest_depends_on_settings_and_on_the_file(case, tmp_path):
    first = jobs.case_hash(case, {})
    assert jobs.case_hash(dict(case), {}) == first
    assert jobs.case_hash(case | {"force_n": 3.0}, {}) != first
    (tmp_path / "grip.blend").write_bytes(b"two")
    assert jobs.case_hash(case, {}) != first, "the file was changed since"


def test_a_case_is_done_once_all_it_asks_for_is_there(case, tmp_path):
    wanted = case | {"save": False, "render": True}
    texture = tmp_path / "texture.png"
    texture.write_bytes(b"grain")
    files = {str(texture): depends.digest(texture, {}), str(tmp_path / "gone.abc"): ""}
    summary = {**SUMMARY, "case_hash": jobs.case_hash(wanted, {}), "files": files, "warnings": []}
    whole = json.dumps(summary)

    def kept(of=wanted):
        return conductor.Table([jobs.Entry(of, "grip")], tmp_path).rows[0]

    (tmp_path / "grip.json").write_text(whole)
    assert kept() is None, "its picture is missing"
    (tmp_path / "grip.png").write_bytes(b"picture")
    assert kept()["status"] == "done"
    assert kept(wanted | {"force_n": 3.0}) is None, "another force"
    for odd in ("{", "[]", "5", '{"case_hash": "h"}', whole.replace("21.0", '"21"'), "[" * 100_000, "\xff"):
        (tmp_path / "grip.json").write_bytes(odd.encode("latin-1"))
        assert kept() is None, odd[:20]
    (tmp_path / "grip.json").write_text(whole)
    (tmp_path / "gone.abc").write_bytes(b"waves")
    assert kept() is None, "a file that was missing is there now"
    (tmp_path / "gone.abc").unlink()
    texture.write_bytes(b"grids")
    assert kept() is None, "a texture was painted since"


def test_a_process_is_replaced_after_so_many_cases(monkeypatch):
    monkeypatch.setattr(child, "MOST_CASES", 2)
    process = child.Child(stub_worker.command("os.getpid()"), {})
    numbers = [process.solve(stub_worker.TASK, 30.0)["error"] for _ in range(5)]
    process.close()
    assert numbers[0] == numbers[1] != numbers[2] == numbers[3] != numbers[4]


@pytest.mark.skipif(sys.platform != "linux", reason="processors are set on Linux")
def test_a_process_starts_on_one_processor_where_it_is_to():
    allowed = os.sched_getaffinity(0)
    command = stub_worker.command(f"[len(os.sched_getaffinity(0)), os.environ.get({child.PROCESSORS!r})]")
    for wish, count, output in (
        ({child.PROCESSORS: "one"}, 1, ",".join(map(str, sorted(allowed)))),
        ({}, len(allowed), None),
    ):
        process = child.Child(command, wish)
        assert process.solve(stub_worker.TASK, 30.0) == {"error": str([count, output])}
        process.close()
    assert os.sched_getaffinity(0) == allowed


@pytest.mark.skipif(sys.platform != "linux", reason="processors are set on Linux")
def test_workers_keep_a_processor_each_and_leave_one_that_is_shared(monkeypatch, tmp_path):
    # Workers of another run of the tests, in the other Blender, claim processors on the same machine.
    monkeypatch.setattr(processors.tempfile, "tempdir", str(tmp_path))
    allowed, owners, kept = os.sched_getaffinity(0), [], []
    try:
        for _ in range(len(allowed) + 1):
            monkeypatch.setenv(child.PROCESSORS, ",".join(map(str, allowed)))
            owners.append(processors.Own())
            kept.append(os.sched_getaffinity(0))
        owners[0].took(10.0, 9.0)
        owners[0].took(1.9, 0.1)
        processors._allow({min(allowed)})
        assert os.sched_getaffinity(0) == {min(allowed)}, "not yet judged"
        owners[0].took(1.0, 0.1)
        assert os.sched_getaffinity(0) == allowed
    finally:
        for owner in owners:
            owner.leave()
    assert set.union(*kept[:-1]) == allowed
    assert all(len(each) == 1 for each in kept[:-1])
    assert kept[-1] == allowed, "none was left for the last"
    assert child.PROCESSORS not in os.environ


def test_a_process_of_other_variables_is_replaced():
    command, children = stub_worker.command("os.environ['COLOUR']"), child.Children()
    try:
        wanted = ("red", "red", "blue")
        output = [children.solve((command, {"COLOUR": name}), stub_worker.TASK, 30.0) for name in wanted]
    finally:
        children.close()
    assert [each["error"] for each in output] == ["red", "red", "blue"]


def test_no_cell_of_a_table_is_computed_by_a_spreadsheet(tmp_path):
    names = ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "plain", "a=b"]
    found = [rows.row({"name": name}, "", {"summary": {"force_n": -2.5}}) for name in names]
    rows.save(tmp_path, found)
    with open(tmp_path / "results.csv", encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    assert [row["name"] for row in table] == ["'=1+1", "'+1", "'-1", "'@SUM(A1)", "'\t=1", "plain", "a=b"]
    assert [row["force_n"] for row in table] == ["-2.5"] * len(names), "numbers stay numbers"


def test_pictures_take_the_threads_of_blender():
    plain, pictured = {"case": {"name": "a"}}, {"case": {"name": "b", "render": True}}
    assert here.threads([plain]) == {**here.ONE_THREAD, child.PROCESSORS: "one"}
    assert here.threads([plain, pictured]) == here.ONE_THREAD


@pytest.mark.parametrize(("save_s", "most"), [(0.0, 20), (0.5, 5)])
def test_the_table_is_written_now_and_then_and_less_often_where_that_takes_long(monkeypatch, tmp_path, save_s, most):
    """200 cases of a second: every ten seconds, but at most a hundredth of the time."""
    clock, saves = [0.0], []

    def come(tasks, by):
        for task in tasks:
            clock[0] += 1.0
            yield task["case"]["name"], {"error": "spilled coffee"}

    def save(*given, **named):
        clock[0] += save_s
        saves.append(clock[0])

    monkeypatch.setattr(conductor.time, "monotonic", lambda: clock[0])
    monkeypatch.setattr(conductor, "_by", come)
    monkeypatch.setattr(conductor, "_save", save)
    entries = [jobs.Entry({"name": f"case {number}", "blend": "none.blend"}, f"case_{number}") for number in range(200)]
    table = conductor.Table(entries, tmp_path)
    conductor._answer(table, table.left(), None)
    assert [row["message"] for row in table.rows] == ["spilled coffee"] * 200
    assert most - 3 <= len(saves) <= most
    assert max(later - earlier for earlier, later in zip(saves, saves[1:], strict=False)) >= conductor.SAVED_EVERY_S


def test_stiffness_is_a_factor_on_both_moduli():
    hand, _ = stage.scene()
    material = hand.thenar.default_material
    before = material.g0_kpa, material.g_lim_kpa
    worker._stiffen(hand, 1.5)
    assert (material.g0_kpa, material.g_lim_kpa) == pytest.approx([1.5 * value for value in before])


def test_groups_are_of_a_second_and_small_at_the_end():
    assert cluster._size(1000, 2, None) == 1, "nothing is known of the first"
    assert cluster._size(1000, 2, 0.025) == 40
    assert cluster._size(1000, 2, 1e-9) == cluster.MOST_AT_ONCE
    assert cluster._size(1000, 2, 30.0) == 1
    assert cluster._size(80, 2, 0.025) == 10
    assert cluster._size(6, 2, 0.025) == 4
    assert cluster._size(3, 2, 0.025) == 3


def test_cases_go_to_workers_in_groups_and_one_that_fails_takes_none_with_it():
    distributed = pytest.importorskip("distributed")
    asked = []

    class Stub:
        def solve(self, start, task, limit_s):
            asked.append(task["case"]["name"])
            if asked[-1] == "case 13":
                raise ValueError("spilled coffee")
            return {"summary": asked[-1]}

    left = {f"case {n}": {"hash": f"h{n}", "case": {"name": f"case {n}"}} for n in range(40)}
    here = {"n_workers": 1, "threads_per_worker": 1, "processes": False, "dashboard_address": None}
    with distributed.LocalCluster(**here) as workers, distributed.Client(workers) as client:
        next(iter(workers.workers.values())).__dict__["thenar_children"] = Stub()
        output = dict(cluster._session(client, left, {}))
    assert output.pop("case 13")["error"].startswith("the worker failed: ValueError('spilled coffee')")
    assert output == {name: {"summary": name} for name in left if name != "case 13"}
    assert asked.count("case 0") == 1, "groups without it are solved once"
