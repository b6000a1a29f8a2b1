"""Pictures of a result: the scene, the hand's pressure map on its rest shape, and the product from both sides."""

from contextlib import ExitStack

import bpy
import numpy as np
from mathutils import Matrix, Vector

from . import maps, names
from .operators import display
from .ownership import own
from .scene import attributes, mesh
from .scene.checks import Refusal
from .views import compositor

SAMPLES = 24
WIDEST = 640
"""Pixels: a picture of a result is no larger, so that a processor renders it in a minute or so."""
HIGHEST = 2 * WIDEST
LONGEST_S = 300.0
"""Seconds after which the rays of a picture end, whatever the scene holds; what they found so far is denoised."""
_FILL = (1.5, 1.1)
"""Width and height of the picture over those of what it shows; the legend stands in the rest of the width."""
_LEGEND_SHIFT = 0.1
"""Share of the picture by which what it shows gives way to the legend."""


def render_scene(context, path, kind=None):
    """Render the scene as its camera sees it, with the map (`kind`, or the one shown) and its legend.

    A camera is made where there is none. Raises `Refusal` where the hand does not carry the map.
    """
    scene = context.scene
    with ExitStack() as undo:
        _prepare(context, undo, kind)
        if scene.camera is None:
            settings = scene.thenar
            _aim(context, undo, _world(settings.hand), (Vector((0.5, -1.0, 0.6)), Vector((0, 0, 1))))
        _light(context, undo)
        _render(scene, path)


def render_hand(context, path):
    """Render the palm of the rest pose with the pressure of the grasp: a handprint."""
    hand = context.scene.thenar.hand
    with ExitStack() as undo:
        _prepare(context, undo)
        _show_only(context, undo, [hand])
        for modifier in hand.modifiers:
            if modifier.type == "ARMATURE":
                _set(undo, modifier, "show_viewport", False)
                _set(undo, modifier, "show_render", False)
        key = own.contact_key(hand)
        if key is not None:
            _set(undo, key, "mute", True)
        context.view_layer.update()
        points = _world(hand)
        _aim(context, undo, points, _palm_view(hand, points))
        _studio(context, undo)
        _render(context.scene, path)


def render_product(context, path, turn):
    """Render the product alone, seen from where it is pressed most, turned by `turn` radians about its long axis."""
    shown = [obj for obj, is_skin in display.shown_objects(context) if not is_skin]
    with ExitStack() as undo:
        _prepare(context, undo, maps.PRESSURE)
        _show_only(context, undo, shown)
        points = np.concatenate([_world(obj) for obj in shown])
        away, up = _pressed_side(shown)
        away = Matrix.Rotation(turn, 3, up) @ away
        across = up.cross(away) if _long_axis(points) is not None else up
        _aim(context, undo, points, (away, across))
        _studio(context, undo)
        _render(context.scene, path)


def beside(paths, target):
    """Put pictures of one height side by side into `target`."""
    images = [bpy.data.images.load(str(path)) for path in paths]
    arrays = []
    for image in images:
        flat = np.empty(image.size[0] * image.size[1] * 4, np.float32)
        image.pixels.foreach_get(flat)
        arrays.append(flat.reshape(image.size[1], image.size[0], 4))
        bpy.data.images.remove(image)
    joined = np.concatenate(arrays, axis=1)
    picture = bpy.data.images.new("Thenar Pictures", joined.shape[1], joined.shape[0], alpha=True)
    picture.pixels.foreach_set(np.ascontiguousarray(joined).ravel())
    picture.filepath_raw, picture.file_format = str(target), "PNG"
    picture.save()
    bpy.data.images.remove(picture)


def _prepare(context, undo, kind=None):
    """Show the map that is chosen, or `kind`, with true colours and legend."""
    scene = context.scene
    was_shown, chosen = scene.thenar.hand.thenar.shows_pressure, scene.thenar.maps.shown
    wanted = maps.MAPS[kind or (chosen if was_shown else maps.PRESSURE)]
    if not display.shown_objects(context, wanted.attribute):
        raise Refusal(wanted.missing)
    display.show(context, wanted.kind)
    undo.callback(*((display.show, context, chosen) if was_shown else (display.hide, context)))
    if not scene.thenar.preset_before:
        undo.callback(compositor.restore_preset, scene)
    for owner, name, value in (
        (scene.render, "engine", "CYCLES"),
        (scene.render.image_settings, "file_format", "PNG"),
        (scene.render.image_settings, "color_mode", "RGB"),
        (scene.render, "use_file_extension", False),
    ):
        _set(undo, owner, name, value)
    share = min(1.0, WIDEST / scene.render.resolution_x, HIGHEST / scene.render.resolution_y)
    _set(undo, scene.render, "resolution_percentage", max(1, round(100 * share)))
    _set(undo, scene.cycles, "time_limit", LONGEST_S)
    _set(undo, scene.cycles, "samples", SAMPLES)
    _set(undo, scene.cycles, "max_bounces", 3)
    _set(undo, scene.cycles, "adaptive_threshold", 0.03)
    _set(undo, scene.cycles, "use_adaptive_sampling", True)
    compositor.apply_preset(scene)


