"""One grasp through the add-on's own buttons, Make Hand, Grasp, Solve, in a fresh file, and what the viewer then sees.

Depths and displacements come from the evaluated meshes, measured by `measuring` and not by the library.
"""

import json
import time
from math import radians

import bpy
import numpy as np
import thenar_blender
import thenar_blender.workflow
from handles import anatomy, measuring
from mathutils import Euler
from scipy.spatial import cKDTree

SPARE_MM = 3.0
LEFT_MM = 0.05
PEAK_KPA = 600.0
STARTS = {
    "made": (0, 0, 0),
    "turned": (0, 0, 90),
    "over": (180, 0, 0),
    "tilted": (30, 40, 20),
    "leaned": (-25, 10, 140),
    "lying": (90, 0, 45),
}
"""Turns of the product before the grasp, degrees about x, y, z."""


def grasp(mesh, percentile, start, dump=None):
    """Grasps the mesh (vertices mm, triangles), turned by the start. Returns a row: refused at a step, or numbers.

    `dump`: a path for the arrays that Solve hands to the module and for the skin that it shows, as .npz.
    """
    bpy.ops.wm.read_homefile(use_empty=True)
    product = _add(mesh, STARTS[start])
    settings, row = bpy.context.scene.thenar, {}
    for step in ("make", "fit", "solve"):
        started, cpu = time.monotonic(), time.process_time()
        try:
            if step == "make":
                bpy.ops.thenar.make_hand(percentile=percentile)
                settings.product = product
            elif step == "fit":
                bpy.ops.thenar.fit_grasp()
                before, triangles = seen(settings.hand)
                row |= anatomy.of(settings.hand, before, triangles)
                if dump:
                    save(dump)
            else:
                bpy.ops.thenar.solve()
        except RuntimeError as error:
            return row | {"refused": step, "text": str(error).strip().splitlines()[0][:300]}
        row[f"{step}_s"] = round(time.monotonic() - started, 2)
        row[f"{step}_cpu_s"] = round(time.process_time() - cpu, 2)
    if dump:
        keep_shown(dump, settings.hand, product)
    return row | measured(settings.hand, before, product) | claimed(settings.result)


def save(path):
    """What Solve would press now, as arrays: hand at rest, materials, `posed`, `product_vertices`, `_triangles`."""
    workflow = thenar_blender.workflow
    job = workflow.read_job(bpy.context, *workflow.check(bpy.context))
    hand, product = job.reading.hand, job.reading.product
    np.savez_compressed(
        path,
        vertices=hand.rest_mm,
        triangles=hand.triangles,
        regions=hand.regions,
        materials=json.dumps([dict(numbers) for numbers in job.materials]),
        region_names=json.dumps(list(job.region_names)),
        posed=hand.posed_mm,
        product_vertices=product.vertices_mm,
        product_triangles=product.triangles,
    )


def keep_shown(path, hand, product):
    """Adds what is drawn after Solve to the arrays of `save`: `shown` (n, 3), `shown_product` (m, 3) in the world, mm,
    and `shown_product_triangles`."""
    with np.load(path) as kept:
        arrays = dict(kept)
    arrays["shown"], _ = seen(hand)
    arrays["shown_product"], arrays["shown_product_triangles"] = seen(product)
    np.savez_compressed(path, **arrays)


def register():
    """The add-on, once a process."""
    thenar_blender.register()


def seen(obj):
    """What is drawn of an object: vertices (n, 3) in the world, mm, and triangles (m, 3), all modifiers applied."""
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    mesh.calc_loop_triangles()
    triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    world = np.array(evaluated.matrix_world, dtype=float)
    evaluated.to_mesh_clear()
    points = points.reshape(-1, 3).astype(float) @ world[:3, :3].T + world[:3, 3]
    return points * 1000.0 * bpy.context.scene.unit_settings.scale_length, triangles.reshape(-1, 3)


def measured(hand, before, product):
    """Numbers of the shown surfaces: how far skin moved, how deep it lay before and lies now."""
    (after, triangles), (vertices, faces) = seen(hand), seen(product)
    return compared(Shown(before, after, triangles, is_skin(hand)), vertices, faces)


class Shown:
    """A hand as it was drawn before and after (n, 3), its triangles, and which vertices are skin."""

    def __init__(self, before, after, triangles, skin):
        self.before, self.after, self.triangles, self.skin = before, after, triangles, skin


