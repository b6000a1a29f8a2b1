"""Drives a Blender window: a preset is chosen and undone, a pose is blended in and undone, pose assets are clicked.

Not a test of pytest: a window is needed. `drive(bpy, ui)` is a generator that yields seconds to wait; `ui` clicks at
pixels of a window of 1600 x 1000 and takes pictures. Hand, presets and library are made by script, all else by clicks.
Raises where what a click should do does not happen, and prints what the steps left.
"""

PRESETS, PALM, BLEND, SLIDER = (1135, 835), (1085, 860), (1215, 537), (1436, 609)
ASSETS = (500, 865), (660, 865)
"""Where the buttons are in Blender 5.2's sidebar and asset shelf at their default sizes."""


def drive(bpy, ui):
    """Presets, blend, asset shelf, with a picture of each step."""
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    bpy.ops.mesh.primitive_cylinder_add(radius=0.024, depth=0.12, location=(0.3, 0, 0))
    product = bpy.context.object
    for _ in range(2):
        ui.sidebar("Thenar")
        yield 1
    place = view(bpy)
    with bpy.context.temp_override(**place):
        bpy.ops.thenar.make_hand()
        bpy.context.scene.thenar.product = product
        assert bpy.ops.thenar.add_pose_library() == {"FINISHED"}
        bpy.ops.thenar.preset_save(kind="SKIN_MATERIAL", name="Palm", replace=True)
        material(bpy).g0_kpa = 11.0
        bpy.ops.ed.undo_push(message="set up")
    for name in ("THENAR_PT_hand", "THENAR_PT_materials"):
        panel = getattr(bpy.types, name)
        bpy.utils.unregister_class(panel)
        panel.bl_options = set()
        bpy.utils.register_class(panel)
    yield 2
    saved, start = 23.0, turn(bpy)
    yield from press(ui, PRESETS)
    ui.shot("p0_presets")
    yield from press(ui, PALM)
    assert abs(material(bpy).g0_kpa - saved) < 1e-3, material(bpy).g0_kpa
    yield from undo(ui)
    assert abs(material(bpy).g0_kpa - 11.0) < 1e-3, material(bpy).g0_kpa
    yield from press(ui, BLEND)
    yield from press(ui, SLIDER)
    ui.key("ctrl+a")
    yield 0.3
    ui.type("1")
    yield 0.5
    ui.key("Return")
    yield 2
    ui.shot("p1_blend")
    assert turn(bpy) != start
    ui.key("Escape")
    yield 1
    yield from undo(ui)
    assert turn(bpy) == start, "one Ctrl+Z takes the blend back"
    rig = bpy.context.scene.thenar.hand.parent
    with bpy.context.temp_override(**place):
        for obj in bpy.context.selected_objects:
            obj.select_set(False)
        rig.select_set(True)
        bpy.context.view_layer.objects.active = rig
        bpy.ops.object.mode_set(mode="POSE")
        bpy.ops.pose.select_all(action="SELECT")
    yield 3
    if next(region for region in place["area"].regions if region.type == "ASSET_SHELF").height < 30:
        with bpy.context.temp_override(**place):
            bpy.ops.screen.region_toggle(region_type="ASSET_SHELF")
    yield 12
    seen = [start]
    for asset in ASSETS:
        yield from press(ui, asset)
        yield 1
        seen.append(turn(bpy))
    ui.shot("p2_assets")
    assert len(set(seen)) == 3, seen
    print(f"STEPS preset {saved:g} kPa and back, blend and back, two pose assets: {seen}")


def view(bpy):
    """The 3D view, as an override of the context."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    return {"window": window, "area": area, "region": next(r for r in area.regions if r.type == "WINDOW")}


def material(bpy):
    """The first region's material."""
    return bpy.context.scene.thenar.hand.thenar.materials[0]


def turn(bpy):
    """How the index finger's middle bone is turned, rounded."""
    bone = bpy.context.scene.thenar.hand.parent.pose.bones["index_middle"]
    return tuple(round(value, 3) + 0.0 for value in bone.rotation_euler)


def undo(ui):
    """Ctrl+Z over the 3D view."""
    ui.move(600, 860)
    yield 1
    ui.move(600, 500)
    yield 1
    ui.key("ctrl+z")
    yield 2


def press(ui, place):
    """Move onto a button, wait until the window has seen it, and click, as a hand does."""
    ui.move(place[0] - 4, place[1])
    yield 0.4
    ui.move(*place)
    yield 0.5
    ui.click(*place)
    yield 1.2
