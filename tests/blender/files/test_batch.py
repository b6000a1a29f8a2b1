"""Batches: job files, sweeps, resuming, bad cases, killed workers, tables; Dask with a new scheduler."""

import csv
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import dask_cluster
import numpy as np
import pytest
import stage
import thenar
from thenar_blender import batch, names
from thenar_blender.batch import child
from thenar_blender.scene.checks import Refusal
from thenar_blender.terminal import command_line

SWEEP = """
blend = "grip.blend"
save = false
[[sweep]]
name = "push"
force_n = [1.0, 1.5, 2.0, 2.5]
stiffness = [1.0, 1.5]
"""


def start(*arguments):
    return subprocess.Popen(
        [sys.executable, "-m", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=dask_cluster.environment(),
    )


def run(*arguments):
    process = start("thenar_blender", "batch", *arguments)
    output, _ = process.communicate(timeout=240)
    return process.returncode, output


def rows_of(out):
    return {row["name"]: row for row in csv.DictReader((out / "results.csv").open())}


@pytest.fixture
def grip(tmp_path):
    stage.scene()
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 120, 90
    path = tmp_path / "grip.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def test_batch_resumes_and_survives_a_bad_case(grip, tmp_path):
    jobs, out = tmp_path / "jobs.toml", tmp_path / "out"
    jobs.write_text(
        'blend = "grip.blend"\nsave = false\n[[case]]\nname = "posed"\nrender = true\n'
        '[[case]]\nname = "two newtons"\nforce_n = 2.0\n[[case]]\nname = "bad"\nhand = "Paw"\n'
    )
    code, output = run(jobs, "--out", out, "--workers", 1)
    assert code == 2 and "1 of 3 cases failed (bad)" in output
    rows = rows_of(out)
    assert [row["status"] for row in rows.values()] == ["done", "done", "failed"]
    assert float(rows["two newtons"]["force_n"]) == pytest.approx(2.0, rel=0.02)
    assert "no object 'Paw'" in rows["bad"]["message"]
    assert json.loads((out / "two_newtons.json").read_text())["force_n"] == float(rows["two newtons"]["force_n"])
    sheet = bpy.data.images.load(str(out / "sheet.png"))
    assert 320 <= sheet.size[0] < 360 and np.ptp(np.array(sheet.pixels[:]).reshape(-1, 4)[:, :3]) > 0.3
    jobs.write_text(jobs.read_text().replace("2.0", "3.0").replace("Paw", "Pad"))
    code, output = run(jobs, "--out", out, "--workers", 1)
    assert code == 0 and "1 of 3 cases kept" in output, output
    rows = rows_of(out)
    assert [row["status"] for row in rows.values()] == ["done"] * 3
    assert float(rows["two newtons"]["force_n"]) == pytest.approx(3.0, rel=0.02)


def test_sweep_gives_the_same_bytes_with_one_worker_and_with_two(grip, tmp_path):
    pq = pytest.importorskip("pyarrow.parquet")
    jobs = tmp_path / "jobs.toml"
    jobs.write_text(SWEEP)
    for out, workers in (("one", 1), ("two", 2)):
        code, output = run(jobs, "--out", tmp_path / out, "--workers", workers)
        assert code == 0, output
    for name in ("results.csv", "results.parquet", "summary.csv"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
    rows = rows_of(tmp_path / "one")
    assert list(rows) == [f"push-{number}" for number in range(1, 9)]
    # A stiffer skin under the same force is pressed on a smaller area, and so harder.
    for soft, stiff in (("push-1", "push-2"), ("push-7", "push-8")):
        assert float(rows[soft]["contact_area_mm2"]) > float(rows[stiff]["contact_area_mm2"])
    table = pq.read_table(io.BytesIO((tmp_path / "one" / "results.parquet").read_bytes())).to_pylist()
    assert [row["set_force_n"] for row in table] == [1.0, 1.0, 1.5, 1.5, 2.0, 2.0, 2.5, 2.5]
    assert [row["peak_pressure_kpa"] for row in table] == [float(row["peak_pressure_kpa"]) for row in rows.values()]
    summary = list(csv.DictReader((tmp_path / "one" / "summary.csv").open()))
    forces = [row for row in summary if row["setting"] == "force_n"]
    assert [row["cases"] for row in forces] == ["2"] * 4
    assert float(forces[2]["force_n_mean"]) == pytest.approx(2.0, rel=0.02)


def test_a_killed_worker_process_loses_no_case(grip, tmp_path):
    jobs, out = tmp_path / "jobs.toml", tmp_path / "out"
    jobs.write_text(SWEEP)
    process = start("thenar_blender", "batch", jobs, "--out", out, "--workers", 1)
    for line in process.stdout:
        if line.startswith("push-2"):
            threads = Path(f"/proc/{process.pid}/task").iterdir()
            (worker,) = [int(pid) for thread in threads for pid in (thread / "children").read_text().split()]
            os.kill(worker, signal.SIGKILL)
            break
    process.communicate(timeout=240)
    assert process.returncode == 0
    assert [row["status"] for row in rows_of(out).values()] == ["done"] * 8


def test_a_case_that_kills_its_process_twice_is_a_failed_case():
    output = child.Children().solve(([sys.executable, "-c", "import sys; sys.exit('no such hand')"], {}), {}, 60.0)
    assert output == {"error": "the process ended with code 1: no such hand, 2 times"}
    output = child.Children().solve(([sys.executable, "-c", "import time; time.sleep(60)"], {}), {}, 0.5)
    assert output == {"error": "it took longer than 0.5 s, 2 times"}


def test_a_worker_answers_every_line_and_goes_on(grip, tmp_path):
    good = json.dumps({"case": {"blend": str(grip), "save": False}, "stem": str(tmp_path / "good")}).encode()
    lines = [
        (b"", "line 1 is not JSON"),
        (b"{", "line 2 is not JSON"),
        (b"\xff", "line 3 is not JSON"),
        (b"[1]", "line 4 is no task"),
        (b'{"case": {}, "stem": "x"}', "case of line 5 names no file"),
        (b'{"case": {"blend": "none.blend", "name": "lost"}, "stem": "x"}', "none.blend"),
        (b'{"case": {"blend": "a", "colour": 1, "name": "odd"}, "stem": "x"}', "case odd has the unknown key 'colour'"),
        (b'{"case": {"blend": "a", "force_n": "2"}, "stem": "x"}', "must be a number above zero"),
    ]
    output = subprocess.run(
        [sys.executable, "-m", "thenar_blender", "worker"],
        input=b"\n".join([*(line for line, _ in lines), good]) + b"\n",
        capture_output=True,
        env=dask_cluster.environment(),
        timeout=120,
    )
    first, *answers = [json.loads(line) for line in output.stdout.splitlines()]
    assert first == {"thenar": names.VERSION, "ready": True}
    assert output.returncode == 0 and len(answers) == len(lines) + 1
    for answer, (_, sentence) in zip(answers, lines, strict=False):
        assert sentence in answer["error"] and "Traceback" not in answer["error"], answer
    assert answers[-1]["summary"]["force_n"] > 0.0


def test_a_task_that_the_process_never_took_does_not_break_its_end():
    deaf = "import os, time; os.close(0); print('deaf', flush=True); time.sleep(1)"
    process = child.Child([sys.executable, "-c", deaf], {})
    process._start()
    assert process._lines.get(timeout=30) == "deaf\n"
    with pytest.raises(child.ChildDied, match="ended with code 0"):
        process.solve({"case": 1}, 30.0)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "lists no case"),
        ("[[case]]\nname = 1", "names no file"),
        ('[[case]]\nblend = "a"\ncolour = 1', "unknown key 'colour'"),
        ("[[case", "is not TOML"),
        ('[[case]]\nblend = "a"\nforce_n = -2', "force_n is -2, but must be a number above zero"),
        ('[[case]]\nblend = "a"\nmodel = "clay"', 'must be "layer" or "paper"'),
        ('[[case]]\nblend = "a"\nhand_percentile = 95', 'add fit = "firm"'),
        ('[[case]]\nblend = "a"\nname = "x"\n[[case]]\nblend = "a"\nname = "x"', "case x has the name of another"),
        ('[[sweep]]\nblend = "a"', "holds no list"),
        ('[[sweep]]\nblend = "a"\nforce_n = []', "an empty list for force_n"),
        ('[[sweep]]\nblend = "a"\nsave = [true, false]', "cannot run through save"),
    ],
)
def test_job_files_that_cannot_be_read(tmp_path, text, sentence):
    path = tmp_path / "jobs.toml"
    path.write_text(text)
    with pytest.raises(Refusal, match=sentence):
        batch.read_jobs(path)


