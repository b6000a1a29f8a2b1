"""Grasp studies drawn from the reference solve's grasps: postures that drift, and one concealed effect.

What changes posture is a turn of each digit about its base, what relaxes has two time constants, and noise is a
sensor's own: none of it is drawn as the diagnosis assumes it. `RIGHT` was written before any study was diagnosed.
"""

import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from trial.grasps import mat, solved

RIGHT = {
    "null": [],
    "loosening": [],
    "tightening": [],
    "relaxation": ["relaxation"],
    "relaxation_without_trace": ["relaxation", "drift"],
    "softening": ["cycle_softening"],
    "softer": ["region_stiffness"],
    "much_softer": ["region_stiffness"],
    "stiffer": ["region_stiffness"],
    "thinner": ["bone"],
    "gain": ["gain"],
    "part": ["gain"],
    "dead": ["dead_cells"],
    "ceiling": ["saturation"],
    "floor": ["threshold"],
    "creep": ["drift"],
}
"""What must be named. Of `relaxation_without_trace` both, as what cannot be told apart."""
REGIONAL = ("softer", "much_softer", "stiffer", "thinner")
"""Kinds that are right only with their region; stiffness and bone may be said to be alike, not each for the other."""
GIVEN = -0.5
"""Posture of the study's hand, in steps of `solved.STEP_MM`."""
HOLD_S = 30.0
PARTS = (*solved.DIGITS, "palm")


@dataclass
class Case:
    """A study to be written: `kind`, seed, the sample grasped, holds, frames a second, the truth once it is drawn."""

    kind: str
    seed: int
    sample: str = "cylinder_60"
    holds: int = 3
    rate_hz: float = 2.0
    truth: dict = field(default_factory=dict)


class Grasp:
    """The solved grasps of a sample, interpolated over postures."""

    def __init__(self, sample):
        data = np.load(solved.FOLDER / f"{sample}.npz")
        self.names = [str(name) for name in data["names"]]
        self.posed, self.step = data["posed_mm"].astype(float), data["step_mm"].astype(float)
        self.triangles, self.regions = data["triangles"].astype(int), data["regions"].astype(int)
        self.product, self.faces = data["product_mm"].astype(float), data["product_triangles"].astype(int) & 0xFFFF
        self.touched = data["touchable"].astype(int) & 0xFFFF
        self.part = data["share"].astype(float)[self.touched].argmax(axis=1)
        self.force = {
            kind: np.array([data[f"{kind}_{p}"] for p in solved.POSTURES], float)
            for kind in solved.TISSUES
            if f"{kind}_{solved.POSTURES[-1]}" in data
        }
        self.moved = {
            kind: np.array([data[f"{kind}_{p}_moved"] for p in solved.POSTURES], float)
            for kind in solved.TISSUES
            if f"{kind}_{solved.POSTURES[-1]}" in data
        }
        corners = self.posed[self.triangles]
        area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        self.area = np.bincount(self.triangles.ravel(), np.repeat(area / 3, 3), minlength=len(self.posed))[self.touched]

    def at(self, posture, kinds):
        """Places (n, 3) and forces (n) at a posture (6) by part, with the tissue `kinds` (6) of each part."""
        grid = np.array(solved.POSTURES, float)
        at = np.clip(posture, grid[0], grid[-1])
        low = np.clip(np.searchsorted(grid, at, "right") - 1, 0, len(grid) - 2)
        share = (at - grid[low]) / (grid[low + 1] - grid[low])
        force, moved = np.zeros(len(self.touched)), np.zeros((len(self.touched), 3))
        for part, kind in enumerate(kinds):
            own = self.part == part
            for k, weight in ((low[part], 1 - share[part]), (low[part] + 1, share[part])):
                force[own] += weight * self.force[kind][k][own]
                moved[own] += weight * self.moved[kind][k][own]
        return self.posed[self.touched] + moved, force

    def cropped(self, reach_mm=9.0):
        """Vertices (n, 3) as the study gives them, triangles and regions of the skin within reach of what can touch."""
        given = self.posed + GIVEN * self.step
        near = np.zeros(len(given), bool)
        near[self.touched] = True
        edges = given[self.triangles] - given[np.roll(self.triangles, 1, axis=1)]
        rings = round(reach_mm / np.median(np.linalg.norm(edges, axis=2)))
        for _ in range(rings):
            near[self.triangles[near[self.triangles].any(axis=1)]] = True
        kept = self.triangles[near[self.triangles].all(axis=1)]
        used = np.unique(kept)
        number = np.full(len(given), -1)
        number[used] = np.arange(len(used))
        return given[used], number[kept], self.regions[used]


