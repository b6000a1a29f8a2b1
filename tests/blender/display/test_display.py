"""Looks: pressure over the user's materials and back, colours after the range, the render preset and its legend."""

import bpy
import numpy as np
import pytest
import stage


def colors(obj):
    return stage.attribute(obj, "Thenar Pressure")


def test_materials_come_back():
    hand, product = stage.scene()
    own = bpy.data.materials.new("Leather")
    hand.data.materials.append(own)
    linked = bpy.data.materials.new("Paint")
    product.data.materials.append(None)
    product.material_slots[0].link = "OBJECT"
    product.material_slots[0].material = linked
    stage.solve()
    for _ in range(2):
        bpy.ops.thenar.show_pressure()
    assert hand.data.materials[0] == own, "the mesh keeps the user's material"
    shown = hand.material_slots[0].material
    assert shown.name == "Leather · pressure" and shown.node_tree.nodes.get("Thenar Pressure Overlay") is None
    assert any(node.type == "GROUP" for node in shown.node_tree.nodes)
    bpy.ops.thenar.show_pressure(show=False)
    assert hand.material_slots[0].material == own and hand.material_slots[0].link == "DATA"
    assert product.material_slots[0].material == linked and product.material_slots[0].link == "OBJECT"
    assert sorted(material.name for material in bpy.data.materials) == ["Leather", "Paint"]


def test_colors_follow_range_and_palette():
    hand, _ = stage.scene()
    stage.solve()
    settings = bpy.context.scene.thenar
    settings.range_kpa = 1000
    pale = colors(hand)
    settings.range_kpa = 10
    strong = colors(hand)
    pressure = stage.attribute(hand, "pressure_kpa")
    assert not np.allclose(pale, strong)
    assert np.array_equal(pale[pressure == 0], strong[pressure == 0]), "bare skin keeps its colour"
    settings.palette = "CIVIDIS"
    assert not np.allclose(colors(hand)[pressure > 0], strong[pressure > 0])
    bpy.ops.thenar.show_pressure()
    group = bpy.data.node_groups["Thenar Pressure Overlay"]
    settings.range_kpa = 77
    assert group.nodes["Range"].inputs["From Max"].default_value == 77


def test_live_colors_anew_only_where_something_presses_or_pressed(monkeypatch):
    from thenar_blender.live import watch
    from thenar_blender.skin_display import colors as scene_colors

    objects = stage.scene()
    bpy.context.scene.thenar.live = True
    colored, by_scale = [], scene_colors.by_scale
    monkeypatch.setattr(
        scene_colors, "by_scale", lambda fields, *look: colored.append(len(fields[0])) or by_scale(fields, *look)
    )

    def lifted(move):
        """By object, numbers of vertices that a rise of the hand (mm) colors anew, and that bear or bore pressure."""
        colored.clear()
        before = [stage.attribute(obj, "pressure_kpa") > 0 for obj in objects]
        objects[0].location.z += move * stage.MM
        bpy.context.view_layer.update()
        assert watch.follow_now(bpy.context)
        pressed = [was | (stage.attribute(obj, "pressure_kpa") > 0) for obj, was in zip(objects, before, strict=True)]
        return list(colored), [int(part.sum()) for part in pressed]

    for move in (-0.3, 9.0, -9.2):
        anew, pressed = lifted(move)
        assert len(anew) == 2 and all(0 < k <= most for k, most in zip(anew, pressed, strict=True)), (anew, pressed)
    lifted(9.0)
    assert lifted(1.0) == ([], [0, 0]), "nothing presses or pressed"


def test_fit_range_covers_the_peak():
    hand, product = stage.scene()
    stage.solve()
    bpy.ops.thenar.reset_range()
    peak = max(stage.attribute(obj, "pressure_kpa").max() for obj in (hand, product))
    assert peak <= bpy.context.scene.thenar.range_kpa <= 2 * peak


def test_render_preset_is_taken_back():
    stage.scene()
    stage.solve()
    scene = bpy.context.scene
    scene.view_settings.view_transform, scene.cycles.use_denoising = "AgX", True
    bpy.ops.thenar.render_preset()
    assert scene.view_settings.view_transform == "Standard" and not scene.cycles.use_denoising
    bpy.ops.thenar.render_preset(restore=True)
    assert scene.view_settings.view_transform == "AgX" and scene.cycles.use_denoising


def test_legend_is_laid_over_a_compositor_without_nodes():
    scene = bpy.context.scene
    if "compositor_effects" in scene.bl_rna.properties:
        pytest.skip("since Blender 5.3 the legend is an effect of its own: tests/packaging/test_whole_life.py")
    stage.scene()
    stage.solve()
    if hasattr(scene, "compositing_node_group"):
        scene.compositing_node_group = tree = bpy.data.node_groups.new("Mine", "CompositorNodeTree")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
    bpy.ops.thenar.render_preset()
    over = tree.nodes["Thenar Legend Over"]
    layers = next(node for node in tree.nodes if node.bl_idname == "CompositorNodeRLayers")
    assert [link.to_node.bl_idname for link in over.outputs[0].links] in (
        ["NodeGroupOutput"],
        ["CompositorNodeComposite"],
    )
    assert [link.to_node for link in layers.outputs["Image"].links] == [over]
    bpy.ops.thenar.render_preset(restore=True)
    assert "Thenar Legend Over" not in tree.nodes and len(layers.outputs["Image"].links) == 1


