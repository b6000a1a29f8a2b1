"""One file among those of a new study: left out of it, described by its path of load, its row of names found."""

import math

import bpy
import laboratory
import numpy as np
import pytest
from thenar_blender.new_study import drafting, heads, repeats

STILL = [(0.1 * k, 0.8, 0.3 + 0.2 * math.exp(-0.1 * k)) for k in range(60)]
"""A hold alone: the force falls, the tool stands."""


def draft():
    return bpy.context.scene.thenar_new_study


def choose(folder, *names):
    return bpy.ops.thenar.new_study(directory=f"{folder}/", files=[{"name": name} for name in names])


def test_a_hold_alone_is_refused_as_such_and_can_be_left_out(tmp_path):
    laboratory.write(tmp_path / "a.csv", laboratory.press(1))
    laboratory.write(tmp_path / "b.csv", STILL)
    laboratory.write(tmp_path / "c.csv", laboratory.press(2))
    choose(tmp_path, "a.csv", "b.csv", "c.csv")
    draft().protocols[0].diameter_mm = 12.0
    assert "'b.csv' shows a tool that does not move while it presses" in drafting.problem(bpy.context)
    assert bpy.ops.thenar.leave_out_file(number=1) == {"FINISHED"}
    assert [item.name for item in draft().files] == ["a.csv", "c.csv"]
    assert drafting.problem(bpy.context) == ""
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    assert (tmp_path / "b.csv").exists() and "b.csv" not in (tmp_path / "study.toml").read_text()


def test_questions_that_only_the_left_out_file_asked_go_with_it(tmp_path):
    laboratory.write(tmp_path / "a.csv", laboratory.press(1))
    laboratory.write(tmp_path / "b.csv", laboratory.press(2), head=("alpha", "beta", "gamma"))
    laboratory.write(tmp_path / "c.csv", laboratory.press(3), head=("alpha", "beta", "delta"))
    choose(tmp_path, "a.csv", "b.csv", "c.csv")
    assert len(draft().columns) == 2
    bpy.ops.thenar.leave_out_file(number=1)
    assert [[each.name for each in head.headers] for head in draft().columns] == [["alpha", "beta", "delta"]]
    with pytest.raises(RuntimeError, match="here is no recording 2; the list has 2"):
        bpy.ops.thenar.leave_out_file(number=2)
    bpy.ops.thenar.leave_out_file(number=1)
    bpy.ops.thenar.leave_out_file(number=0)
    assert "every recording is left out" in drafting.problem(bpy.context)
    assert not bpy.ops.thenar.write_study.poll()


def path(corners):
    """A track through corners of (time, depth), with Hertz's force."""
    times, depths = zip(*corners, strict=True)
    time = np.linspace(0.0, times[-1], 600)
    depth = np.interp(time, times, depths)
    return repeats.Track(time, depth, np.array([laboratory.hertz_n(each) for each in depth]))


def test_cycles_without_a_hold_are_none():
    cycles = path([(k, 0.8 if k % 2 else 0.0) for k in range(9)])
    assert "hold" not in repeats.describe(cycles)


def test_a_hold_in_a_cycle_is_as_long_as_that_hold():
    """Down in 1 s, 4 s at the deepest, up; then the same depth for 0.3 s."""
    words = repeats.describe(path([(0, 0), (1, 0.8), (5, 0.8), (6, 0), (7, 0.8), (7.3, 0.8), (8, 0)]))
    assert float(words.rpartition("hold ")[2].removesuffix(" s")) == pytest.approx(4.0, abs=0.2), words


HEADS = {
    "a line of data above the names": ("Sample;A;12\nTime;Ext;Load\n0;0;0\n", ["Time", "Ext", "Load"]),
    "names without numbers above": ("Specimen;A;B\nTime;Ext;Load\n0;0;0\n", ["Time", "Ext", "Load"]),
    "units below": ("Zeit;Weg;Kraft\ns;mm;N\n0;0;0\n", ["Zeit", "Weg", "Kraft"]),
    "units in brackets, micro": ("Zeit;Weg;Kraft\n(s);[µm];(mN)\n0;0;0\n", ["Zeit", "Weg", "Kraft"]),
    "commas in quotes": ('"Time, s","Load, N"\n0,1\n', ["Time, s", "Load, N"]),
    "quotes and semicolons": ('"Time";"Load"\n0;1\n', ["Time", "Load"]),
}


@pytest.mark.parametrize("kind", sorted(HEADS))
def test_the_row_of_names_is_found(tmp_path, kind):
    text, names = HEADS[kind]
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    assert heads.of(tmp_path / "a.csv") == names