def compared(shown, vertices, faces):
    """Displacement against overlap, for all skin and for each patch that moved; what is left inside."""
    moved = np.linalg.norm(shown.after - shown.before, axis=1)
    depth = np.zeros(len(moved))
    depth[shown.skin] = measuring.depths(shown.before[shown.skin], vertices, faces)
    left = measuring.depths(shown.after[shown.skin], vertices, faces).max(initial=0.0)
    patches = patches_of(shown.triangles, (moved > 0.3) | (depth > 0.0))
    plain = float(depth.max())
    if any(moved[patch].max() > depth[patch].max() + SPARE_MM for patch in patches):
        depth = np.maximum(depth, covered(shown, vertices, faces))
    beyond = [moved[patch].max() - depth[patch].max() for patch in patches]
    return {
        "plain_mm": plain,
        "moved_mm": float(moved.max()),
        "at": int(moved.argmax()),
        "deepest_mm": float(depth.max()),
        "patches": len(patches),
        "beyond_mm": float(max(beyond, default=0.0)),
        "left_mm": float(left),
    }


def covered(shown, vertices, faces):
    """How deep the product lay under each vertex's skin before (n,): what came through a thin wall is not in it."""
    samples = measuring.sampled(vertices, faces, 2.5, (shown.before.min(axis=0), shown.before.max(axis=0)))
    under = measuring.sunk(samples, shown.before, shown.triangles, shown.skin)
    deep, out = np.flatnonzero(under > 0.0), np.zeros(len(shown.before))
    if len(deep):
        np.maximum.at(out, cKDTree(shown.before).query(samples[deep])[1], under[deep])
    return out


def patches_of(triangles, chosen):
    """Vertices of each connected piece of the triangles whose corners are all chosen."""
    whole = triangles[chosen[triangles].all(axis=1)]
    if len(whole) == 0:
        return []
    label = np.arange(len(chosen))
    while True:
        lowest, after = label[whole].min(axis=1), label.copy()
        for k in range(3):
            np.minimum.at(after, whole[:, k], lowest)
        after = after[after]
        if np.array_equal(after, label):
            break
        label = after
    used = np.unique(whole)
    return [used[label[used] == name] for name in np.unique(label[used])]


def is_skin(hand):
    """Vertices in a group that the hand's materials name (n,) bool."""
    listed = {hand.vertex_groups[material.name].index for material in hand.thenar.materials}
    return np.array([any(group.group in listed for group in vertex.groups) for vertex in hand.data.vertices])


def claimed(result):
    """What the add-on says of its result."""
    return {
        "force_n": result.force_n,
        "net_n": float(np.linalg.norm(result.force_vector_n)),
        "area_mm2": result.area_mm2,
        "peak_kpa": result.peak_kpa,
        "patch_peak_kpa": result.patch_peak_kpa,
        "claimed_left_mm": result.penetration_mm,
        "grade": str(getattr(result, "grade", "")),
        "valid": bool(result.is_valid),
        "warnings": [text.name for text in result.warnings],
    }


def faults(row):
    """What is wrong with a row: empty if it is sound or refused."""
    if "died" in row:
        return ["died"]
    if is_refused(row):
        return []
    wrong = []
    if not row["moved_mm"] <= row["deepest_mm"] + SPARE_MM:
        wrong.append("spike")
    if not row["beyond_mm"] <= SPARE_MM:
        wrong.append("patch")
    if not row["left_mm"] <= LEFT_MM:
        wrong.append("inside")
    if not row["peak_kpa"] <= PEAK_KPA:
        wrong.append("peak")
    return wrong


def is_refused(row):
    """Whether there is no result, or one that is marked as none."""
    return "refused" in row or row.get("grade", "").replace("_", " ").lower() == "do not use"


def _add(mesh, turn):
    vertices, triangles = mesh
    data = bpy.data.meshes.new("Handle")
    unit = 0.001 / bpy.context.scene.unit_settings.scale_length
    data.from_pydata((np.asarray(vertices) * unit).tolist(), [], np.asarray(triangles).tolist())
    data.update()
    product = bpy.data.objects.new("Handle", data)
    bpy.context.collection.objects.link(product)
    product.rotation_euler = Euler([radians(angle) for angle in turn])
    bpy.context.view_layer.update()
    return product
