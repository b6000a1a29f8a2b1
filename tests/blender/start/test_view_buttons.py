"""The view buttons change what is looked at and nothing else: a solve after them gives the same bytes."""

import bpy
import numpy as np
import pytest
import stage
from thenar_blender.looks import operators as looks

KINDS = ("OPENED", "PALM", "PRODUCT", "APART", "GLASS")


def state():
    """What a solve writes and reads, and what the user sees of the scene."""
    settings = bpy.context.scene.thenar
    hand, product = settings.hand, settings.product
    shown = [(obj.name, obj.hide_get(), obj.display_type, obj.hide_render) for obj in bpy.context.view_layer.objects]
    fields = [stage.attribute(obj, "pressure_kpa").tobytes() for obj in (hand, product)]
    return fields, stage.evaluated(hand).tobytes(), settings.result.force_n, shown, len(bpy.data.meshes)


def visible_meshes():
    return {obj.name for obj in bpy.context.view_layer.objects if obj.type == "MESH" and obj.visible_get()}


@pytest.fixture
def bent():
    hand, product = stage.scene()
    stage.bend(hand)
    stage.raise_under(hand, product)
    stage.solve()
    bpy.ops.thenar.show_pressure()
    return hand, product


@pytest.mark.parametrize("kind", KINDS)
def test_a_look_is_never_pressed_and_goes_without_a_trace(kind, bent):
    before = state()
    assert bpy.ops.thenar.look(kind=kind) == {"FINISHED"}
    assert bpy.ops.thenar.look_back.poll()
    everything = bpy.data.collections.new("Everything")
    for obj in bpy.data.objects:
        everything.objects.link(obj)
    bpy.context.scene.thenar.product_collection = everything
    stage.solve()
    bpy.data.collections.remove(everything)
    stage.solve()
    assert state()[:3] == before[:3]
    assert bpy.ops.thenar.look_back() == {"FINISHED"}
    assert state() == before and not bpy.ops.thenar.look_back.poll()


def test_what_each_look_shows(bent):
    hand, product = bent
    shown = {}
    for kind in KINDS:
        bpy.ops.thenar.look(kind=kind)
        shown[kind] = visible_meshes()
        stand_ins = [obj for obj in bpy.data.objects if obj.name.endswith("(view)")]
        assert all(obj.hide_render and obj.hide_select for obj in stand_ins)
        if kind in ("PALM", "GLASS"):
            assert product.display_type == "BOUNDS" and stand_ins[0].data.materials[0].diffuse_color[3] < 0.3
            assert not stand_ins[0].data.color_attributes
        if kind == "OPENED":
            flat = stage.evaluated(stand_ins[0])
            assert np.allclose(np.linalg.norm(flat, axis=1), 8.0, atol=0.01), "the ball without its bend and dent"
            assert stage.attribute(stand_ins[0], "pressure_kpa").max() > 1.0
        if kind == "APART":
            boxes = [stage.evaluated(obj) for obj in stand_ins]
            low, high = (np.array([getattr(box, side)(axis=0) for box in boxes]) for side in ("min", "max"))
            assert ((low[0] > high[1]) | (low[1] > high[0])).any(), "hand and product do not overlap"
    both = {"Pad", "Plate"}
    assert shown["OPENED"] == {"Pad (view)"} and shown["PRODUCT"] == {"Plate"}
    assert shown["APART"] == {"Pad (view)", "Plate (view)"}
    assert shown["PALM"] == shown["GLASS"] == both | {"Plate (view)"}


def test_undo_after_a_look_undoes_the_step_before_it(bent):
    bpy.ops.ed.undo_push(message="solved")
    bpy.data.objects["Plate"].location.x += 1.0
    bpy.ops.ed.undo_push(message="moved")
    bpy.ops.thenar.look("EXEC_DEFAULT", True, kind="APART")
    bpy.ops.ed.undo()
    assert bpy.data.objects["Plate"].location.x == 0.0
    assert not bpy.ops.thenar.look_back.poll() and {"Pad", "Plate"} <= visible_meshes()


def test_a_look_ends_with_the_map(bent):
    bpy.ops.thenar.look(kind="OPENED")
    bpy.ops.thenar.clear()
    assert visible_meshes() == {"Pad", "Plate"} and not bpy.ops.thenar.look.poll()


def test_solve_shows_the_map_where_it_is_asked_to_and_a_script_does_not():
    hand, _ = stage.scene()
    stage.solve()
    assert not hand.thenar.shows_pressure
    assert bpy.ops.thenar.solve(show_map=True) == {"FINISHED"}
    assert hand.thenar.shows_pressure and "Plate (view)" in bpy.data.objects
    bpy.ops.thenar.look_back()
    bpy.ops.thenar.solve(show_map=True)
    assert "Plate (view)" not in bpy.data.objects, "a look that was ended does not come back"


@pytest.mark.parametrize("kind", KINDS)
def test_a_look_is_never_exported(kind, bent, tmp_path):
    written = []
    for name in ("before", "after"):
        (tmp_path / name).mkdir()
        for suffix in (".csv", ".glb"):
            assert bpy.ops.thenar.export(filepath=str(tmp_path / name / f"hand{suffix}")) == {"FINISHED"}
        written.append({path.name: path.read_bytes() for path in (tmp_path / name).iterdir()})
        bpy.ops.thenar.look(kind=kind)
    assert written[0].keys() == written[1].keys() and written[0] == written[1]


def test_print_on_the_far_side_is_not_seen():
    """A ball pressed from below by as much as skin faces down: an eye above sees none, one below all but 4 %, where it
    is aslant; a plate below the ball hides all of it from there."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=64)
    ball = bpy.context.object.data
    points = np.array([vertex.co for vertex in ball.vertices])
    ball.calc_loop_triangles()
    triangles = np.array([tuple(face.vertices) for face in ball.loop_triangles])
    # Rings of equal angle crowd at the poles: weighed by the area that a vertex stands for.
    area = np.sqrt(1.0 - np.minimum(points[:, 2] ** 2, 1.0))
    pressure = np.maximum(-points[:, 2], 0.0) * area
    plate = np.array([(-2.0, -2.0, -1.5), (2.0, -2.0, -1.5), (2.0, 2.0, -1.5), (-2.0, 2.0, -1.5)])
    hidden = looks.Skin(
        np.vstack([points, plate]),
        np.vstack([points, 4 * [[0.0, 0.0, 1.0]]]),
        np.vstack([triangles, len(points) + np.array([(0, 1, 2), (0, 2, 3)])]),
    )
    ball, down = looks.Skin(points, points, triangles), np.array([0.0, 0.0, -1.0])
    assert looks.seen_share(ball, pressure, -down) == 0.0
    assert looks.seen_share(ball, pressure, down) == pytest.approx(1.0 - looks.FACED**2, abs=0.03)
    assert looks.seen_share(hidden, np.append(pressure, np.zeros(4)), down) == 0.0
