"""One case's error costs its row: a small share of `tests/bench/farm/hostile_batch.py`."""

import resource
import subprocess
import sys

import hostile_jobs
import pytest
from thenar_blender.batch import case_files, jobs, read_jobs
from thenar_blender.scene.checks import Refusal

SHARE = 5


def test_every_sound_case_is_done_once_and_each_bad_one_is_a_row(ball, batch, tmp_path):
    hostile_jobs.files(tmp_path)
    sound = len(hostile_jobs.ODD_NAMES)
    (tmp_path / "jobs.toml").write_text(hostile_jobs.job_file(hostile_jobs.BAD, sound), encoding="utf-8")
    before = set(tmp_path.iterdir())
    code, output, rows = batch(tmp_path / "out", "--workers", 1)
    assert code == 2 and "Traceback" not in output and "\x1b" not in output
    assert set(tmp_path.iterdir()) - before == {tmp_path / "out"}, "a file was written outside of the folder"
    done = [row for row in rows if row["status"] == "done"]
    failed = [row["message"] for row in rows if row["status"] == "failed"]
    assert len(done) == len({row["case_hash"] for row in done}) == len(list((tmp_path / "out").glob("*.json"))) == sound
    assert len(failed) == len(hostile_jobs.BAD)
    for lines, words in hostile_jobs.BAD:
        assert any(words in message and message for message in failed), (lines.splitlines()[0], failed)
    assert not [path for path in (tmp_path / "out").iterdir() if path.name.startswith(".")]
    table = (tmp_path / "out" / "results.csv").read_bytes()
    assert b"\x1b" not in table
    code, output, _ = batch(tmp_path / "out", "--workers", 1)
    assert f"{sound} of {sound + len(hostile_jobs.BAD)} cases kept" in output
    assert (tmp_path / "out" / "results.csv").read_bytes() == table


def test_a_full_disk_costs_rows_and_a_second_run_mends_them(ball, batch, tmp_path):
    """In place of a full disk, no file may grow beyond 1 kB: a case's numbers take 2, a scene 200."""
    (tmp_path / "jobs.toml").write_text(
        'blend = "ball.blend"\n[[case]]\nname = "scene"\n[[case]]\nname = "numbers"\nsave = false\n'
    )

    def bound():
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))

    code, output, _ = batch(tmp_path / "out", "--workers", 1, preexec_fn=bound)
    assert code == 2 and "Traceback" not in output, output
    assert "numbers: failed 'numbers.json' cannot be written" in output
    assert "scene: failed" in output
    assert not list((tmp_path / "out").glob("*.json")) and not list((tmp_path / "out").glob(".*"))
    code, output, rows = batch(tmp_path / "out", "--workers", 1)
    assert code == 0 and [row["status"] for row in rows] == ["done", "done"]


def test_names_of_any_letters_have_one_file_each():
    names = [*hostile_jobs.ODD_NAMES, "a" * 121, "a" * 122, "A" * 121]
    stems = case_files.stems([(name, name) for name in names])
    assert len({stem.casefold() for stem in stems}) == len(names)
    for stem in stems:
        assert stem and len(stem.encode()) <= case_files.LONGEST + 1 + 32
        assert not set(stem) & set('/\\:*?"<>|\0') and stem.strip(". ") == stem and stem.isprintable()
        assert stem.partition(".")[0].casefold() not in ("con", "nul"), "Windows keeps these names"
    assert case_files.stems([("force 0.5", "force 0.5")]) == ["force_0.5"], "a plain name stays plain"
    one, two = case_files.stems([("same", "first"), ("same", "second")])
    assert one != two, "two cases ask for one file"


def test_the_files_of_a_case_do_not_depend_on_the_others():
    alone = [case_files.stem(name) for name in hostile_jobs.ODD_NAMES]
    assert case_files.stem("grip 2.5") == "grip_2.5"
    assert [case_files.stem(name) for name in hostile_jobs.ODD_NAMES] == alone


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a" + ".a" * 100_000 + " = 1", "a key of more than 32 parts"),
        ("a = " + "[" * 100_000, "nested too deep|is not TOML"),
        ("a = " + "{b = " * 5_000, "nested too deep|is not TOML"),
        ("a = 1" + "0" * 5_000, "is not TOML"),
        ("a = '" + "x" * (17 << 20) + "'", "longer than 16 MiB"),
        ("case = 5", "lists no case"),
        ("case = [5]", "lists no case"),
        ("[[case]]\nblend = 5", "blend is 5, but must be a text in quotes"),
    ],
)
def test_odd_job_files_are_refused_at_once(tmp_path, text, sentence):
    path = tmp_path / "jobs.toml"
    path.write_text(text)
    with pytest.raises(Refusal, match=sentence) as refused:
        read_jobs(path)
    assert len(str(refused.value)) < 400 + len(str(path))


def test_points_in_texts_and_numbers_are_no_dotted_keys(tmp_path):
    path = tmp_path / "jobs.toml"
    forces = ", ".join(f"{0.5 + k / 1000:.3f}" for k in range(200))
    path.write_text(f'blend = "{"a." * 60}blend"\n[[sweep]]\nforce_n = [{forces}]\n')
    assert len(jobs.read_entries(path)) == 200


def test_a_pipe_or_a_device_is_no_job_file(tmp_path):
    import os

    os.mkfifo(tmp_path / "pipe.toml")
    for path in (tmp_path / "pipe.toml", tmp_path):
        with pytest.raises(Refusal, match="is no file"):
            read_jobs(path)


def test_results_cannot_go_into_a_file(ball, batch, tmp_path):
    (tmp_path / "jobs.toml").write_text('blend = "ball.blend"\n[[case]]\nname = "a"\n')
    (tmp_path / "out").write_text("a letter")
    code, output, _ = batch(tmp_path / "out")
    assert code == 2 and "no results can be written" in output and "Traceback" not in output
    assert (tmp_path / "out").read_text() == "a letter"


def test_no_part_of_the_extension_needs_what_windows_lacks():
    """`os.sysconf`, `shlex` (which takes backslashes out of paths), links; `with_suffix` cuts names at a dot."""
    from pathlib import Path

    import thenar_blender

    root = Path(thenar_blender.__file__).parent
    for path in root.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        for word in ("sysconf", "shlex", "symlink", "with_suffix"):
            assert word not in text, f"{path.relative_to(root)} uses {word}"


def test_the_batch_starts_where_windows_has_no_modules_of_unix(tmp_path):
    """The modules of a batch import without `fcntl`, `resource` and the calls that only Unix has."""
    script = (
        "import os, sys\n"
        "for name in ('fcntl', 'resource', 'pwd', 'termios'): sys.modules[name] = None\n"
        "for name in ('sysconf', 'sched_getaffinity', 'sched_setaffinity', 'mkfifo', 'getuid'):\n"
        "    hasattr(os, name) and delattr(os, name)\n"
        "import thenar_blender.batch as batch\n"
        "from thenar_blender.batch import child, here, processors\n"
        "assert child.words('\"C:\\\\Program Files\\\\b.exe\" -b --command thenar') == "
        "['C:\\\\Program Files\\\\b.exe', '-b', '--command', 'thenar']\n"
        "assert here.workers_of(0) >= 1\n"
        "processors.Own().took(1.0, 1.0)\n"
        "print('sound')\n"
    )
    output = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert output.stdout.strip().endswith("sound"), output.stderr
