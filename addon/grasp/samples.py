"""The sample scenes: a hand in contact with a product, lit, framed and ready to solve; and the files that hold them."""

from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

from .. import steps
from ..grasp_fit import fitter
from ..hand import added, build, pads, poses, products
from ..hand.skinning import skin
from ..hand_bones import posing, reading, roles
from ..hand_look import studio
from ..moving_samples import rolling
from ..scene.units import mm_per_unit
from . import fitting

FILE_SUFFIX = ".blend"
RANGE_KPA = 150.0
"""Top of the color map in every sample: about the peak pressures of Xie Table 6, so that samples compare."""

EARLIER_TWIST_DEG = (-20.0, 30.0)
"""Twist of the thumb in which the grasps of Xie Table 6 were fitted; figures of this repository rest on them."""

FIRST = "held_bottle"
"""The sample of the first card: a light grasp in balance, pressed to less than half the tissue's thickness."""


@dataclass(frozen=True)
class Sample:
    """One sample: `label`, the product's `shape` and `material`, how the hand meets it, and from where it is seen.

    `stand` (3): Euler degrees that stand the finished scene up in the world; `eye`: azimuth and elevation, degrees, and
    distance, mm, of the camera from the middle of the `aim` bones' heads.
    """

    label: str
    product: str
    shape: object
    material: object
    meet: object
    stand: tuple
    eye: tuple
    lens_mm: float = 70.0
    aim: tuple = ("middle_proximal", "thumb_distal", "little_middle", "index_middle")
    extras: tuple = ()


def add_sample(context, kind):
    """Build the sample `kind` into the scene. Returns `(hand, product)`.

    Raises `KeyError` for an unknown kind, and `Refusal` if the hand cannot be made.
    """
    return steps.at_once(sample_steps(context, kind))


def sample_steps(context, kind):
    """`add_sample` as the steps of a computation: hand and fit are computed by any thread."""
    sample = SAMPLES[kind]
    made = yield build.making()
    scene = context.scene
    studio.set_units(scene)
    hand, rig = yield from build.adding(context, made)
    _add_sleeve(context, rig)
    product = studio.add_mesh(context, sample.product, sample.shape(), sample.material())
    parts = [studio.add_mesh(context, name, shape(), material()) for name, shape, material in sample.extras]
    for part in parts:
        part.parent = product
    yield from sample.meet(context, hand, rig, product)
    _stand_up(context, (rig, product), sample.stand)
    _stage(context, hand, product, sample)
    settings = scene.thenar
    settings.hand, settings.product = hand, product
    settings.range_kpa = RANGE_KPA
    return hand, product


def scene_steps(context, kind):
    """The steps of a sample in the current scene if it is empty, else in a new one that the window shows; its 3D views
    look through the sample's camera. Returns True. Ended before, they leave the file as it was."""
    with added.taken_back_unless_whole(context) as own:
        if context.scene.objects:
            own.move_to_new_scene(f"Thenar {SAMPLES[kind].label}")
        yield from own.in_turns(sample_steps(context, kind))
        _look_through_camera([context.window.screen] if context.window and own.is_shown() else [])
    return True


def _power(targets_mm, height_mm=0.0, force_n=None):
    """A power grasp of an upright product, its middle `height_mm` up its axis; with `force_n` fitted to that force."""

    def meet(context, hand, rig, product):
        rig.matrix_world = Matrix.Rotation(-np.pi / 2, 4, "Y")
        context.view_layer.update()
        wish = fitter.Wish(targets_mm, axis=(0.0, 0.0, 1.0), center=(0.0, 0.0, height_mm))
        with _earlier_twist(rig):
            job = fitting.prepare(context, hand, [product], wish, force_n)
            found = yield partial(fitting.compute, job)
            fitting.finish(context, job, found, "HAND")

    return meet


@contextmanager
def _earlier_twist(rig):
    """The thumb's twist within `EARLIER_TWIST_DEG` for as long as a fit runs."""
    limit = rig.pose.bones["thumb_metacarpal"].constraints["Joint limits"]
    own = limit.min_y, limit.max_y
    limit.min_y, limit.max_y = np.radians(EARLIER_TWIST_DEG)
    try:
        yield
    finally:
        limit.min_y, limit.max_y = own


def _kept(pose, place):
    """A grasp that was found before: angles as in `poses.POSES`, and the hand's place, mm and Euler degrees, in the
    product's space."""

    def meet(context, hand, rig, product):
        arrays, names = reading.read_free_rig(context, hand)
        joints = roles.resolve(arrays, names, reading.own_limits(rig, arrays))
        reading.write_angles(rig, arrays, joints, roles.pose_angles(arrays, joints, pose))
        shift, turn = place
        rig.matrix_world = Matrix.Translation(np.array(shift) / mm_per_unit(context.scene)) @ _euler(turn)
        context.view_layer.update()
        yield steps.PAUSE

    return meet


