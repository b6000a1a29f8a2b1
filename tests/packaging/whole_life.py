"""Run inside Blender: install, enable, open, solve, Live, bake, render, export, save, reload, disable, uninstall.

Arguments: ZIP SAMPLES OUT. What each stage saw goes to OUT/life.json; the first stage that fails ends the life, and its
traceback is printed. Files, pictures and arrays that the stages leave in OUT are judged by `test_whole_life.py`.
"""

import importlib.machinery
import json
import os
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np

MODULE = "bl_ext.user_default.thenar"
SAMPLE = "fingertip_on_plate.blend"
ASKED_N = 3.0
"""Force that the solve of the sample has to reach, N."""
NEARER_MM = 0.05
"""How far the product is moved into the skin under Live, and from the first to the last baked frame, mm."""
PIXELS = 160, 96
TRUE_COLORS = {"view_transform": "Standard", "look": "None", "exposure": 0.0, "gamma": 1.0}

zip_path, samples, out = (Path(argument).resolve() for argument in sys.argv[1:4])


def install():
    import addon_utils  # on the path only once bpy is loaded

    addon_utils.enable("bl_pkg")
    sys.meta_path.insert(0, FromTheZip)
    done = bpy.ops.extensions.package_install_files(filepath=str(zip_path), repo="user_default", enable_on_install=True)

    return {
        "blender": bpy.app.version_string,
        "done": list(done),
        "enabled": addon_utils.check(MODULE)[1],
        "native": sys.modules["thenar"].__file__,
        "classes": classes(),
    }


class FromTheZip(importlib.machinery.PathFinder):
    """Finds the native module where Blender unpacks wheels: an environment for tests has a copy of its own."""

    @classmethod
    def find_spec(cls, name, path=None, target=None):
        if name != "thenar":
            return None
        found = Path(bpy.utils.user_resource("EXTENSIONS")).glob(".local/**/site-packages")
        return super().find_spec(name, [str(each) for each in found], target)


def open_samples():
    """Hand, product and number of vertices of every sample; what Blender prints of a file goes to OUT/open.txt."""
    seen = {}
    with printed(out / "open.txt"):
        for path in sorted(samples.glob("*.blend")):
            bpy.ops.wm.open_mainfile(filepath=str(path))
            chosen = bpy.context.scene.thenar
            seen[path.name] = [chosen.hand.name, chosen.product.name, len(chosen.hand.data.vertices)]
    return seen


def solve():
    bpy.ops.wm.open_mainfile(filepath=str(samples / SAMPLE))
    settings = bpy.context.scene.thenar
    first = pressed()
    settings.use_force, settings.force_n = True, ASKED_N
    asked = pressed()
    settings.use_force = False
    return {"as_posed": first, "asked": asked}


def pressed():
    done = bpy.ops.thenar.solve()
    result = bpy.context.scene.thenar.result
    return {"done": list(done), "force_n": result.force_n, "grade": result.grade, "vertices": pressing().size}


def pressing():
    """Numbers of the vertices that carry pressure."""
    return np.flatnonzero(pressure_kpa() > 0.0)


def pressure_kpa():
    mesh = bpy.context.scene.thenar.hand.data
    values = np.empty(len(mesh.vertices), np.float32)
    mesh.attributes["pressure_kpa"].data.foreach_get("value", values)
    return values


def maps():
    shown = {}
    for kind in ("DEPTH", "THICKNESS", "PRESSURE"):
        shown[kind] = list(bpy.ops.thenar.show_map(kind=kind))
    return shown


def live():
    """Forces as posed, with the product nearer, and back again. Background has no timers, so Live is asked to look."""
    watch = sys.modules[f"{MODULE}.live.watch"]
    settings = bpy.context.scene.thenar
    pressed()
    settings.live = True
    forces = [settings.result.force_n]
    for step in (1.0, -1.0):
        approach(step * NEARER_MM)
        bpy.context.view_layer.update()
        watch.follow_now(bpy.context)
        forces.append(settings.result.force_n)
    settings.live = False
    return forces


def approach(distance_mm):
    """Move the product against the mean outward normal of the skin that it presses."""
    hand, product = bpy.context.scene.thenar.hand, bpy.context.scene.thenar.product
    mesh = hand.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    normals = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertex_normals.foreach_get("vector", normals)
    toward = np.array(hand.matrix_world.to_3x3()) @ normals.reshape(-1, 3)[pressing()].sum(axis=0)
    per_mm = 1e-3 / bpy.context.scene.unit_settings.scale_length
    product.location -= type(product.location)(toward / np.linalg.norm(toward) * distance_mm * per_mm)


def bake():
    scene = bpy.context.scene
    scene.thenar.product.keyframe_insert("location", frame=1)
    approach(NEARER_MM)
    scene.thenar.product.keyframe_insert("location", frame=3)
    scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(filepath=str(out / "baked.blend"))
    done = bpy.ops.thenar.bake(frame_start=1, frame_end=3)
    bpy.ops.thenar.export_bake(filepath=str(out / "baked.csv"))
    return {"done": list(done), "played": played()}


