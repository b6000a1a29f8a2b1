"""Live: contact that follows hand, armature and product, and leaves no trace where it is not wanted."""

import ctypes
import os
import subprocess
import sys
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
import stage
import thenar_blender
from thenar_blender import names, native, status, workflow
from thenar_blender.live import session, watch
from thenar_blender.scene import checks, state
from thenar_blender.terminal import headless

MM = stage.MM
ALONE = "LIVE_ALONE"
"""Environment variable that tells a process which long session to run alone."""
LIVE_UPDATES = int(os.environ.get("LIVE_UPDATES", "500"))


def follow():
    """What the timer does in a window; background has no timers."""
    bpy.context.view_layer.update()
    return watch.follow_now(bpy.context)


def told():
    return status.live[bpy.context.scene.name]


def switch(on):
    bpy.context.scene.thenar.live = on


def force():
    return bpy.context.scene.thenar.result.force_n


def solved_apart(hand):
    """Positions, mm, and force that Solve finds for the scene as it stands, and the scene as it was."""
    switch(False)
    bpy.ops.thenar.clear()
    result = stage.solve()
    return stage.evaluated(hand), result.force_n


def test_contact_follows_the_product(scene):
    hand, product = stage.scene()
    switch(True)
    forces = []
    for _ in range(5):
        product.location.z += 0.2 * MM
        assert follow()
        forces.append(force())
    assert np.all(np.diff(forces) > 0.0)
    shown = stage.evaluated(hand)
    expected, wanted = solved_apart(hand)
    assert forces[-1] == pytest.approx(wanted, rel=1e-4)
    pressed = stage.attribute(hand, names.PRESSURE_KPA) > 0.0
    assert np.abs(shown - expected)[pressed].max() < 2e-3


def test_contact_follows_the_armature(scene):
    hand, product = stage.scene()
    stage.bend(hand)
    stage.raise_under(hand, product)
    switch(True)
    before, bone = force(), bpy.data.objects["Rig"].pose.bones["tip"]
    bone.rotation_euler.x += 0.02
    assert follow()
    assert force() != before
    bone.rotation_euler.x -= 0.02
    assert follow()
    assert force() == pytest.approx(before, rel=1e-4)


def test_own_output_is_not_read(scene):
    hand, product = stage.scene()
    switch(True)
    first, pressed = force(), stage.evaluated(hand)
    for _ in range(5):
        assert not follow()
        watch.forget()
        assert follow(), "a session that begins anew on a hand that shows a contact"
        assert force() == first
        assert np.array_equal(stage.evaluated(hand), pressed)


def test_at_rest_it_is_what_solve_leaves(scene):
    hand, product = stage.scene()
    stage.bend(hand)
    stage.raise_under(hand, product)
    switch(True)
    for lift in (0.3, 0.4, -0.6):
        product.location.z += lift * MM
        assert follow()
    assert watch.settle_now(bpy.context)
    shown, settled = stage.evaluated(hand), force()
    expected, wanted = solved_apart(hand)
    assert settled == wanted
    assert np.abs(shown - expected).max() < 5e-4 * 1.5  # the key keeps to 5e-4 of a displacement of about 1.5 mm


def test_frames_go_on_from_the_last_but_for_the_first_and_the_settled_one(scene, monkeypatch):
    hand, product = stage.scene()
    asked = []

    def begin(*arguments):
        made = begin_as_usual(*arguments)
        press = made.skin.press
        made.skin = SimpleNamespace(press=lambda *a, **k: (asked.append(k["live"]), press(*a, **k))[1])
        return made

    begin_as_usual = session.begin
    monkeypatch.setattr(session, "begin", begin)
    switch(True)
    for _ in range(3):
        product.location.z += 0.2 * MM
        assert follow()
    assert watch.settle_now(bpy.context)
    product.location.z += 0.2 * MM
    assert follow()
    assert asked == [False, True, True, True, False, True], "the first frame is that of switching on"


def test_the_skin_of_a_solve_is_not_prepared_again_and_keeps_its_effects(scene, monkeypatch):
    stage.scene()
    workflow.solve(bpy.context)
    made = []
    new_skin = workflow.new_skin
    monkeypatch.setattr(workflow, "new_skin", lambda *arguments: (made.append(arguments), new_skin(*arguments))[1])
    begun = session.begin(bpy.context, *workflow.check_objects(bpy.context))
    assert not made
    kept = workflow.prepared(begun.job)
    assert kept is not begun.skin
    kept.set_effects([native.module.Effect("friction")])
    assert not begun.skin.effects and kept.effects


def test_what_did_not_move_is_skipped(scene):
    hand, product = stage.scene()
    switch(True)
    bpy.ops.mesh.primitive_cube_add(location=(1.0, 0.0, 0.0))
    assert not follow()
    bpy.context.scene.thenar.hand.thenar.default_material.g0_kpa *= 2.0
    before = force()
    assert follow(), "a material is not a motion, but it counts"
    assert force() > 1.2 * before


