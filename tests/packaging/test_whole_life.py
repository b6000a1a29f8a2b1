"""The whole life of the extension in every Blender module of PyPI: built, validated, installed, used, uninstalled.

THENAR_BLENDERS names the versions, such as "4.2 5.3" (`cargo xtask blenders` sets it); by default those that
`cargo xtask test` makes for other tests. A version that is left out is named with the reason.
"""

import csv
import json
import os
import zipfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import products
import pytest

SCRIPT = Path(__file__).with_name("whole_life.py")
SAMPLES = products.ROOT / "blend-samples"
ASKED = os.environ.get("THENAR_BLENDERS", " ".join(products.BLENDERS.values())).split()
LIVED = {}
"""What was seen by version, for comparing them."""
TORN_DOWN = """
import bpy
class Held(bpy.types.PropertyGroup):
    x: bpy.props.FloatProperty(update=lambda self, context: None)
bpy.utils.register_class(Held)
bpy.utils.unregister_class(Held)
"""
"""Ends with a segmentation fault in the modules 4.2 and 4.3, without Thenar."""


@pytest.fixture(scope="module", params=[version for version in products.MATRIX if version in ASKED])
def life(request, tmp_path_factory):
    version, environment = request.param, products.MATRIX[request.param]
    if not (products.TARGET / environment).exists():
        pytest.skip(f"Blender {version}: target/{environment} is missing; `cargo xtask blenders {version}` makes it")
    out = tmp_path_factory.mktemp(f"blender{version}")
    scripts = products.blender_scripts(environment)
    ext = scripts / "addons_core/bl_pkg/cli/blender_ext.py"
    tags = f"--valid-tags={scripts / 'modules/_bpy_internal/extensions/tags.py'}"
    zip_path = out / products.ZIP.name
    stage = out / "stage"
    with zipfile.ZipFile(products.ZIP) as archive:
        archive.extractall(stage)
    built = products.run(environment, [ext, "build", f"--source-dir={stage}", f"--output-filepath={zip_path}", tags])
    valid = products.run(environment, [ext, "validate", tags, zip_path])
    end = products.run(
        environment,
        ["-W", "default", "-u", SCRIPT, zip_path, SAMPLES, out],
        seconds=600,
        BLENDER_USER_RESOURCES=str(out / "resources"),
    )
    seen = json.loads((out / "life.json").read_text()) if (out / "life.json").exists() else {"failed": "start"}
    LIVED[version] = seen
    return SimpleNamespace(
        version=version, environment=environment, out=out, zip=zip_path, built=built, valid=valid, end=end, seen=seen
    )


def test_zip_is_built_alike_and_valid(life):
    assert life.built.returncode == 0, life.built.stdout + life.built.stderr
    assert life.valid.returncode == 0, life.valid.stdout + life.valid.stderr
    assert contents(life.zip) == contents(products.ZIP)


def contents(path):
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist() if not name.endswith("/")}


def test_no_stage_fails(life):
    assert "failed" not in life.seen, f"{life.seen['failed']}\n{life.end.stdout}{life.end.stderr}"
    assert life.seen["install"]["blender"].startswith(life.version)


def test_the_zip_brings_the_native_module(life):
    installed = life.seen["install"]
    assert installed["done"] == ["FINISHED"] and installed["enabled"]
    assert Path(installed["native"]).is_relative_to(life.out / "resources/extensions/.local")


def test_every_sample_opens_without_a_warning(life):
    printed = (life.out / "open.txt").read_text()
    assert set(life.seen["open_samples"]) == {path.name for path in SAMPLES.glob("*.blend")}
    assert printed.count(".blend") == len(life.seen["open_samples"])
    assert not [word for word in ("newer", "arning", "rror") if word in printed], printed


def test_solve_reaches_the_force_that_the_table_sums_to(life):
    posed, asked = (life.seen["solve"][name] for name in ("as_posed", "asked"))
    assert posed["done"] == asked["done"] == ["FINISHED"] and posed["vertices"] > asked["vertices"] > 0
    assert asked["force_n"] == pytest.approx(3.0, rel=0.01)
    assert all(done == ["FINISHED"] for done in life.seen["maps"].values())
    rows = list(csv.DictReader((life.out / "press.csv").open()))
    assert len(rows) == life.seen["export"]["vertices"]
    assert sum(float(row["force_n"]) for row in rows) == pytest.approx(posed["force_n"], rel=1e-3)


def test_every_export_carries_the_pressure(life):
    with np.load(life.out / "press.npz", allow_pickle=False) as file:
        pressure_kpa = file["hand/pressure_kpa"]
    rows = csv.DictReader((life.out / "press.csv").open())
    assert np.allclose([float(row["pressure_kpa"]) for row in rows], pressure_kpa, rtol=1e-3, atol=1e-3)
    assert "_PRESSURE_KPA" in (life.out / "press.gltf").read_text()
    assert "primvars:pressure_kpa" in (life.out / "press.usda").read_text()