def draw(case, grasp, layout):
    """Frames and force traces of every hold of a case; fills `case.truth`. Returns a list of (time, frames, trace)."""
    rng = np.random.default_rng(case.seed)
    kind = case.kind
    time = np.arange(0.0, HOLD_S + 1.0, 1.0 / case.rate_hz)
    part = int(rng.integers(len(PARTS)))
    kinds = ["as_given"] * len(PARTS)
    if kind in REGIONAL:
        kinds[part] = kind
        case.truth["region"] = solved.TARGETS[PARTS[part]]
    share, times = 0.0, (1.5, 9.0)
    if kind.startswith("relaxation"):
        share, times = rng.uniform(0.15, 0.38), (rng.uniform(0.8, 2.0), rng.uniform(6.0, 14.0))
        case.truth["share"] = share
    loss = rng.uniform(0.10, 0.18) if kind == "softening" else 0.0
    usual = np.clip(rng.normal(GIVEN, 0.5, len(PARTS)), -1.6, 0.6)
    place = rng.normal(0.0, 0.8, 2)
    trend = {"loosening": -0.7, "tightening": 0.6}.get(kind, 0.0)
    fault = _fault(kind, rng) | {"step": rng.choice([0.25, 0.5, 1.0])}
    cell_seed = int(rng.integers(2**31))
    loads = [1.0, 1.0, 1.0, 1.0]
    holds = []
    for number in range(case.holds):
        start = usual + rng.normal(0.0, 0.2, len(PARTS)) + 0.35 * (loads[number] - 1.0)
        drift = trend * rng.uniform(0.7, 1.3, len(PARTS)) + rng.normal(0.0, 0.12, len(PARTS))
        wander = np.zeros((len(time), len(PARTS)))
        for k in range(1, len(time)):
            wander[k] = 0.9 * wander[k - 1] + rng.normal(0.0, 0.04, len(PARTS))
        onset = np.clip(time / 0.8, 0.0, 1.0)
        relaxing = 1.0 - share * (1.0 - 0.5 * np.exp(-time / times[0]) - 0.5 * np.exp(-time / times[1]))
        here = place + rng.normal(0.0, 0.3, 2)
        frames, trace = [], []
        for k, instant in enumerate(time):
            posture = start + wander[k] + drift * instant / HOLD_S - 1.2 * (1.0 - onset[k])
            places, force = grasp.at(posture, kinds)
            force = force * relaxing[k] * (1.0 - loss) ** number
            frames.append(layout.read(places, force, grasp.area, here))
            trace.append(force.sum())
        frames, trace = np.array(frames), np.array(trace)
        if number == 0:
            _aim(fault, frames, rng)
        cells = np.random.default_rng(cell_seed)
        shown = mat.sensor(frames, cells, fault | {"time_s": time})
        trace = trace * rng.normal(1.0, 0.01) * (1.0 + rng.normal(0.0, 0.004, len(trace)))
        holds.append((time, shown, None if kind.endswith("without_trace") else trace))
    case.truth["kind"] = kind
    case.truth["fault"] = {name: str(value) for name, value in fault.items() if name != "step"}
    return holds


def _fault(kind, rng):
    if kind == "gain":
        return {"gain": rng.choice([0.7, 0.75, 1.3, 1.4])}
    if kind == "creep":
        return {"creep": rng.uniform(0.08, 0.16)}
    if kind == "floor":
        return {"floor": rng.uniform(6.0, 11.0)}
    return {"wanted": kind}


def _aim(fault, frames, rng):
    """Puts faults of cells where there is load, once the first hold is known."""
    mean = frames.mean(axis=0)
    kind = fault.pop("wanted", "")
    if kind == "ceiling":
        fault["ceiling"] = np.round(rng.uniform(0.5, 0.65) * frames.max())
    if kind == "part":
        is_columns = bool(rng.random() < 0.5)
        load = mean.sum(axis=0 if is_columns else 1)
        used = np.flatnonzero(load > 0.1 * load.max())
        width = max(3, round(len(used) * rng.uniform(0.25, 0.45)))
        first = int(used[rng.integers(0, len(used) - width)])
        fault["part"] = (first, first + width - 1, rng.choice([0.6, 0.65, 1.5, 1.6]), is_columns)
    if kind == "dead":
        dead = np.zeros(mean.shape, bool)
        if rng.random() < 0.5:
            dead[:, mean.sum(axis=0).argsort()[-int(rng.integers(1, 8))]] = True
        else:
            loaded = np.argwhere(mean > 25.0)
            for row, column in loaded[rng.choice(len(loaded), 6, replace=False)]:
                dead[row, column] = True
        fault["dead"] = dead