def _press(pose, digits, targets_mm, tilt_deg):
    """A hand in a library pose, tilted over the plate's top, let down on it and fitted there."""

    def meet(context, hand, rig, product):
        posing.apply_pose(context, hand, pose)
        rig.matrix_world = _euler(tilt_deg) @ Matrix.Rotation(np.pi, 4, "Y")
        context.view_layer.update()
        place = _let_down(fitting.read_hand(context, hand), rig, digits, targets_mm)
        reading.move_object(rig, place, mm_per_unit(context.scene))
        job = fitting.prepare(context, hand, [product], fitter.Wish(targets_mm, digits, is_placed=True))
        found = yield partial(fitting.compute, job)
        fitting.finish(context, job, found, "HAND")

    return meet


def _let_down(hand, rig, digits, targets_mm):
    """Motion (4, 4), mm, that lowers the hand on z = 0 and brings its lowest pads to the middle of the plate."""
    posed = np.array([rig.pose.bones[name].matrix for name in hand.rig.names], dtype=np.float64)
    points = skin(hand.rig, posed)
    used = [pad for pad in hand.pads if pad.kind in targets_mm and _part(pad) in digits]
    heights = [points[pad.rows, 2][pads.deepest(points[pad.rows, 2])].mean() for pad in used]
    lowest = min(height + targets_mm[pad.kind] for height, pad in zip(heights, used, strict=True))
    middle = np.mean([points[pad.rows].mean(axis=0) for pad in used], axis=0)
    place = np.eye(4)
    place[:3, 3] = (-middle[0], -middle[1], -lowest)
    return place


def _rolled(meet, bone):
    """The same on top of a ball, after which the finger of a distal bone rolls over it."""

    def meet_and_roll(context, hand, rig, product):
        product.location.z = -0.5 * max(product.dimensions)
        context.view_layer.update()
        yield from meet(context, hand, rig, product)
        rolling.roll(context, rig, product, bone)

    return meet_and_roll


def _ball(radius_mm):
    """A ball around its origin, meshed as fine as other products."""
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 40)[1:-1]
    return products.turned(radius_mm * np.stack([np.cos(angle), np.sin(angle)], axis=1))


def _part(pad):
    return "palm" if pad.kind == "palm" else pad.role.partition("_")[0]


def _euler(degrees):
    turn = Matrix.Identity(4)
    for angle, axis in zip(np.radians(degrees), "XYZ", strict=True):
        turn = Matrix.Rotation(float(angle), 4, axis) @ turn
    return turn


def _add_sleeve(context, rig):
    sleeve = studio.add_mesh(context, "Sleeve", products.sleeve(), studio.fabric("Sleeve", (0.045, 0.065, 0.11, 1.0)))
    sleeve.parent = rig
    return sleeve


def _stand_up(context, objects, degrees):
    turn = _euler(degrees)
    for obj in objects:
        obj.matrix_world = turn @ obj.matrix_world
    context.view_layer.update()


def _stage(context, hand, product, sample):
    target, floor = _contact_point(context, hand, product, sample.aim)
    azimuth, elevation = np.radians(sample.eye[:2])
    away = np.array([np.sin(azimuth) * np.cos(elevation), -np.cos(azimuth) * np.cos(elevation), np.sin(elevation)])
    camera = studio.frame(context, target, target + sample.eye[2] * away, sample.lens_mm)
    studio.light(context, camera, target)
    studio.backdrop(context, camera, target, floor)
    studio.render_settings(context.scene)


def _contact_point(context, hand, product, aim):
    """Middle of the `aim` bones' heads, world mm, and the floor's height below everything."""
    scale = mm_per_unit(context.scene)
    lowest = []
    for obj in (hand, product):
        corners = np.array([obj.matrix_world @ Vector(obj.bound_box[k]) for k in range(8)]) * scale
        lowest.append(corners[:, 2].min())
    rig = hand.parent
    middle = np.mean([np.array(rig.matrix_world @ rig.pose.bones[name].head) for name in aim], axis=0) * scale
    return middle, min(lowest) - 40.0


def _satin(name, color, roughness=0.38):
    return lambda: studio.plain(name, color, roughness)


_GRASP = {"stand": (0, 6, 0), "eye": (-74.0, 13.0, 430.0)}
_TEAL = (0.055, 0.155, 0.19, 1.0)


def _aside(shape, across_mm):
    """A shape moved along x: the thumb of a flat hand hangs over the plate's edge instead of passing through it."""
    vertices, faces = shape
    return vertices + [across_mm, 0.0, 0.0], faces


