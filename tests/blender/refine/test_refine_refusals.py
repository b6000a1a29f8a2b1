"""What Refine Skin refuses, by object and remedy, and that it then leaves the hand as it was; when it is offered."""

from types import SimpleNamespace

import bpy
import fine_features
import pytest
import stage
from test_panels import Context, Layout
from thenar_blender import panels
from thenar_blender.panels import text


@pytest.fixture
def hand():
    """A ball that a wire passes through between its vertices."""
    hand = fine_features.ball()
    fine_features.wire(
        fine_features.gap_place(fine_features.points_mm(hand), fine_features.triangles_of(hand)), radius=0.5, sunk=0.4
    )
    return hand


def refused(hand, words):
    """Press, expect a sentence with `words`, and see that nothing changed."""
    count, keys = len(hand.data.vertices), hand.data.shape_keys
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.thenar.refine_skin()
    assert len(hand.data.vertices) == count and hand.data.shape_keys == keys


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("SUBSURF", r"'Own' \(Subdivision\) of 'Pad' would give a refined mesh another shape; raise its level"),
        ("MULTIRES", r"'Own' \(Multiresolution\) of 'Pad' .*apply it"),
        ("MESH_CACHE", r"'Own' of 'Pad' plays positions by vertex number; apply or remove it"),
    ],
)
def test_modifiers_that_need_the_vertices_as_they_are(hand, kind, words):
    modifier = hand.modifiers.new("Own", kind)
    refused(hand, words)
    hand.modifiers.remove(modifier)
    fine_features.refine()


def test_what_is_bound_to_vertices(hand):
    other = bpy.data.objects.new("Ring", None)
    bpy.context.scene.collection.objects.link(other)
    other.parent, other.parent_type = hand, "VERTEX"
    refused(hand, "'Ring' is parented to vertices of 'Pad'; parent it to a bone instead")
    other.parent = None
    fine_features.refine()


def test_a_subdivision_that_changes_no_shape_is_no_obstacle(hand):
    hand.modifiers.new("Own", "SUBSURF").subdivision_type = "SIMPLE"
    fine_features.refine()


def test_a_mesh_of_several_objects(hand):
    other = bpy.data.objects.new("Other", hand.data)
    refused(hand, "the mesh of 'Pad' is shared by several objects, .*Make Single User".replace("the", "[Tt]he", 1))
    bpy.data.objects.remove(other)
    fine_features.refine()


def test_a_linked_mesh(hand, tmp_path):
    path = str(tmp_path / "own.blend")
    bpy.data.libraries.write(path, {hand})
    with bpy.data.libraries.load(path, link=True) as (source, target):
        target.objects = ["Pad"]
    linked = next(obj for obj in bpy.data.objects if obj.library is not None)
    bpy.context.scene.collection.objects.link(linked)
    bpy.context.scene.thenar.hand = linked
    refused(linked, "'Pad' is linked from a library; use Object > Relations > Make Local")


def test_edit_mode(hand):
    bpy.context.view_layer.objects.active = hand
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match=r"[Gg]o back to Object Mode first \(Tab\)"):
        bpy.ops.thenar.refine_skin()
    bpy.ops.object.mode_set(mode="OBJECT")
    fine_features.refine()


def test_a_product_that_is_far_and_skin_that_is_fine_enough(hand):
    product = bpy.context.scene.thenar.product
    home = product.location.copy()
    product.location.z += 0.1
    bpy.context.view_layer.update()
    refused(
        hand, "No skin of 'Pad' comes within 1 mm of 'Wire', so nothing was refined; move hand and product together"
    )
    product.location = home
    bpy.context.view_layer.update()
    fine_features.refine(3)
    refused(hand, "'Pad' is (already as fine as 'Wire' needs|as fine as may be where 'Wire' is close)")


def test_a_smooth_contact_of_many_vertices_needs_nothing():
    hand, _ = stage.scene(top=-7.0)
    refused(hand, "The skin of 'Pad' is already as fine as 'Plate' needs where they are close; give a Spacing")


def test_too_many_vertices(hand, monkeypatch):
    from thenar_blender.refining import planning

    monkeypatch.setattr(planning, "MOST_VERTICES", 200)
    refused(hand, "'Pad' would have 242 vertices, more than the 200 allowed; give a larger Spacing")


def test_a_bake_of_the_old_vertices(hand, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "grip.blend"))
    assert bpy.ops.thenar.bake(frame_start=1, frame_end=2) == {"FINISHED"}
    hand = bpy.context.scene.thenar.hand
    refused(hand, "'Pad' plays a bake, which belongs to the vertices that the hand has now; press Clear first")
    assert hand.thenar.bake_path
    bpy.ops.thenar.clear()
    fine_features.refine()
    assert not hand.thenar.bake_path and not hand.modifiers


def test_live(hand):
    bpy.context.scene.thenar.live = True
    with pytest.raises(RuntimeError, match="Live keeps the contact"):
        bpy.ops.thenar.refine_skin()
    bpy.context.scene.thenar.live = False


def offered(panel):
    """Whether a panel shows the button now."""
    said = []
    panel.draw(SimpleNamespace(layout=Layout(text.width(Context()), said)), Context())
    return "Refine Skin" in [words for words, _ in said]


def test_the_button_is_shown_where_finer_skin_helps(hand):
    stage.solve()
    assert offered(panels.result.THENAR_PT_result)  # between vertices
    fine_features.refine()
    assert stage.solve().reason_kind == "few_vertices" and offered(panels.result.THENAR_PT_result)
    fine_features.refine(2)
    assert stage.solve().grade == "good" and not offered(panels.result.THENAR_PT_result)
    product = bpy.context.scene.thenar.product
    product.location.z += 0.1
    bpy.context.view_layer.update()
    result = stage.solve()
    assert result.reason_kind == "no_contact" and not result.passes_between
    assert not offered(panels.result.THENAR_PT_result)
    result.reason_kind = "product_between_vertices"
    assert offered(panels.result.THENAR_PT_result)


def test_the_button_is_shown_below_a_refusal_and_a_note_that_ask_for_it(hand):
    settings = bpy.context.scene.thenar
    fine_features.refine(2)
    assert stage.solve().grade == "good" and not offered(panels.main.THENAR_PT_main)
    settings.refusal.text = "The contact was not solved: open the hand a little there, or refine the hand's mesh there"
    assert offered(panels.main.THENAR_PT_main)
    settings.refusal.text = "The shown skin of 'Pad' stays 0.2 mm from the contact"
    assert not offered(panels.main.THENAR_PT_main)
    settings.refusal.text = ""
    assert settings.result.shown_between_mm > 0.1 and offered(panels.result.THENAR_PT_notes)
    settings.result.shown_between_mm = 0.05
    assert not offered(panels.result.THENAR_PT_notes)