def write(case, folder, reach_mm=9.0, sectors=0):
    """Writes the study of a case into `folder`; its truth is in `case.truth` alone.

    Skin within `reach_mm` of what can touch is written; the handle as solved, or a cylinder of so many `sectors`.
    """
    grasp = Grasp(case.sample)
    layout = mat.around(grasp.product, grasp.posed[grasp.touched])
    holds = draw(case, grasp, layout)
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    vertices, triangles, regions = grasp.cropped(reach_mm)
    write_skin(folder / "skin.ply", vertices, triangles)
    rows = "\n".join(f"{k},{grasp.names[r] if r >= 0 else -1}" for k, r in enumerate(regions))
    (folder / "regions.csv").write_text(f"vertex,region\n{rows}\n")
    points, faces = layout.cylinder(grasp.product, sectors) if sectors else (grasp.product, grasp.faces)
    lines = [f"v {x:.3f} {y:.3f} {z:.3f}" for x, y, z in points]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (folder / "handle.obj").write_text("\n".join(lines) + "\n")
    text = [_HEAD]
    for region in grasp.names:
        modulus, thickness = (0.023, 7.14) if region.endswith("_pad") else (0.0132, 13.4)
        text.append(
            f"[skin.materials.{region}]\ng0_mpa = {modulus}\ng_lim_mpa = {modulus}\nthickness_mm = {thickness}\n"
        )
    text.append('[indenters.handle]\nshape = "mesh"\nfile = "handle.obj"\n')
    text.append("[instrument]\ngain_percent = 5.0\n")
    for number, (time, frames, trace) in enumerate(holds):
        write_frames(folder / f"hold_{number + 1}.asf", time, frames, layout)
        text.append(
            f'[[recordings]]\nname = "hold, {number + 1}"\nkind = "grasp"\nfile = "hold_{number + 1}.asf"\n'
            f'indenter = "handle"\nprotocol = "hold"\norder = {number}'
        )
        if trace is not None:
            force = "\n".join(f"{t:.2f},{f:.3f}" for t, f in zip(time, trace, strict=True))
            (folder / f"force_{number + 1}.csv").write_text(f"time_s,force_n\n{force}\n")
            text.append(f'force = "force_{number + 1}.csv"')
        text.append(layout.placing())
    (folder / "study.toml").write_text("\n".join(text))


_HEAD = """[study]
title = "A hand on a cylinder"

[skin]
mesh = "skin.ply"
regions = "regions.csv"
"""


def write_skin(path, vertices, triangles):
    """A binary PLY."""
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    path.write_bytes(head.encode() + vertices.astype("<f4").tobytes() + faces.tobytes())


def write_frames(path, time, frames, layout):
    """Frames (t, rows, columns), kPa, as a movie of a film sensor in plain text: a matrix for each frame."""
    rows, columns = frames.shape[1:]
    around = 2 * np.pi * layout.radius_mm / columns
    head = (
        f"DATA_TYPE MOVIE\nSENSOR_TYPE drawn\nROWS {rows}\nCOLS {columns}\n"
        f"ROW_SPACING {layout.pitch_mm} mm\nCOL_SPACING {around:.5f} mm\nSENSEL_AREA {layout.cell_mm2:.5f} mm2\n"
        f"SECONDS_PER_FRAME {time[1] - time[0]:g}\nSTART_FRAME 1\nEND_FRAME {len(time)}\nUNITS KPa\nASCII_DATA @@\n\n"
    )
    with path.open("w") as file:
        file.write(head)
        for number, (instant, frame) in enumerate(zip(time, frames, strict=True)):
            file.write(f"Frame {number + 1}, {instant:.2f}\n")
            file.writelines(",".join(f"{value:g}" for value in row) + "\n" for row in frame)
            file.write("\n")
        file.write("@@\n")


def cases(seed, sample, counts):
    """Cases of each kind as `counts` says, softening with four holds, seeds from `seed` on."""
    made = []
    for kind, count in counts.items():
        for _ in range(count):
            made.append(Case(kind, seed + len(made), sample, 4 if kind == "softening" else 3))
    return made


def save_labels(made, path):
    """The truths, apart from the studies."""
    Path(path).write_text(json.dumps([{"seed": case.seed, **case.truth} for case in made], indent=1))