def _cylinder(diameter_mm, force_n, eye):
    """A cylinder of the paper, grasped with the total force measured there (Xie Table 6), as its authors did."""
    return Sample(
        f"{diameter_mm} mm cylinder",
        f"Cylinder {diameter_mm} mm",
        lambda: products.cylinder(diameter_mm),
        _satin("Cylinder", _TEAL),
        _power(pads.FIRM_MM, force_n=force_n),
        (0, 6, 0),
        eye,
    )


SAMPLES = {
    "fingertip_on_plate": Sample(
        "Fingertip on plate",
        "Plate",
        lambda: products.plate(90.0, 70.0, 6.0, 1.2),
        lambda: studio.clear("Clear Plate", (0.93, 0.97, 0.98, 1.0)),
        _press("fingertip_press", ("index",), {"distal": 2.5}, (12, 0, 0)),
        (0, 0, 0),
        (-58.0, 9.0, 215.0),
        aim=("index_distal", "index_distal", "index_middle"),
    ),
    "palm_on_plate": Sample(
        "Palm on plate",
        "Plate",
        lambda: _aside(products.plate(170.0, 330.0, 10.0), 44.0),
        lambda: studio.clear("Clear Plate", (0.93, 0.97, 0.98, 1.0)),
        _press(
            "palm_press",
            ("palm", "index", "middle", "ring", "little"),
            {"palm": 3.5, "proximal": 1.5, "middle": 1.2, "distal": 1.5},
            (6, 0, 0),
        ),
        (90, 0, 0),
        (158.0, 4.0, 520.0),
    ),
    "hand_on_glass": Sample(
        "Hand on glass",
        "Glass Plate",
        lambda: _aside(products.plate(225.0, 250.0, 8.0, 2.2), -12.0),
        lambda: studio.clear("Clear Plate", (0.93, 0.97, 0.98, 1.0)),
        _press(
            "palm_press",
            ("palm", "thumb", "index", "middle", "ring", "little"),
            {"palm": 2.0, "proximal": 1.2, "middle": 1.2, "distal": 2.0},
            (0, 0, 0),
        ),
        (90, 0, 0),
        (176.0, 3.0, 560.0),
    ),
    "finger_on_ball": Sample(
        "Finger rolls on ball",
        "Ball",
        lambda: _ball(20.0),
        _satin("Ball", (0.62, 0.13, 0.09, 1.0), 0.3),
        _rolled(_press("fingertip_press", ("index",), {"distal": 2.8}, (12, 0, 0)), "index_distal"),
        (0, 0, 0),
        (-58.0, 9.0, 235.0),
        aim=("index_distal", "index_distal", "index_middle"),
    ),
    "cylinder_48": _cylinder(48, 337.0, (-74.0, 13.0, 430.0)),
    "cylinder_60": _cylinder(60, 260.0, (-80.0, 13.0, 440.0)),
    "cylinder_100": _cylinder(100, 122.0, (112.0, 16.0, 590.0)),
    "handlebar": Sample(
        "Handlebar",
        "Grip",
        products.grip,
        _satin("Rubber Grip", (0.025, 0.025, 0.028, 1.0), 0.62),
        _power(pads.LIGHT_MM),
        (-62, 0, 0),
        (-70.0, 12.0, 430.0),
        extras=(("Bar", products.bar, lambda: studio.plain("Steel", (0.6, 0.6, 0.6, 1.0), 0.25, Metallic=1.0)),),
    ),
    "bottle": Sample(
        "Bottle",
        "Bottle",
        products.bottle,
        _satin("Bottle", (0.78, 0.78, 0.74, 1.0), 0.3),
        _power(pads.LIGHT_MM, -20.0),
        **_GRASP,
    ),
    FIRST: Sample(
        "Held bottle",
        "Bottle",
        products.bottle,
        _satin("Bottle", (0.78, 0.78, 0.74, 1.0), 0.3),
        _kept(poses.HELD_BOTTLE, poses.HELD_BOTTLE_AT),
        **_GRASP,
    ),
}


def make_samples(out_dir):
    """Write every sample as a compressed .blend from an empty file; returns the paths."""
    out = Path(out_dir)
    out.mkdir(parents=True, exist_ok=True)
    paths = []
    for kind in SAMPLES:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        add_sample(bpy.context, kind)
        _look_through_camera(bpy.data.screens)
        path = out / f"{kind}{FILE_SUFFIX}"
        bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)
        paths.append(path)
    return paths


def _look_through_camera(screens):
    """Show in every 3D view what the camera frames: from the default view the hand is a speck behind the backdrop."""
    for screen in screens:
        for area in screen.areas:
            if area.type == "VIEW_3D":
                area.spaces.active.region_3d.view_perspective = "CAMERA"
