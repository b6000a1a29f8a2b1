"""Grasps of a cylinder by the reference solve, in postures and tissues: the truths from which grasp studies are drawn.

`PYTHONPATH=tests target/venv/bin/python tests/trial/grasps/solved.py [cylinder_60 ...]` solves what lacks (about a
minute each) and writes `NAME.npz` beside this file. The reference solve is a solid between skin and bone; it shares no
contact with the layer model that the diagnosis presses.
"""

import sys
import time
from contextlib import ExitStack
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parent
SAMPLES = FOLDER.parents[2] / "blend-samples"
STEP_MM = 0.5
"""Travel of a fingertip, and of the palm, from one posture to the next."""
POSTURES = (-2, -1, 0, 1)
DIGITS = ("thumb", "index", "middle", "ring", "little")
TISSUES = {
    "as_given": (1.0, 1.0),
    "softer": (0.6, 1.0),
    "stiffer": (1.6, 1.0),
    "thinner": (1.0, 0.8),
    "much_softer": (0.33, 1.0),
}
"""Factors of shear modulus and of the way to the bone in the target region of each part of the hand."""
TARGETS = {
    "thumb": "thumb_distal_pad",
    "index": "index_distal_pad",
    "middle": "middle_proximal_pad",
    "ring": "ring_proximal_pad",
    "little": "little_distal_pad",
    "palm": "distal_palm_ulnar",
}
_LAYERS = 2
_SMOOTHINGS = 8


def parts(names):
    """Part of the hand, a digit or palm, of each region name."""
    return [next((digit for digit in DIGITS if name.startswith(digit)), "palm") for name in names]


def scene(sample):
    """The tissue of a sample's hand as *Certify* takes it, mm about the hand's center."""
    import bpy
    import thenar_blender
    from thenar_blender.reference import certify

    if not hasattr(bpy.types.Scene, "thenar"):
        thenar_blender.register()
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / f"{sample}.blend"))
    bpy.ops.thenar.solve()
    with ExitStack() as taken:
        return certify.read(bpy.context, taken)


