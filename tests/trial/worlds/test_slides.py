"""Friction is named from slides, by the force along the skin, and a tilted tool is not taken for it."""

import json

import numpy as np
import pytest
import thenar
from trial.worlds import closed_forms


def _slides(folder, friction, tilt, count=2):
    """Adds slides to and fro, as a load cell of 3 mN reads them that is tilted by `tilt`."""
    case = closed_forms.draw(3, "nothing", "white")
    case.write(folder)
    radius = case.radii["ball"]
    random = np.random.default_rng(5)
    time = np.linspace(0.0, 9.0, 360)
    depth = np.interp(time, [0.0, 0.5, 2.0, 9.0], [-0.1, -0.1, 0.8, 0.8])
    way = np.interp(time, [0.0, 3.0, 5.0, 8.0, 9.0], [0.0, 0.0, 4.0, -2.0, -2.0])
    normal = 0.01 * closed_forms.pressed(depth, radius)
    sign = np.sign(np.gradient(way))
    text = (folder / "study.toml").read_text()
    for number in range(count):
        along = friction * sign * normal + tilt * normal + 0.02
        noise = 0.003 * random.standard_normal((2, len(time)))
        rows = zip(time, depth, normal + noise[0], way, along + noise[1], strict=True)
        lines = [",".join(f"{value:.5f}" for value in row) for row in rows]
        head = "time_s,depth_mm,force_n,slide_mm,tangential_force_n"
        (folder / f"slide_{number}.csv").write_text("\n".join([head, *lines]) + "\n")
        text += f'[[recordings]]\nname = "slide {number}"\nkind = "indentation"\nfile = "slide_{number}.csv"\n'
        text += f'indenter = "ball"\nsite = "middle"\nprotocol = "slide"\norder = {100 + number}\n'
    (folder / "study.toml").write_text(text)


def _said(folder):
    return json.loads(thenar.diagnose(thenar.Study.load(folder)).to_json())


def test_friction_is_named_with_its_coefficient(tmp_path):
    _slides(tmp_path, friction=0.3, tilt=0.1)
    said = _said(tmp_path)
    (finding,) = said["findings"]
    assert (said["verdict"], finding["effect"], finding["when"]["phase"]) == ("missing_physics", "friction", "slide")
    coefficient = finding["parameters"]["coefficient"]
    assert (
        coefficient["value"] == pytest.approx(0.3, abs=0.01)
        and coefficient["low"] <= coefficient["value"] <= coefficient["high"]
    )
    assert {"name": "friction", "amplitude": 1.0, "coefficient": coefficient["value"]} in said["model"]["effects"]


def test_tilted_tool_is_no_friction(tmp_path):
    _slides(tmp_path, friction=0.0, tilt=0.1)
    said = _said(tmp_path)
    assert said["findings"] == [] and said["verdict"] in ("nothing_missing", "parameters")
    assert any("no friction beyond that" in note for note in said["notes"])


def test_friction_of_a_single_slide_is_suspected_only(tmp_path):
    _slides(tmp_path, friction=0.3, tilt=0.0, count=1)
    said = _said(tmp_path)
    assert said["findings"] == [] and said["suspected"] == ["friction"]
