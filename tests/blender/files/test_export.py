"""Files written from a result hold its numbers."""

import csv
import json

import bpy
import numpy as np
import pytest
import stage


def test_csv_holds_every_vertex(tmp_path):
    hand, product = stage.scene()
    result = stage.solve()
    bpy.ops.thenar.export(filepath=str(tmp_path / "press.csv"))
    rows = list(csv.DictReader((tmp_path / "press.csv").open()))
    assert len(rows) == len(hand.data.vertices)
    assert sum(float(row["force_n"]) for row in rows) == pytest.approx(result.force_n, rel=1e-4)
    places = np.array([[float(row[f"{axis}_mm"]) for axis in "xyz"] for row in rows])
    assert np.abs(places - stage.evaluated(hand)).max() < 1e-3
    assert {row["in_contact"] for row in rows} == {"0", "1"}
    assert len(list(csv.DictReader((tmp_path / "press-Plate.csv").open()))) == len(product.data.vertices)
    assert not list(tmp_path.glob(".*"))


def test_npz_holds_arrays_and_summary(tmp_path):
    hand, _ = stage.scene()
    result = stage.solve()
    bpy.ops.thenar.export(filepath=str(tmp_path / "press.npz"))
    with np.load(tmp_path / "press.npz", allow_pickle=False) as file:
        assert np.array_equal(file["hand/pressure_kpa"], stage.attribute(hand, "pressure_kpa"))
        assert "product-Plate/pressure_kpa" in file.files
        assert json.loads(str(file["summary_json"]))["force_n"] == pytest.approx(result.force_n)


def test_gltf_carries_the_pressure(tmp_path):
    hand, _ = stage.scene()
    stage.solve()
    path = tmp_path / "press.gltf"
    bpy.ops.thenar.export(filepath=str(path))
    accessors = [
        primitive["attributes"] for mesh in json.loads(path.read_text())["meshes"] for primitive in mesh["primitives"]
    ]
    assert any("_PRESSURE_KPA" in attributes for attributes in accessors)
    assert "_PRESSURE_KPA" not in hand.data.attributes, "the copy for the file is taken away again"


def test_usd_carries_the_pressure(tmp_path):
    stage.scene()
    stage.solve()
    bpy.ops.thenar.export(filepath=str(tmp_path / "press.usda"))
    assert "primvars:pressure_kpa" in (tmp_path / "press.usda").read_text()


@pytest.mark.parametrize(("name", "sentence"), [("a.xyz", "no suffix that Thenar writes"), ("no/a.csv", "no folder")])
def test_refused_places(tmp_path, name, sentence):
    stage.scene()
    stage.solve()
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.thenar.export(filepath=str(tmp_path / name))