def test_mistakes_keep_the_last_contact(scene):
    hand, product = stage.scene()
    switch(True)
    pressed, before = stage.evaluated(hand), force()
    product.hide_viewport = True
    assert not follow()
    assert "disabled in viewports" in told().problem
    assert np.array_equal(stage.evaluated(hand), pressed) and force() == before
    product.hide_viewport = False
    product.location.z += 0.1 * MM
    assert follow()
    assert not told().problem and force() > before


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (lambda hand: setattr(bpy.context.scene.thenar, "use_force", True), "Force Target"),
        (lambda hand: hand.modifiers.new("Mirror", "MIRROR"), "Mirror"),
        (lambda hand: hand.modifiers.new(names.BAKE_MODIFIER, "MESH_CACHE"), "plays a bake"),
        (lambda hand: setattr(bpy.context.scene.thenar, "product", None), "choose|product"),
    ],
    ids=["force", "mirror", "bake", "no product"],
)
def test_what_live_cannot_follow_is_told(scene, spoil, reason):
    hand, product = stage.scene()
    spoil(hand)
    switch(True)
    assert any(word in told().problem for word in reason.split("|"))
    assert own_traces(hand) == []


def own_traces(hand):
    """Names of what Live leaves on a hand while it is on."""
    return [
        found.name for found in (*hand.modifiers, *hand.data.attributes) if found.name.lower().startswith("thenar_live")
    ] + [modifier.name for modifier in hand.modifiers if modifier.name == names.LIVE_MODIFIER]


def test_off_leaves_what_solve_leaves(scene):
    hand, product = stage.scene()
    wanted = stage.solve().force_n
    key = np.array([point.co for point in hand.data.shape_keys.key_blocks[names.SHAPE_KEY].points])
    switch(True)
    assert hand.data.shape_keys is None and names.LIVE_MODIFIER in hand.modifiers
    with pytest.raises(RuntimeError, match="Live keeps the contact up to date"):
        bpy.ops.thenar.solve()
    switch(False)
    assert own_traces(hand) == [] and names.LIVE_MODIFIER not in bpy.data.node_groups
    assert force() == wanted
    assert np.array_equal([point.co for point in hand.data.shape_keys.key_blocks[names.SHAPE_KEY].points], key)


def test_frames_move_it_and_renders_do_not(scene, tmp_path):
    hand, product = stage.scene()
    for frame, lift in ((1, 0.0), (9, 0.8)):
        product.location.z += lift * MM
        product.keyframe_insert("location", frame=frame)
    scene.frame_set(1)
    switch(True)
    before = force()
    seen = []
    bpy.app.handlers.frame_change_post.append(lambda *_: seen.append(watch.follow_now(bpy.context)))
    try:
        scene.frame_set(5)
        assert seen == [True] and force() > before
        scene.camera = add_camera()
        scene.render.engine, scene.cycles.samples = "CYCLES", 1
        scene.render.resolution_x = scene.render.resolution_y = 4
        scene.frame_start, scene.frame_end = 6, 8
        scene.render.filepath = str(tmp_path / "frame")
        del seen[:]
        bpy.ops.render.render(animation=True)
        assert len(seen) >= 3 and not any(seen)
    finally:
        bpy.app.handlers.frame_change_post.pop()
    scene.frame_set(9)
    assert follow()