def _render(scene, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    before = scene.render.filepath
    scene.render.filepath = str(path.resolve())
    try:
        bpy.ops.render.render(write_still=True)
    finally:
        scene.render.filepath = before


def _set(undo, owner, name, value):
    undo.callback(setattr, owner, name, getattr(owner, name))
    setattr(owner, name, value)


def _show_only(context, undo, shown):
    for obj in context.scene.objects:
        if obj.type not in {"ARMATURE", "EMPTY", "CAMERA"} and obj not in shown:
            _set(undo, obj, "hide_render", True)


def _world(obj):
    context = bpy.context
    depsgraph = context.evaluated_depsgraph_get()
    with mesh.evaluated_mesh(obj, depsgraph) as surface:
        points = mesh.positions(surface)
    matrix = np.array(obj.matrix_world)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def _palm_view(hand, points):
    """Away from the palm, and up along the fingers: by the pressed side and the long axis of the rest shape."""
    force = attributes.read(hand.data, names.FORCE_N)
    long = _long_axis(points)
    away = (_normals(hand) * force[:, None]).sum(axis=0)
    if long is None:
        return _upright(away)
    away -= long * (away @ long)
    towards = (points * force[:, None]).sum(axis=0) / max(force.sum(), 1e-12) - points.mean(axis=0)
    return _upright(away, _fingers_up(hand, long, towards))


def _long_axis(points):
    """The axis along which the points reach furthest, or None where they reach about as far across."""
    centred = points - points.mean(axis=0)
    _, sizes, axes = np.linalg.svd(centred[:: max(1, len(centred) // 4000)], full_matrices=False)
    return axes[0] if sizes[0] > 1.3 * sizes[1] else None


def _upright(away, up=None):
    """The view (away, up) as unit vectors; any upright one where they are not given."""
    away = Vector(away) if np.linalg.norm(away) > 1e-9 else Vector((0.0, -1.0, 0.0))
    if up is None:
        up = (0.0, 0.0, 1.0) if abs(away.normalized().z) < 0.9 else (0.0, 1.0, 0.0)
    up = Vector(up)
    if up.cross(away).length < 1e-6 * away.length:
        away = up.orthogonal()
    return away.normalized(), up.normalized()


def _fingers_up(hand, long, towards):
    rig = next(
        (modifier.object for modifier in hand.modifiers if modifier.type == "ARMATURE" and modifier.object), None
    )
    if rig is not None:
        bones = rig.data.bones
        roots = np.array([rig.matrix_world @ bone.head_local for bone in bones if bone.parent is None])
        tips = np.array([rig.matrix_world @ bone.tail_local for bone in bones if not bone.children])
        towards = tips.mean(axis=0) - roots.mean(axis=0)
    return long if long @ towards >= 0.0 else -long


def _normals(obj):
    data = obj.data
    out = np.empty(len(data.vertices) * 3, np.float32)
    data.vertex_normals.foreach_get("vector", out)
    linear = np.linalg.inv(np.array(obj.matrix_world)[:3, :3]).T
    return out.reshape(-1, 3) @ linear.T


def _pressed_side(objects):
    """The side with most pressure, across the product's long axis where it has one; and what is up."""
    pressure = [attributes.read(obj.data, names.PRESSURE_KPA) for obj in objects]
    normals = [_normals(obj) * values[:, None] for obj, values in zip(objects, pressure, strict=True)]
    away = np.concatenate(normals).sum(axis=0)
    long = _long_axis(np.concatenate([_world(obj) for obj in objects]))
    if long is None:
        return _upright(away)
    return _upright(away - long * (away @ long), long if long[np.abs(long).argmax()] > 0 else -long)


def _aim(context, undo, points, view):
    """An orthographic camera that frames `points`, seen from `view` = (away, up)."""
    scene, (away, up) = context.scene, view
    across = up.cross(away).normalized()
    up = away.cross(across).normalized()
    turn = np.array([across, up, away])
    seen = points @ turn.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    width, height = compositor.picture_size(scene)
    extent = max(_FILL[0] * (high[0] - low[0]), _FILL[1] * (high[1] - low[1]) * width / height)
    middle = 0.5 * (low + high)
    middle[2] = high[2] + extent
    data = bpy.data.cameras.new("Thenar Camera")
    data.type, data.ortho_scale = "ORTHO", extent * max(1.0, height / width)
    data.shift_x = -_LEGEND_SHIFT
    data.clip_start = 1e-3 * extent
    data.clip_end = 10.0 * extent + float(high[2] - low[2])
    camera = bpy.data.objects.new("Thenar Camera", data)
    camera.matrix_world = Matrix.Translation(turn.T @ middle) @ Matrix(turn.T.tolist()).to_4x4()
    scene.collection.objects.link(camera)
    _set(undo, scene, "camera", camera)
    undo.callback(bpy.data.cameras.remove, data)
    context.view_layer.update()


def _light(context, undo):
    if not any(obj.type == "LIGHT" and not obj.hide_render for obj in context.scene.objects):
        _studio(context, undo)


def _studio(context, undo):
    """A soft key from the upper left, a weaker rim, and a quiet grey world, in the camera's frame."""
    scene = context.scene
    camera = scene.camera
    turn = camera.matrix_world.to_3x3()
    for energy, angle, direction in ((3.0, 0.5, (-0.7, 0.8, 1.0)), (1.2, 1.0, (1.0, -0.2, 0.5))):
        data = bpy.data.lights.new("Thenar Light", "SUN")
        data.energy, data.angle = energy, angle
        light = bpy.data.objects.new("Thenar Light", data)
        light.matrix_world = (turn @ Vector(direction)).to_track_quat("Z", "Y").to_matrix().to_4x4()
        scene.collection.objects.link(light)
        undo.callback(bpy.data.lights.remove, data)
    world = bpy.data.worlds.new("Thenar World")
    if world.node_tree is None:
        world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.30, 0.31, 0.33, 1.0)
    undo.callback(bpy.data.worlds.remove, world)
    _set(undo, scene, "world", world)