def test_parts_deal_out_the_cases_and_the_whole_gathers_them(grip, tmp_path):
    jobs, out = tmp_path / "jobs.toml", tmp_path / "out"
    jobs.write_text(SWEEP.replace("[1.0, 1.5, 2.0, 2.5]", "[1.0]"))
    for part in ("1/2", "2/2"):
        code, output = run(jobs, "--out", out, "--workers", 1, "--part", part)
        assert code == 0, output
        assert not (out / "results.csv").exists()
    code, output = run(jobs, "--out", out)
    assert code == 0 and "2 of 2 cases kept" in output
    assert [row["status"] for row in rows_of(out).values()] == ["done", "done"]
    code, output = run(jobs, "--out", out, "--part", "3/2")
    assert code == 2 and "the part '3/2' is none" in output


def test_flamenco_job_type_deals_out_parts():
    node = shutil.which("node")
    if node is None:
        pytest.skip("no JavaScript program to run the job type with")
    script = (Path(batch.__file__).parent / "thenar_flamenco.js").read_text()
    script += """
    const tasks = [];
    const author = {
        Task: (name) => ({ name, commands: [], needs: [], addCommand(c) { this.commands.push(c); },
                           addDependency(t) { this.needs.push(t.name); } }),
        Command: (name, parameters) => ({ name, parameters }),
    };
    compileJob({ settings: { jobs_file: "/j.toml", results_folder: "/r", parts: 2 }, addTask: (t) => tasks.push(t) });
    console.log(JSON.stringify(tasks));
    """
    tasks = json.loads(subprocess.run([node, "-e", script], capture_output=True, text=True, check=True).stdout)
    assert [task["name"] for task in tasks] == ["part-1", "part-2", "tables"]
    assert tasks[2]["needs"] == ["part-1", "part-2"]
    (command,) = tasks[1]["commands"]
    known = command_line._parser().parse_args(command["parameters"]["args"][2:])
    assert (known.jobs, known.out, known.part) == ("/j.toml", "/r", "2/2")