def weights(tissue, names):
    """Share (n, parts) of each vertex in each part, smoothed along the skin."""
    regions = np.asarray(tissue.job.reading.hand.regions)[tissue.first]
    order = [*DIGITS, "palm"]
    part = np.array([order.index(each) for each in parts(names)] + [-1])[regions]
    # Skin without a region takes the part of the nearest vertex that has one.
    known = np.flatnonzero(part >= 0)
    bare = np.flatnonzero(part < 0)
    for piece in np.array_split(bare, max(1, len(bare) // 500)):
        away = ((tissue.posed_mm[piece, None] - tissue.posed_mm[None, known]) ** 2).sum(axis=2)
        part[piece] = part[known[away.argmin(axis=1)]]
    share = np.eye(len(order))[part]
    ends = np.concatenate([tissue.triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    ends = np.concatenate([ends, ends[:, ::-1]])
    count = np.maximum(np.bincount(ends[:, 0], minlength=len(share)), 1)[:, None]
    for _ in range(_SMOOTHINGS):
        sums = np.zeros_like(share)
        np.add.at(sums, ends[:, 0], share[ends[:, 1]])
        share = 0.5 * share + 0.5 * sums / count
    return share, regions


def moves(tissue, share, regions):
    """Displacement (n, 3) of the skin for one step of every part: digits turn about their base, the palm shifts."""
    import thenar

    product = thenar.Product(tissue.product_mm, tissue.job.reading.product.triangles)
    found = product.gap_mm(tissue.posed_mm, cut_off_mm=60.0)
    way = np.asarray(found["closest_mm"]) - tissue.posed_mm
    inside = np.asarray(found["gap_mm"])[:, None] < 0.0
    way = np.where(inside, -way, way)  # toward the product's inside
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9)
    step = np.zeros_like(tissue.posed_mm)
    for column, part in enumerate([*DIGITS, "palm"]):
        own = (share[:, column] > 0.9) & (regions >= 0) & np.isfinite(way).all(axis=1)
        points = tissue.posed_mm[own]
        if part == "palm":
            press = way[own & (np.asarray(found["gap_mm"]) < 0.0)].mean(axis=0)
            move = STEP_MM * press / np.linalg.norm(press) * np.ones((len(step), 1))
        else:
            # The base is the end of the digit toward the palm; the axis of its turn is that of the cylinder.
            palm = tissue.posed_mm[share[:, -1] > 0.9].mean(axis=0)
            base = points[np.linalg.norm(points - palm, axis=1).argsort()[:20]].mean(axis=0)
            axis = cylinder_axis(tissue.product_mm)
            arm = tissue.posed_mm - base
            turn = np.cross(axis, arm)
            tip = points[np.linalg.norm(points - base, axis=1).argsort()[-40:]]
            turn_tip = np.cross(axis, tip - base)
            into = way[own][np.linalg.norm(points - base, axis=1).argsort()[-40:]]
            reach = np.einsum("ij,ij->i", turn_tip, into).mean()
            move = STEP_MM * turn / reach
        step += share[:, [column]] * move
    return step


def cylinder_axis(points):
    """Unit vector along the longest extent of a cylinder's vertices."""
    around = points - points.mean(axis=0)
    return np.linalg.eigh(around.T @ around)[1][:, -1]


def solve(sample):
    """Solves every posture and tissue of a sample that its file lacks, and writes the file after each."""
    import thenar

    path = FOLDER / f"{sample}.npz"
    tissue = scene(sample)
    names = list(tissue.job.region_names)
    share, regions = weights(tissue, names)
    step = moves(tissue, share, regions)
    target = np.isin(regions, [names.index(each) for each in TARGETS.values()])
    touchable = np.flatnonzero(_near(tissue, step))
    kept = dict(np.load(path)) if path.exists() else {}
    kept |= {
        "posed_mm": tissue.posed_mm.astype(np.float32),
        "triangles": tissue.triangles.astype(np.int16 if len(tissue.posed_mm) < 32768 else np.int32),
        "regions": regions.astype(np.int8),
        "names": np.array(names),
        "share": share.astype(np.float16),
        "step_mm": step.astype(np.float32),
        "product_mm": tissue.product_mm.astype(np.float32),
        "product_triangles": np.asarray(tissue.job.reading.product.triangles).astype(np.int16),
        "touchable": touchable.astype(np.int16),
    }
    for kind, (modulus, way) in TISSUES.items():
        for posture in POSTURES:
            key = f"{kind}_{posture}"
            if key in kept:
                continue
            posed = tissue.posed_mm + posture * step
            bone = tissue.bone_mm + posture * step
            bone = np.where(target[:, None], posed + way * (bone - posed), bone)
            started = time.time()
            found = thenar.reference_press(
                posed,
                tissue.triangles,
                bone,
                np.where(target, modulus, 1.0) * tissue.shear_modulus_mpa,
                tissue.product_mm,
                tissue.job.reading.product.triangles,
                held=tissue.held.tolist(),
                stiffening=tissue.stiffening,
                can_touch=tissue.can_touch.tolist(),
                layers=_LAYERS,
            )
            force = np.linalg.norm(np.asarray(found.force_n), axis=1)
            kept[key] = force[touchable].astype(np.float16)
            kept[f"{key}_moved"] = (np.asarray(found.displacement_mm)[touchable] + posture * step[touchable]).astype(
                np.float16
            )
            by_part = [
                round(float(force[np.array(parts(names) + ["none"])[regions] == part].sum()), 1) for part in TARGETS
            ]
            print(
                f"{key}: {force.sum():.1f} N by part {by_part}, {1 - force[touchable].sum() / force.sum():.3f} left, "
                f"{time.time() - started:.0f} s",
                flush=True,
            )
            np.savez_compressed(path, **kept)


def _near(tissue, step):
    """(n) vertices within 3 mm of the product in the deepest posture."""
    import thenar

    product = thenar.Product(tissue.product_mm, tissue.job.reading.product.triangles)
    gap = np.asarray(product.gap_mm(tissue.posed_mm + max(POSTURES) * step, cut_off_mm=8.0)["gap_mm"])
    return tissue.can_touch & (gap < 2.0)


if __name__ == "__main__":
    for each in sys.argv[1:] or ["cylinder_60"]:
        solve(each)