def test_it_goes_on_after_loading(scene, tmp_path):
    hand, product = stage.scene()
    switch(True)
    before, pressed = force(), stage.evaluated(hand)
    path = str(tmp_path / "live.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    settings = bpy.context.scene.thenar
    assert settings.live and follow()
    assert force() == before and np.array_equal(stage.evaluated(settings.hand), pressed)
    settings.product.location.z += 0.2 * MM
    assert follow() and force() > before


def test_command_line_solves_a_file_that_was_live(scene, tmp_path):
    stage.scene()
    switch(True)
    live, path = force(), tmp_path / "live.blend"
    with pytest.raises(checks.Refusal, match="switch it off"):
        workflow.solve(bpy.context)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    headless.open_file(path)
    assert workflow.solve(bpy.context).force_n == live
    assert own_traces(bpy.context.scene.thenar.hand) == []


def test_scenes_are_followed_apart(scene):
    stage.scene()
    switch(True)
    first = force()
    other = bpy.data.scenes.new("Other")
    bpy.context.window.scene = other
    _, product = stage.scene(top=-6.4)
    switch(True)
    deeper = force()
    assert deeper > first and set(status.live) == {scene.name, other.name}
    product.location.z += 0.1 * MM
    assert follow() and force() > deeper
    bpy.context.window.scene = scene
    assert not follow() and force() == first


def test_long_session_without_error_or_growth(scene, tmp_path):
    """Updates with saving, loading and rendering between; undo needs a window. `LIVE_UPDATES` tells how many.

    Blender itself keeps about 10 kB of every file that it loads and renders, so growth is measured against a session
    that does the same without Thenar. Each in a process of its own: what tests before it left to be freed would count.
    """
    alone, path = os.environ.get(ALONE), str(tmp_path / "long.blend")
    if alone is None:
        followed, bare = grown_alone("followed"), grown_alone("bare")
        print(f"{LIVE_UPDATES} updates: {followed:.2f} MB more than after 100, without Thenar {bare:.2f} MB")
        assert followed < bare + 1.0
        return
    stage.scene()
    if alone == "bare":
        thenar_blender.unregister()
        long_session(path, lambda: bpy.context.view_layer.update())
        thenar_blender.register()
        return
    switch(True)
    long_session(path, follow_well)
    assert len(bpy.data.node_groups) == 1 and len(bpy.context.scene.thenar.hand.modifiers) == 1


def follow_well():
    """Follow a motion without a problem."""
    assert follow() and not told().problem


def grown_alone(which):
    """MB by which one of the two sessions grows, in a process of its own.

    With one arena that is trimmed before it is read, what the allocator keeps for its threads does not count: it comes
    and goes by 10 MB.
    """
    command = [sys.executable, "-m", "pytest", "-s", "-q", __file__, "-k", "long_session"]
    environment = {**os.environ, ALONE: which, "MALLOC_ARENA_MAX": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return next(float(line.split()[1]) for line in done.stdout.splitlines() if line.startswith("grown "))


def long_session(path, update):
    """Move the product about and `update()`; save, load and render once in 100. Prints the MB since the first 100."""
    bpy.context.scene.render.engine, bpy.context.scene.cycles.samples = "CYCLES", 1
    bpy.context.scene.render.resolution_x = bpy.context.scene.render.resolution_y = 4
    bpy.context.scene.camera = add_camera()
    start, sizes = bpy.data.objects["Plate"].location.z, []
    for step, lift in enumerate(np.random.default_rng(0).uniform(-0.5, 0.5, LIVE_UPDATES)):
        bpy.data.objects["Plate"].location.z = start + lift * MM
        update()
        if step % 100 == 50:
            bpy.ops.wm.save_as_mainfile(filepath=path)
            bpy.ops.wm.open_mainfile(filepath=path)
        if step % 100 == 75:
            bpy.ops.render.render()
        if step % 100 == 99:
            sizes.append(resident_mb())
    print(f"\ngrown {sizes[-1] - sizes[0]:.3f} MB, from {sizes[0]:.1f}")


def add_camera():
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    return camera


def resident_mb():
    """Resident memory of this process, MB, without what its allocator could give back (Linux with glibc)."""
    ctypes.CDLL(None).malloc_trim(0)
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096 / 2**20


def test_skin_that_is_let_go_is_bare_again(scene):
    hand, product = stage.scene()
    switch(True)
    painted = stage.attribute(hand, names.COLOR).copy()
    hand.location.z += 5.0 * MM
    assert follow()
    assert force() == 0.0
    colors = stage.attribute(hand, names.COLOR)
    assert np.abs(painted - painted[-1]).max() > 0.1 and np.abs(colors - colors[0]).max() < 1e-6


@pytest.mark.parametrize("mover", ["product", "hand"])
def test_a_move_whose_press_failed_is_pressed_again(scene, monkeypatch, mover):
    moved = dict(zip(("hand", "product"), stage.scene(), strict=True))[mover]
    switch(True)
    before, press = force(), session._press

    def fail(*_):
        raise native.module.SolveError("the press failed on purpose")

    monkeypatch.setattr(session, "_press", fail)
    moved.location.z += (0.3 if mover == "product" else -0.3) * MM
    assert not follow() and "on purpose" in told().problem
    assert not follow() and "on purpose" in told().problem, "nothing moved since, and the move is still to be pressed"
    monkeypatch.setattr(session, "_press", press)
    assert follow() and not told().problem
    assert force() > before


def test_shapes_are_the_same_only_if_every_part_is(scene):
    _, product = stage.scene()
    seen = state.shapes(bpy.context, [product])
    assert state.is_same(state.shapes(bpy.context, [product]), seen)
    assert not state.is_same(seen, None) and not state.is_same(seen, seen[:-1])
    vertex, before = product.data.vertices[5], product.data.vertices[5].co.x
    vertex.co.x = float(np.nextafter(np.float32(before), np.float32(1.0)))
    product.data.update()
    bpy.context.view_layer.update()
    assert not state.is_same(state.shapes(bpy.context, [product]), seen), "the last digit of one coordinate counts"
    vertex.co.x = before
    product.data.update()
    bpy.context.view_layer.update()
    assert state.is_same(state.shapes(bpy.context, [product]), seen)
    product.vertex_groups.new(name="painted")
    assert not state.is_same(state.shapes(bpy.context, [product]), seen)
