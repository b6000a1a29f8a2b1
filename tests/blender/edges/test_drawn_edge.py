"""The edge of the map as it is drawn: rendered, baked, live, saved; on a ball it is Hertz' circle."""

import bpy
import numpy as np
import pytest
import stage
from proof import meshes
from thenar_blender import names

RADIUS_MM, REACH_MM = 60.0, 8.0
PIXELS, ACROSS_MM = 240, 24.0
MM = stage.MM


def made(name, mesh):
    data = bpy.data.meshes.new(name)
    data.from_pydata((mesh[0] * MM).tolist(), [], mesh[1].tolist())
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    data.materials.append(glowing())
    return obj


def glowing():
    """A light material without noise, the user's own."""
    material = bpy.data.materials.new("Own")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    tree = material.node_tree
    light = tree.nodes.new("ShaderNodeEmission")
    light.inputs["Color"].default_value = (0.1, 0.4, 0.9, 1.0)
    tree.links.new(light.outputs["Emission"], tree.nodes["Material Output"].inputs["Surface"])
    return material


def ball_on_half_space(seed=2):
    """A flat skin of 2.5 mm spacing without bone, and a ball whose contact has a radius of `REACH_MM`. Returns both."""
    hand = made("Skin", meshes.disc_patch(20.0, 2.5, 0.15, seed))
    center = (0.0, 0.0, RADIUS_MM - REACH_MM**2 / RADIUS_MM)
    product = made("Ball", meshes.sphere(RADIUS_MM, center, 14.0, 0.8))
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = hand, product
    hand.thenar.default_material.thickness_mm = 0.0
    bpy.context.view_layer.update()
    return hand, product


def seen_from(height):
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale, camera.location.z = "ORTHO", ACROSS_MM * MM, height
    camera.rotation_euler.x = 0.0 if height > 0.0 else np.pi
    camera.data.clip_start, camera.data.clip_end = 1e-3, 10.0
    scene.collection.objects.link(camera)
    scene.camera, scene.view_settings.view_transform = camera, "Standard"
    scene.render.engine, scene.cycles.samples = "CYCLES", 16
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    scene.render.resolution_percentage = 100
    scene.world = bpy.data.worlds.new("World")


def picture(path, shown):
    """What the camera sees of the object `shown` alone, sRGB (rows, columns, 3)."""
    for obj in bpy.context.scene.objects:
        obj.hide_render = obj.type == "MESH" and obj != shown
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    flat = np.empty(PIXELS * PIXELS * 4, np.float32)
    image.pixels.foreach_get(flat)
    bpy.data.images.remove(image)
    return flat.reshape(PIXELS, PIXELS, 4)[..., :3]


def drawn_radius(covered):
    """Radius of what is covered by angle (k,), mm: the area in each of 90 sectors, as the pixels have it."""
    place = (np.arange(PIXELS) + 0.5) / PIXELS * ACROSS_MM - ACROSS_MM / 2.0
    x, y = np.meshgrid(place, place)
    sector = np.floor((np.arctan2(y, x) / np.pi + 1.0) * 45.0).astype(int).clip(0, 89)
    area = np.bincount(sector[covered], minlength=90) * (ACROSS_MM / PIXELS) ** 2
    return np.sqrt(2.0 * area / (2.0 * np.pi / 90.0))


def test_a_rendered_map_ends_on_hertz_circle_on_skin_and_product(tmp_path):
    hand, product = ball_on_half_space()
    stage.solve()
    bpy.ops.thenar.show_pressure()
    bpy.context.scene.thenar.maps.contour = False
    hand.data.shape_keys.key_blocks["Thenar Contact"].mute = True  # flat again, so that the picture is to scale
    for shown, height in ((hand, 0.5), (product, -0.5)):
        seen_from(height)
        with_map = picture(tmp_path / "map.png", shown)
        bpy.ops.thenar.show_pressure(show=False)
        without = picture(tmp_path / "own.png", shown)
        bpy.ops.thenar.show_pressure()
        differs = np.abs(with_map - without).max(axis=2)
        radius = drawn_radius(differs > 0.5 * differs.max())
        rms = np.sqrt(np.mean((radius - REACH_MM) ** 2))
        print(f"{shown.name}: drawn edge off Hertz' circle by {rms:.3f} mm rms, mean {np.mean(radius) - REACH_MM:+.3f}")
        assert rms <= 0.3
        away = np.hypot(*np.mgrid[-12.0:12.0:240j, -12.0:12.0:240j]) > REACH_MM + 1.0
        assert differs[away].max() < 1e-3, "off the contact there is the object's own look"


