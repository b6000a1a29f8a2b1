"""Tone, age and nails of a made hand: its material alone changes, and of no other hand."""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")
thenar = pytest.importorskip("thenar")

WHITE = np.array([0.2126, 0.7152, 0.0722])
"""Share of red, green and blue in luminance (Rec. 709)."""


@pytest.fixture
def hand(blender):
    bpy.ops.thenar.make_hand()
    return bpy.context.scene.thenar.hand


def rendered(hand, towards):
    """Mean linear color (3,) of the hand in a render from its back (-1) or its palm (1), evenly lit, and the pixels."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.seed = 4, 1
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 48, 48, 100
    scene.render.film_transparent = True
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format = "OPEN_EXR"
    if scene.world is None:
        scene.world = bpy.data.worlds.new("Even")
        scene.world.use_nodes = True
        scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    data = bpy.data.cameras.new("Look")
    data.type, data.ortho_scale = "ORTHO", 0.12
    camera = bpy.data.objects.new("Look", data)
    scene.collection.objects.link(camera)
    camera.location = (0.0, 0.06, towards * 0.5)
    camera.rotation_euler = (0.0 if towards > 0 else np.pi, 0.0, 0.0)
    scene.camera = camera
    path = bpy.app.tempdir + "look.exr"
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    pixels = np.array(image.pixels).reshape(-1, 4)
    bpy.data.images.remove(image)
    bpy.data.objects.remove(camera)
    return pixels[pixels[:, 3] > 0.99, :3].mean(axis=0)


def test_a_higher_tone_is_darker_and_the_palm_less_so(hand):
    back, palm = {}, {}
    for tone in (1.0, 2.0, 4.0, 6.0):
        hand.thenar_hand.tone = tone
        back[tone], palm[tone] = rendered(hand, -1) @ WHITE, rendered(hand, 1) @ WHITE
    assert back[1.0] > back[2.0] > 1.5 * back[4.0] > 2.5 * back[6.0] > 0.0
    assert palm[6.0] / palm[2.0] > 2.0 * back[6.0] / back[2.0]


def test_looks_change_neither_mesh_nor_contact(hand):
    before = np.empty(3 * len(hand.data.vertices), np.float32)
    hand.data.vertices.foreach_get("co", before)
    bpy.context.scene.thenar.result.is_valid = True
    shape = hand.thenar_hand
    shape.tone, shape.age, shape.nails = 5.0, 80.0, "POLISH"
    after = np.empty_like(before)
    hand.data.vertices.foreach_get("co", after)
    assert np.array_equal(before, after) and bpy.context.scene.thenar.result.is_valid


def nodes(hand):
    """Values of the nodes that hold the look."""
    found = hand.data.materials[0].node_tree.nodes
    return {node.name: np.ravel(node.outputs[0].default_value).tolist() for node in found if "Thenar" in node.name}


def test_every_look_reaches_the_material(hand):
    seen = [nodes(hand)]
    for name, value in (("tone", 5.0), ("age", 70.0), ("nails", "NONE"), ("nails", "POLISH"), ("polish", (0, 0, 1))):
        setattr(hand.thenar_hand, name, value)
        assert nodes(hand) not in seen, name
        seen.append(nodes(hand))


def test_two_hands_have_looks_of_their_own(hand):
    before = nodes(hand)
    bpy.ops.thenar.make_hand(side="left")
    bpy.context.scene.thenar.hand.thenar_hand.tone = 6.0
    assert nodes(hand) == before


def test_a_duplicate_that_shares_the_material_gets_its_own(hand):
    twin = hand.copy()
    twin.data = hand.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    before = nodes(hand)
    twin.thenar_hand.tone = 6.0
    assert nodes(hand) == before != nodes(twin)


def test_the_look_stays_when_the_size_changes(hand):
    hand.thenar_hand.tone = 5.0
    before = nodes(hand)
    hand.thenar_hand.percentile = 10.0
    assert nodes(hand) == before and hand.thenar_hand.tone == 5.0


def test_a_material_of_the_users_own_is_left_alone(hand):
    own = bpy.data.materials.new("Glove")
    hand.data.materials[0] = own
    hand.thenar_hand.tone = 6.0
    assert list(hand.data.materials) == [own]


@pytest.mark.parametrize("shape", [{}, {"percentile": 2.0, "sex": "female"}, {"side": "left"}])
def test_nails_are_drawn_where_the_library_has_them(blender, shape):
    """The outline, drawn from the attribute, parts nail from skin as the library's own marks do but for a seam."""
    bpy.ops.thenar.make_hand(**shape)
    hand = bpy.context.scene.thenar.hand
    places = np.empty(3 * len(hand.data.vertices), np.float32)
    hand.data.attributes["skin_nail"].data.foreach_get("vector", places)
    across, along, height = places.reshape(-1, 3).T
    truth = np.asarray(thenar.hand(**shape)["nails"], bool)
    box = (np.abs(across) < 1.0) & (np.abs(along) < 1.0) & (height < 0.0)
    assert (truth & ~box).sum() < 0.05 * truth.sum()
    middle = (np.abs(across) < 0.6) & (np.abs(along) < 0.6) & (height < 0.0)
    assert middle.sum() > 50 and not (middle & ~truth).any()
    far = (np.abs(across) > 1.05) | (np.abs(along) > 1.05) | (height > 0.0)
    assert not (far & truth).any()
