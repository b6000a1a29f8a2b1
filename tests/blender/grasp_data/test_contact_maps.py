"""Contact maps hold what the solve left: points on the product, its outward normals, all of the force."""

import csv

import bpy
import numpy as np
import pytest
import stage
from mathutils import Euler


def written(path):
    """The arrays of a contact map."""
    assert bpy.ops.thenar.export_contact_map(filepath=str(path)) == {"FINISHED"}
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def test_points_lie_on_the_product_under_the_pressed_vertices(tmp_path):
    hand, product = stage.scene()
    result = stage.solve()
    found = written(tmp_path / "map.npz")
    force = stage.attribute(hand, "contact_force_n")
    assert np.array_equal(found["vertex"], np.flatnonzero(force > 0))
    assert found["force_n"].sum() == pytest.approx(result.force_n, rel=1e-5)
    assert np.array_equal(found["pressure_kpa"], stage.attribute(hand, "pressure_kpa")[found["vertex"]])
    world = found["world_from_object_mm"]
    on_plate = found["object_point_mm"] @ world[:3, :3].T + world[:3, 3]
    pressed = stage.evaluated(hand)[found["vertex"]]
    assert np.abs(on_plate[:, 2] - stage.evaluated(product)[:, 2].max()).max() < 1e-3, "the plate's upper face"
    assert np.abs(on_plate[:, :2] - pressed[:, :2]).max() < 0.05
    assert np.allclose(found["object_normal"] @ world[:3, :3].T, [0, 0, 1], atol=1e-5), "out of the plate"
    assert np.allclose(found["hand_point_mm"] @ world[:3, :3].T + world[:3, 3], pressed, atol=1e-3)
    assert np.allclose(
        found["object_vertices_mm"] @ world[:3, :3].T + world[:3, 3], stage.evaluated(product), atol=1e-3
    )
    assert set(found["region"]) == {"Whole skin"} and set(found["part"]) == {"Plate"}


def test_the_map_does_not_depend_on_the_place_of_the_product(tmp_path):
    hand, product = stage.scene()
    stage.solve()
    still = written(tmp_path / "still.npz")
    for obj in (hand, product):
        obj.matrix_world = Euler((0.4, -0.9, 1.7)).to_matrix().to_4x4() @ obj.matrix_world
        obj.location.x += 0.3
    stage.solve()
    moved = written(tmp_path / "moved.npz")
    common, a, b = np.intersect1d(still["vertex"], moved["vertex"], return_indices=True)
    assert len(common) > 0.95 * len(still["vertex"])
    assert np.abs(still["object_point_mm"][a] - moved["object_point_mm"][b]).max() < 0.05
    assert np.allclose(still["object_normal"][a], moved["object_normal"][b], atol=1e-3)


def test_regions_and_parts_are_named(tmp_path):
    hand, product = stage.scene()
    sides = hand.vertex_groups.new(name="a side"), hand.vertex_groups.new(name="b side")
    for vertex in hand.data.vertices:
        sides[vertex.co.x > 0].add([vertex.index], 1.0, "REPLACE")
    bpy.ops.thenar.assign_regions()
    stage.solve()
    found = written(tmp_path / "map.npz")
    west = np.array([hand.data.vertices[int(v)].co.x for v in found["vertex"]]) <= 0
    assert np.array_equal(found["region"] == "a side", west) and west.any() and not west.all()
    assert list(found["region_names"]) == ["a side", "b side"] and list(found["part_names"]) == ["Plate"]


def test_a_table_holds_the_same_rows(tmp_path):
    stage.scene()
    stage.solve()
    found = written(tmp_path / "map.npz")
    bpy.ops.thenar.export_contact_map(filepath=str(tmp_path / "map.csv"))
    rows = list(csv.DictReader((tmp_path / "map.csv").open()))
    assert [int(row["vertex"]) for row in rows] == found["vertex"].tolist()
    for prefix, name in (("hand", "hand_point_mm"), ("object", "object_point_mm")):
        values = [[float(row[f"{prefix}_{axis}_mm"]) for axis in "xyz"] for row in rows]
        assert np.allclose(values, found[name], atol=1e-4)
    assert np.allclose([[float(row[f"normal_{axis}"]) for axis in "xyz"] for row in rows], found["object_normal"])
    assert [float(row["pressure_kpa"]) for row in rows] == pytest.approx(found["pressure_kpa"].tolist(), rel=1e-6)
    assert {row["part"] for row in rows} == {"Plate"} and {row["region"] for row in rows} == {"Whole skin"}


def test_no_name_becomes_a_formula_in_a_spreadsheet(tmp_path):
    _, product = stage.scene()
    product.name = "=2+3"
    stage.solve()
    bpy.ops.thenar.export_contact_map(filepath=str(tmp_path / "map.csv"))
    assert {row["part"] for row in csv.DictReader((tmp_path / "map.csv").open())} == {"'=2+3"}


@pytest.mark.parametrize(("name", "sentence"), [("a.xyz", "no suffix of a contact map"), ("no/a.npz", "no folder")])
def test_places_that_are_refused(tmp_path, name, sentence):
    stage.scene()
    stage.solve()
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.thenar.export_contact_map(filepath=str(tmp_path / name))
    assert not list(tmp_path.iterdir())