def test_a_line_is_drawn_along_the_edge_unless_it_is_switched_off(tmp_path):
    hand, _ = ball_on_half_space()
    stage.solve()
    bpy.ops.thenar.show_pressure()
    hand.data.shape_keys.key_blocks["Thenar Contact"].mute = True
    seen_from(0.5)
    across = np.hypot(*np.mgrid[-12.0:12.0:240j, -12.0:12.0:240j])
    near = np.abs(across - REACH_MM) < 1.0
    dark = {}
    for contour in (True, False):
        bpy.context.scene.thenar.maps.contour = contour
        lit = picture(tmp_path / "line.png", hand)
        dark[contour] = lit.max(axis=2) < 0.5
    assert not dark[False][across < REACH_MM - 1.0].any(), "the low end of the colors is light"
    line = dark[True] & near
    pixel = ACROSS_MM / PIXELS
    width = line.sum() * pixel**2 / (2.0 * np.pi * REACH_MM)
    print(f"line of {width:.2f} mm")
    assert 0.2 < width < 0.6 and not dark[True][~near & (across < REACH_MM)].any()


def test_colors_of_vertices_end_on_the_same_circle():
    """Solid view blends them linearly: where they are half covered lies the edge."""
    from thenar_blender.skin_display import colors

    hand, product = ball_on_half_space()
    hand_z = stage.evaluated(hand)
    stage.solve()
    settings = bpy.context.scene.thenar
    settings.palette, settings.range_kpa = "VIRIDIS", 1e6  # all pressures in the first color
    for obj, bare, points in ((hand, colors.SKIN, hand_z), (product, colors.BARE, stage.evaluated(product))):
        color = stage.attribute(obj, "Thenar Pressure")[:, 1]
        low, high = color.min(), color.max()
        assert high - low > 0.1, bare
        middle = 0.5 * (low + high)
        obj.data.calc_loop_triangles()
        ends = np.array([edge.vertices[:] for edge in obj.data.edges])
        one, other = color[ends].T
        cut = (one > middle) != (other > middle)
        share = ((middle - one[cut]) / (other[cut] - one[cut]))[:, None]
        place = points[ends[cut, 0]] + share * (points[ends[cut, 1]] - points[ends[cut, 0]])
        rms = np.sqrt(np.mean((np.hypot(place[:, 0], place[:, 1]) - REACH_MM) ** 2))
        print(f"{obj.name}: half covered off Hertz' circle by {rms:.3f} mm rms")
        assert rms <= 0.45


@pytest.mark.parametrize("link", ["DATA", "OBJECT"])
def test_colors_of_vertices_keep_the_materials_own_off_the_contact(link):
    hand, product = ball_on_half_space()
    tints = [(0.1, 0.2, 0.6, 1.0), (0.7, 0.1, 0.1, 1.0)]
    for tint in tints:
        material = bpy.data.materials.new("Tint")
        material.diffuse_color = tint
        product.data.materials.append(material)
    product.data.materials.pop(index=0)
    upper = [face.center.z > 0.02 for face in product.data.polygons]
    product.data.polygons.foreach_set("material_index", upper)
    for slot, material in zip(product.material_slots, list(product.data.materials), strict=True):
        slot.link = link
        slot.material = material
    stage.solve()
    height = np.array([vertex.co.z for vertex in product.data.vertices])
    far = stage.attribute(product, names.EDGE_MM) < -4.9
    for shown in (True, False):
        bpy.ops.thenar.show_pressure(show=shown)
        color = stage.attribute(product, "Thenar Pressure")
        for rows, tint in ((far & (height > 0.04), tints[1]), (far & (height < 0.01), tints[0])):
            assert rows.any() and np.abs(color[rows] - tint).max() < 1e-6
        inside = stage.attribute(product, names.EDGE_MM) > 3.0
        assert inside.any() and np.abs(color[inside] - tints[0]).max(axis=1).min() > 0.2


def edges(*objects):
    return [stage.attribute(obj, names.EDGE_MM).copy() for obj in objects]