def test_live_follows_the_product_there_and_back(life):
    before, nearer, back = life.seen["live"]
    assert nearer > 1.01 * before > 0 and back == pytest.approx(before, rel=1e-3)


def test_bake_plays_and_survives_reloading(life):
    baked, reloaded = life.seen["bake"], life.seen["save_and_reload"]
    assert baked["done"] == ["FINISHED"] and reloaded["same"]
    first, middle, last = baked["played"]
    assert 0 < first < middle < last and reloaded["played"] == baked["played"]
    rows = list(csv.DictReader((life.out / "baked.csv").open()))
    forces = [float(row["force_n"]) for row in rows]
    assert forces[0] == pytest.approx(life.seen["solve"]["as_posed"]["force_n"], rel=1e-3)
    assert len(forces) == 3 and forces == sorted(forces)


def test_legend_is_in_the_render_and_nowhere_else(life):
    """The pictures differ in the left half alone, where the legend is; none is blank."""
    with np.load(life.out / "pictures.npz") as file:
        plain, legend, after = (file[name][..., :3] for name in ("plain", "with_legend", "after"))
    assert np.array_equal(plain, after) and plain.std() > 0.01
    changed = np.abs(legend - plain).max(axis=2) > 0.02
    half = changed.shape[1] // 2
    assert changed[:, :half].mean() > 0.1 and not changed[:, half:].any()


def test_legend_follows_no_effect_of_the_user(life):
    if life.seen["effects"] is None:
        pytest.skip(f"Blender {life.version} has no compositor effects")
    assert life.seen["effects"] == {"legends_and_active": [[1, 1], [1, 0], [0, 0]], "nodes": [0, 0], "groups_left": 0}


def test_a_hand_is_made(life):
    assert life.seen["make_hand"]["done"] == ["FINISHED"] and life.seen["make_hand"]["vertices"] > 5000


def test_disabling_and_uninstalling_leave_nothing(life):
    assert life.seen["disable"] == {"classes": [], "scene": False, "handlers": []}
    assert "thenar" in life.seen["uninstall"]["there"] and life.seen["uninstall"]["left"] == []


def test_nothing_deprecated_is_used(life):
    """Python shows deprecations under `-W default`, with the file that uses them."""
    log = life.end.stdout + life.end.stderr
    assert "Traceback" not in log, log
    ours = [line for line in log.splitlines() if "user_default/thenar" in line and "Warning:" in line]
    assert not ours, ours


def test_the_process_ends_by_itself(life):
    if life.end.returncode != 0:
        bare = products.run(life.environment, ["-c", TORN_DOWN])
        assert life.end.returncode == bare.returncode, life.end.stderr
        assert life.version in ("4.2", "4.3")


def test_command_line_ends_with_its_own_code(life, tmp_path):
    library = tmp_path / "library"
    with zipfile.ZipFile(life.zip) as archive:
        archive.extractall(library / "thenar_blender")
    for wheel in (library / "thenar_blender/wheels").glob("*.whl"):
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(library)
    variables = {"PYTHONPATH": str(library), "BLENDER_USER_RESOURCES": str(tmp_path / "resources")}
    call = ["-m", "thenar_blender", "solve", SAMPLES / "fingertip_on_plate.blend", "--force", "2"]
    done = products.run(life.environment, [*call, "--json", tmp_path / "solved.json"], **variables)
    assert done.returncode == 0, done.stdout + done.stderr
    assert json.loads((tmp_path / "solved.json").read_text())["force_n"] == pytest.approx(2.0, rel=0.01)
    refused = products.run(life.environment, [*call, "--hand", "Paw"], **variables)
    assert refused.returncode == 2 and "there is no object 'Paw' for the hand" in refused.stderr, refused.stderr


def test_every_version_that_was_asked_for_is_known():
    assert ASKED and set(ASKED) <= set(products.MATRIX)


def test_no_version_is_left_out():
    others = [version for version in products.MATRIX if version not in ASKED]
    if others:
        pytest.skip(f"Blender {', '.join(others)} not asked for; `cargo xtask blenders` lives all of them")


def test_every_version_sees_the_same():
    """Runs last: classes and, to float32, forces of the versions that were lived."""
    whole = {version: seen for version, seen in LIVED.items() if "failed" not in seen}
    if len(whole) < 2:
        pytest.skip("one version alone cannot differ from others")
    first = next(iter(whole.values()))
    for version, seen in whole.items():
        assert seen["install"]["classes"] == first["install"]["classes"], version
        assert seen["live"] == pytest.approx(first["live"], rel=1e-4), version
        assert seen["bake"]["played"] == pytest.approx(first["bake"]["played"], rel=1e-4), version