def rendered(path, **options):
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 4
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 160, 120, 100
    scene.render.filepath = str(path)
    bpy.ops.thenar.render_preset(**options)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    flat = np.empty(160 * 120 * 4, np.float32)
    image.pixels.foreach_get(flat)
    bpy.data.images.remove(image)
    return flat.reshape(120, 160, 4)[..., :3]


def test_rendered_pressure_has_the_legends_color(tmp_path):
    from thenar_blender import colormap

    hand, product = stage.scene()
    stage.solve()
    bpy.ops.thenar.show_pressure()
    hand.hide_render = True
    values = np.full(len(product.data.vertices), 90.0, np.float32)
    product.data.attributes["pressure_kpa"].data.foreach_set("value", values)
    product.data.attributes["contact_edge_mm"].data.foreach_set("value", np.full_like(values, 1.0))
    bpy.context.scene.thenar.palette = "VIRIDIS"
    bpy.context.scene.thenar.range_kpa = 150
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 0.02, (0, 0, 0.5)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    picture = rendered(tmp_path / "a.png")
    assert np.abs(picture[60, 100] - colormap.srgb("VIRIDIS", np.array([0.6]))[0]).max() < 0.01
    top = colormap.srgb("VIRIDIS", np.array([1.0]))[0]
    left = picture[:, :40].reshape(-1, 3)
    assert np.abs(left - top).max(axis=1).min() < 0.02, "the legend's top colour stands in the picture"
    plain = rendered(tmp_path / "b.png", restore=True)
    assert np.abs(plain[:, :40].reshape(-1, 3) - top).max(axis=1).min() > 0.05


def test_legend_can_write_without_blenders_font():
    from thenar_blender.views import legend, pixel_font

    settings, written = bpy.context.scene.thenar, "0123456789.+"
    for item in settings.maps.bl_rna.properties["shown"].enum_items:
        settings.maps.shown = item.identifier
        written += "".join(text for *_, text in legend.layout(settings, settings.result, 540, 0).texts)
    assert not [letter for letter in sorted(set(written) - {" "}) if not pixel_font.glyph(letter).any()]
    ink = pixel_font.ink([(10, 10, 20, "7")], 40, 40)
    assert ink[10:24, 10:20].any() and ink[23, 10:20].all(), "the bar of the seven is its top"


@pytest.mark.parametrize("name", ["CIVIDIS", "VIRIDIS"])
def test_lightness_of_the_maps_rises_evenly(name):
    from thenar_blender import colormap

    light = colormap.to_linear(colormap.srgb(name, np.linspace(0, 1, 200))) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(np.cbrt(light)) > 0).all()


def test_ember_begins_lighter_than_skin_and_its_lightness_falls():
    from thenar_blender import colormap

    light = colormap.to_linear(colormap.srgb("EMBER", np.linspace(0, 1, 200))) @ [0.2126, 0.7152, 0.0722]
    skin = colormap.to_linear(np.array([0.90, 0.74, 0.65])) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(np.cbrt(light)) < 0).all() and light[0] > skin


def test_values_that_are_no_numbers_or_out_of_range_take_the_ends_of_a_map():
    from thenar_blender import colormap

    ends = colormap.stops("VIRIDIS")[[0, 0, 0, -1, -1]]
    strange = np.array([np.nan, -np.inf, -2.0, 3.0, np.inf])
    assert np.abs(colormap.srgb("VIRIDIS", strange) - ends).max() < 1e-12
    assert np.array_equal(colormap.cover(strange), [0.0, 0.0, 0.0, 1.0, 1.0])


@pytest.mark.parametrize("palette", ["CIVIDIS", "VIRIDIS", "EMBER"])
def test_colors_of_pressure_from_the_table_are_those_that_the_map_computes(palette):
    from thenar_blender import maps
    from thenar_blender.skin_display import colors as scene_colors

    hand, _ = stage.scene()
    look, under = bpy.context.scene.thenar, scene_colors.ground(hand, scene_colors.SKIN)
    look.palette = palette
    for look.range_kpa in (4.0, 150.0, 900.0):
        scale = maps.scale(maps.MAPS[maps.PRESSURE], look)
        kpa, edge = np.random.default_rng(1).uniform(-0.1, 1.2, (2, 20_000)) * [[look.range_kpa], [3.0]]
        kpa[:3] = np.nan, 0.0, look.range_kpa
        computed = scene_colors.mapped((kpa, edge), scale, under)
        np.testing.assert_allclose(scene_colors.linear((kpa, edge), look, under), computed, rtol=0, atol=1e-6)


def test_an_attribute_settles_only_where_it_holds_something_else():
    from thenar_blender.scene import attributes

    mesh = stage.scene()[0].data
    values = np.arange(len(mesh.vertices), dtype=np.float32)
    attributes.settle(mesh, "settling", "FLOAT", values)
    assert np.array_equal(attributes.read(mesh, "settling"), values)
    attributes.settle(mesh, "settling", "FLOAT", values + 1.0)
    assert np.array_equal(attributes.read(mesh, "settling"), values + 1.0)
    attributes.settle(mesh, "settling", "FLOAT_VECTOR", np.ones((len(values), 3)))
    assert mesh.attributes["settling"].data_type == "FLOAT_VECTOR"