def test_a_bake_plays_the_edge_of_every_frame(tmp_path):
    hand, product = ball_on_half_space()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "bake.blend"))
    solved = {}
    for frame, lift in ((1, 0.0), (2, 0.4)):
        product.location.z = lift * MM
        product.keyframe_insert("location", frame=frame)
        bpy.context.scene.frame_set(frame)
        stage.solve()
        solved[frame] = edges(hand, product)
        bpy.ops.thenar.clear()
        assert names.EDGE_MM not in hand.data.attributes and names.EDGE_MM not in product.data.attributes
    assert bpy.ops.thenar.bake(frame_start=1, frame_end=2) == {"FINISHED"}
    for frame in (2, 1):
        bpy.context.scene.frame_set(frame)
        for played, wanted in zip(edges(hand, product), solved[frame], strict=True):
            assert np.abs(played - wanted).max() < 1e-3
    assert np.abs(solved[1][0] - solved[2][0]).max() > 0.5, "the frames differ"


def test_frames_that_follow_one_another_have_the_edge_too(tmp_path):
    """With friction the product is kept as it was in the first frame, and moves as a whole."""
    hand, product = ball_on_half_space()
    assert bpy.ops.thenar.effect_add(kind="friction") == {"FINISHED"}
    hand.thenar.effects[0].numbers["coefficient"].value = 1e-3
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "follow.blend"))
    for frame, lift in ((1, 2.0), (2, 0.0)):
        product.location.z, product.location.x = lift * MM, 0.3 * lift * MM
        product.keyframe_insert("location", frame=frame)
    assert bpy.ops.thenar.bake(frame_start=1, frame_end=2) == {"FINISHED"}
    bpy.context.scene.frame_set(1)
    assert all((edge < 0.0).all() for edge in edges(hand, product)), "free"
    bpy.context.scene.frame_set(2)
    played = edges(hand, product)
    hand.thenar.effects.clear()
    bpy.ops.thenar.clear()
    stage.solve()
    for edge, wanted in zip(played, edges(hand, product), strict=True):
        near = np.abs(wanted) < 2.0
        assert np.sqrt(np.mean((edge - wanted)[near] ** 2)) < 0.1


def test_the_edge_is_kept_in_the_file_and_goes_and_comes_with_undo_and_redo(tmp_path):
    ball_on_half_space()
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.ed.undo_push(message="before")
    stage.solve()
    bpy.ops.thenar.show_pressure()
    settings = bpy.context.scene.thenar
    before = edges(settings.hand, settings.product)
    bpy.ops.ed.undo_push(message="solved")
    bpy.ops.ed.undo()
    settings = bpy.context.scene.thenar
    assert names.EDGE_MM not in settings.hand.data.attributes
    bpy.ops.ed.redo()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "kept.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    settings = bpy.context.scene.thenar
    for was, now in zip(before, edges(settings.hand, settings.product), strict=True):
        assert np.array_equal(was, now)


@pytest.mark.parametrize("kind", ["PRESSURE", "DEPTH"])
def test_a_result_of_an_earlier_version_gets_its_edge_when_it_is_shown(kind):
    hand, product = ball_on_half_space()
    stage.solve()
    truth = edges(hand)[0]
    for obj in (hand, product):
        for name in (names.EDGE_MM, names.OVERLAP_MM):
            if name in obj.data.attributes:
                obj.data.attributes.remove(obj.data.attributes[name])
    assert bpy.ops.thenar.show_map(kind=kind) == {"FINISHED"}
    found = edges(hand)[0]
    near = np.abs(truth) < 2.0
    assert np.sqrt(np.mean((found - truth)[near] ** 2)) < 0.5
    assert ((found > 0.0) == (stage.attribute(hand, "pressure_kpa") > 0.0)).all()
    overlap = stage.attribute(hand, names.OVERLAP_MM)
    assert ((overlap > 0.0) == (stage.attribute(hand, "contact_depth_mm") > 0.0)).all()


def test_live_writes_the_edge_while_a_map_shows_and_solve_agrees():
    from thenar_blender.live import watch

    hand, product = ball_on_half_space()
    settings = bpy.context.scene.thenar
    settings.live = True
    assert stage.attribute(hand, "pressure_kpa").max() > 0.0
    assert names.EDGE_MM not in hand.data.attributes, "nobody looks at it"
    bpy.ops.thenar.show_pressure()
    assert watch.follow_now(bpy.context), "a map that is shown needs the edge"
    product.location.z += 0.3 * MM
    bpy.context.view_layer.update()
    assert watch.follow_now(bpy.context) and not watch.follow_now(bpy.context)
    assert watch.settle_now(bpy.context)
    live = edges(hand, product)
    settings.live = False
    stage.solve()
    for was, now in zip(live, edges(hand, product), strict=True):
        assert np.abs(was - now).max() < 1e-3