def test_tables_that_are_none():
    with pytest.raises(ValueError, match="column 'b' has 2 rows, but 'a' has 1"):
        thenar.parquet({"a": [1.0], "b": [1.0, 2.0]})
    with pytest.raises(ValueError, match="column 'b' holds neither numbers nor texts alone"):
        thenar.parquet({"b": [1.0, "x"]})


def test_without_a_scheduler_the_batch_says_so(grip, tmp_path):
    pytest.importorskip("distributed")
    jobs = tmp_path / "jobs.toml"
    jobs.write_text(SWEEP)
    began = time.monotonic()
    with pytest.raises(Refusal, match="no scheduler answers at tcp://127.0.0.1:9 .*8 cases are left"):
        batch.run(jobs, tmp_path / "out", batch.By(scheduler="tcp://127.0.0.1:9"))
    assert time.monotonic() - began < 10.0


def test_dask_with_a_killed_worker_and_a_new_scheduler(grip, tmp_path):
    pytest.importorskip("distributed")
    jobs, out = tmp_path / "jobs.toml", tmp_path / "out"
    jobs.write_text(SWEEP)
    cluster = dask_cluster.Cluster(tmp_path)
    try:
        cluster.begin()
        process = start("thenar_blender", "batch", jobs, "--out", out, "--scheduler", cluster.address)
        lines = []
        for line in process.stdout:
            lines.append(line)
            answered = sum(line.startswith("push-") for line in lines)
            if line.startswith("push-") and answered == 2:
                cluster.workers[0].kill()
            if line.startswith("push-") and answered == 4:
                cluster.end()
                cluster.begin()
        assert process.wait(timeout=60) == 0, "".join(lines)
    finally:
        cluster.end()
    assert sorted(line.split(":")[0] for line in lines if line.startswith("push-")) == [
        f"push-{number}" for number in range(1, 9)
    ]
    code, output = run(jobs, "--out", tmp_path / "here", "--workers", 1)
    assert code == 0, output
    for name in ("results.csv", "results.parquet"):
        assert (out / name).read_bytes() == (tmp_path / "here" / name).read_bytes()