def played():
    """Force by frame as the pressures of the skin say that play: mean pressure, kPa."""
    means = []
    for frame in (1, 2, 3):
        bpy.context.scene.frame_set(frame)
        means.append(float(pressure_kpa().mean()))
    bpy.context.scene.frame_set(1)
    return means


def save_and_reload():
    before = pressure_kpa()
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(out / "baked.blend"))
    settings = bpy.context.scene.thenar
    return {
        "same": bool(np.array_equal(before, pressure_kpa())) and bool(before.any()),
        "hand": settings.hand.name,
        "played": played(),
    }


def export():
    pressed()
    for suffix in ("csv", "npz", "gltf", "usda"):
        bpy.ops.thenar.export(filepath=str(out / f"press.{suffix}"))
    return {"force_n": bpy.context.scene.thenar.result.force_n, "vertices": len(pressure_kpa())}


def render():
    """Two pictures, with the preset's legend and without it, in the preset's colors, as OUT/pictures.npz."""
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = *PIXELS, 100
    scene.render.dither_intensity = 0.0
    for name, value in TRUE_COLORS.items():
        setattr(scene.view_settings, name, value)
    pictures = {}
    for name, restore in (("plain", True), ("with_legend", False), ("after", True)):
        bpy.ops.thenar.render_preset(restore=restore)
        scene.render.filepath = str(out / f"{name}.png")
        bpy.ops.render.render(write_still=True)
        pictures[name] = pixels(scene.render.filepath)
    np.savez(out / "pictures.npz", **pictures)
    return sorted(pictures)


def effects():
    """Legends in the trees of two effects of the user and elsewhere, while the preset goes on, on and off (5.3)."""
    scene = bpy.context.scene
    if "compositor_effects" not in scene.bl_rna.properties:
        return None
    row = scene.compositor_effects
    own = [row.new(name) for name in ("first", "second")]
    for effect in own:
        effect.node_group = bpy.data.node_groups.new(effect.name, "CompositorNodeTree")
    counts, groups = [], len(bpy.data.node_groups)
    for active, restore in ((1, False), (0, False), (0, True)):
        row.active = own[active]
        bpy.ops.thenar.render_preset(restore=restore)
        trees = [effect.node_group for effect in row]
        counts.append([sum("Thenar Legend Over" in tree.nodes for tree in trees), list(row).index(row.active)])
    own_trees = [len(effect.node_group.nodes) for effect in own]
    return {"legends_and_active": counts, "nodes": own_trees, "groups_left": len(bpy.data.node_groups) - groups}


def pixels(path):
    image = bpy.data.images.load(path)
    values = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(values)
    size = image.size[1], image.size[0], 4
    bpy.data.images.remove(image)
    return values.reshape(size)


def make_hand():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    import addon_utils

    addon_utils.enable(MODULE)  # factory settings know of no add-on
    done = bpy.ops.thenar.make_hand()
    return {"done": list(done), "vertices": len(bpy.context.scene.thenar.hand.data.vertices)}


def disable():
    import addon_utils

    addon_utils.disable(MODULE)
    return {"classes": classes(), "scene": hasattr(bpy.context.scene, "thenar"), "handlers": handlers()}


def uninstall():
    extensions = Path(bpy.utils.user_resource("EXTENSIONS"))
    there = installed(extensions)
    index = [repo.module for repo in bpy.context.preferences.extensions.repos].index("user_default")
    bpy.ops.extensions.package_uninstall(repo_index=index, pkg_id="thenar")
    return {"there": there, "left": installed(extensions)}


def installed(extensions):
    return sorted(path.name for path in extensions.rglob("thenar*") if ".cache" not in path.parts)


def classes():
    bases = (bpy.types.Operator, bpy.types.Panel, bpy.types.PropertyGroup, bpy.types.UIList, bpy.types.AddonPreferences)
    found = [each for base in bases for each in base.__subclasses__() if each.is_registered]
    return sorted(each.__name__ for each in found if MODULE in each.__module__)


def handlers():
    """Functions of the add-on that Blender would still call."""
    lists = [getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)]
    held = [function for each in lists if isinstance(each, list) for function in each]
    return [function.__name__ for function in held if MODULE in function.__module__]


class printed:
    """Sends what this process prints, Blender's own lines too, into a file."""

    def __init__(self, path):
        self.path = path

    def __enter__(self):
        sys.stdout.flush()
        sys.stderr.flush()
        self.kept = [os.dup(1), os.dup(2)]
        with self.path.open("w") as file:
            os.dup2(file.fileno(), 1)
            os.dup2(file.fileno(), 2)

    def __exit__(self, *_):
        sys.stdout.flush()
        sys.stderr.flush()
        for number, kept in enumerate(self.kept, 1):
            os.dup2(kept, number)
            os.close(kept)


STAGES = (install, open_samples, solve, maps, live, export, render, effects) + (
    bake,
    save_and_reload,
    make_hand,
    disable,
    uninstall,
)


def run():
    """Every stage in order; returns what they saw and, if one failed, its name under `failed`."""
    seen = {}
    for stage in STAGES:
        try:
            seen[stage.__name__] = stage()
        except Exception:
            traceback.print_exc()
            return seen | {"failed": stage.__name__}
    return seen


(out / "life.json").write_text(json.dumps(run()))
