"""RESULTS.md files: what a measuring program writes replaces its own row or block, and nothing else."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))
import results

TABLE = f"""# Figures

{results.HEAD}
| --- | --- | --- | --- | --- |
| force | 1 % | 0.5 % | 2020-01-01, 1234567 | `cargo test` |
| area | 1 % | 2 %: **not met** | 2020-01-01, 1234567 | `cargo test` |

## Printed by the commands
"""


@pytest.fixture
def place(tmp_path):
    (tmp_path / "bench").mkdir()
    (tmp_path / "bench/RESULTS.md").write_text(TABLE)
    return tmp_path


def test_a_figure_replaces_its_row_and_leaves_the_others(place):
    results.record("bench", "cargo xtask bench", [results.Figure("area", "1 %", "3 %", False)], place)
    force, area = results.rows("bench", place)
    assert force == ["force", "1 %", "0.5 %", "2020-01-01, 1234567", "`cargo test`"]
    assert (area[0], area[2], area[4]) == ("area", "3 %: **not met**", "`cargo xtask bench`")
    assert results.commit() in area[3] and results.machine() in area[3]


def test_a_new_figure_is_added_to_the_table(place):
    results.record("bench", "x", [results.Figure("time | s", "1 s", "0.5 s", True)], place)
    text = (place / "bench/RESULTS.md").read_text()
    assert [row[0] for row in results.rows("bench", place)] == ["force", "area", "time / s"]
    assert text.index("time / s") < text.index("## Printed")


def test_a_block_replaces_that_of_its_command(place):
    for printed in ("force 1 N", "force 2 N"):
        results.write_block("bench", "cargo test", printed, place)
    results.write_block("bench", "pytest tests", "area", place)
    text = (place / "bench/RESULTS.md").read_text()
    assert "force 1 N" not in text
    assert text.index("force 2 N") < text.index("### pytest tests")
    assert text.startswith(TABLE.rstrip())


def test_nothing_is_written_unless_asked(monkeypatch):
    monkeypatch.delenv(results.ASKED, raising=False)
    before = (results.TESTS / "bench/RESULTS.md").read_text()
    results.record("bench", "x", [results.Figure("no such row", "", "", None)])
    results.write_block("bench", "x", "x")
    assert (results.TESTS / "bench/RESULTS.md").read_text() == before


@pytest.mark.parametrize("part", results.PARTS)
def test_rows_name_a_version_and_a_command_and_are_there_once(part):
    listed = results.rows(part)
    assert listed
    for what, _, measured, when, command in listed:
        assert measured and when[:4].isdigit() and "," in when and command.startswith("`"), what
    names = [row[0] for row in listed]
    assert len(names) == len(set(names))
