"""Study folders from finite elements: what a mat and a load cell would have recorded on a pad with or without a spot.

    make(case, seed, noise, folder, mat="fine") -> Truth

writes `study.toml`, `skin.ply` and the recordings (as README's study format has them) to `folder`, from
`inclusions_by_finite_elements.npz` (see the script of that name) and a seed; the same arguments give the same bytes.

- `case`: a name of `PADS` (nothing planted: a null) or of `SPOTS` (the pad `finger` with a stiff or soft ball).
- `noise`: standard deviation as a share of a recording's largest value, for force and pressure alike: 0.01, 0.03.
- `mat`: `fine` (2.5 mm pitch, on the pad as computed) or `coarse` (4.9 mm, 4.2 sensels/cm2, on a pad 1.96 times the
  size, so that the contact spans as many sensels).

The seed draws: the tissue's modulus (6 to 18 kPa), a gain of 4 % for every press (the same for its force and its map:
the skin of that minute), an error of the judged first touch of 0.02 mm (depths are written with it), the grid's place
and turn on the tool (as written in the sensels' files), an error of that place of 0.4 mm and 0.7 degrees a mounting,
which is not written, and noise with a correlation time of 0.15 s. Cells under the mat's threshold (twice the noise,
stated in `[instrument]`) are written as 0. Every study holds three protocols of two repeats: plate, plate with the mat
turned by 90 degrees and moved, rod; each press is a force curve to 15 % of the thickness and a map of three frames, at
5, 10 and 15 %. First touch is the origin, z points out of the skin.

What is there without a spot: a layer model of the right thickness, its modulus refitted to every frame, misses the mean
pressures over 2.4 mm squares by 2 to 4 % (rms) and 4 to 9 % (worst square) of the largest pressure, the more the
deeper, and needs a modulus that is 0.80 to 0.90 of the tissue's and differs by 2 to 5 % between plate and rod
(`python -m trial.finite_elements.against_layer`): finite strain and the bone's curvature. No spot may be claimed from
that. A spot changes the pressure over it by 20 to 95 % of the largest.

`Truth` says where the spot is (`center_mm`, the skin's point above it at rest; None for nulls), its depth, radius and
contrast.
"""

import functools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import map_coordinates
from scipy.spatial import Delaunay
from trial import pads

TABLE = Path(__file__).parent / "finite_elements/inclusions_by_finite_elements.npz"
MATS = {"fine": (2.5, 1.0), "coarse": (4.9, 1.96)}  # pitch mm, size of the pad over the computed one
SPACING_MM = 1.2  # of the skin's vertices, on the computed size
MODULUS_MPA = (0.006, 0.018)
REPEAT_GAIN = 0.04
ZERO_MM = 0.02
POSITION_MM, TURN_DEG = 0.4, 0.7
MEMORY_S = 0.15
SAMPLES = 60
CELLS = 8  # sensels a side
MOUNTINGS = (("plate press", "plate", 0.0), ("plate press, mat turned", "plate", 90.0), ("rod press", "rod", 0.0))
REPEATS = 2


@dataclass(frozen=True)
class Truth:
    """What was planted: the skin's point above the ball's center, its depth and radius (mm), G inside over outside."""

    center_mm: tuple[float, float, float] | None = None
    depth_mm: float | None = None
    radius_mm: float | None = None
    contrast: float | None = None


def make(case, seed, noise, folder, mat="fine"):
    """Writes one study folder (see the module) and returns its `Truth`; KeyError for a case that is not computed."""
    random = np.random.default_rng([seed, *case.encode()])
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    pitch, size = MATS[mat]
    shape = Pad(case if case in pads.PADS else "finger", size)
    modulus = np.exp(random.uniform(*np.log(MODULUS_MPA)))
    recordings, peak, most = [], 0.0, 0.0
    for number, (protocol, tool, turn) in enumerate(MOUNTINGS):
        grid = Grid.mounted(random, pitch, turn)
        (folder / f"sensels_{number}.csv").write_text(grid.table(shape, tool))
        for repeat in range(REPEATS):
            press = Press(case, tool, shape, modulus * (1.0 + REPEAT_GAIN * random.standard_normal()))
            name = f"press_{number}_{repeat}.csv"
            zero = ZERO_MM * random.standard_normal()
            found = press.write(folder / name, random, noise, zero)
            frames, seen = press.frames(grid, random, noise)
            recordings.append((protocol, tool, number, repeat, frames, zero))
            peak, most = max(peak, seen), max(most, found)
    threshold = 2.0 * noise * peak
    entries = [_mat_file(folder, entry, shape, threshold) for entry in recordings]
    (folder / "study.toml").write_text(_study(shape, entries, (pitch, noise * most, threshold)))
    (folder / "skin.ply").write_text(shape.skin())
    return shape.truth(case)


class Pad:
    """A pad of PADS in the size of a study."""

    def __init__(self, name, size):
        self.size = size
        self.rx, self.ry, self.thickness = (size * value for value in pads.PADS[name][:3])
        self.rod_radius = size * pads.ROD_RADIUS_MM

    def height(self, x, y):
        """Of the skin at rest, mm."""
        return -(x**2 / self.rx + y**2 / self.ry) / 2.0

    def truth(self, case):
        if case not in pads.SPOTS:
            return Truth()
        x, y, depth, radius, contrast = pads.SPOTS[case]
        x, y = self.size * x, self.size * y
        return Truth((x, y, float(self.height(x, y))), self.size * depth, self.size * radius, contrast)

    def surface(self, spacing):
        """Vertices and triangles of the skin at rest: a triangular grid with its points moved at random, facing +z."""
        random = np.random.default_rng(7)
        half = pads.RIM * self.thickness + 3.0 * self.size
        rows = []
        for k, y in enumerate(np.linspace(-half, half, round(2.0 * half / (0.87 * spacing)) + 1)):
            x = np.linspace(-half, half, round(2.0 * half / spacing) + 1)
            x[1:-1] += spacing * (0.25 if k % 2 else -0.25)
            rows.append(np.stack([x, np.full_like(x, y)], axis=1))
        points = np.concatenate(rows)
        inner = np.abs(points).max(axis=1) < half - 1e-9
        points[inner] += random.uniform(-0.15, 0.15, (inner.sum(), 2)) * spacing
        triangles = Delaunay(points).simplices
        edges = points[triangles][:, 1:] - points[triangles][:, :1]
        turned = edges[:, 0, 0] * edges[:, 1, 1] < edges[:, 0, 1] * edges[:, 1, 0]
        triangles[turned] = triangles[turned][:, ::-1]
        return np.column_stack([points, self.height(*points.T)]), triangles

    def skin(self):
        """The surface as a PLY file."""
        vertices, triangles = self.surface(SPACING_MM * self.size)
        head = f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\n"
        head += "property double x\nproperty double y\nproperty double z\n"
        head += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
        body = [f"{x:.5f} {y:.5f} {z:.5f}" for x, y, z in vertices]
        return head + "\n".join(body + [f"3 {a} {b} {c}" for a, b, c in triangles]) + "\n"


class Grid:
    """Sensels on the tool's surface, unrolled: where they are said to lie, and where they do."""

    def __init__(self, stated, real, pitch, turn):
        self.stated, self.real, self.pitch, self.turn = stated, real, pitch, turn

    @classmethod
    def mounted(cls, random, pitch, turn):
        """A square grid of a size that covers the contact, its middle up to half a pitch beside first touch."""
        line = (np.arange(CELLS) - (CELLS - 1) / 2.0) * pitch
        flat = np.stack([c.ravel() for c in np.meshgrid(line, line)], axis=1)
        offset = random.uniform(-0.5, 0.5, 2) * pitch
        error, bend = POSITION_MM * random.standard_normal(2), TURN_DEG * random.standard_normal()
        stated = flat @ _turned(turn).T + offset
        real = flat @ _turned(turn + bend).T + offset + error
        return cls(stated, real, pitch, turn + bend)

    def means(self, raster, size):
        """Mean of a raster (of the pad as computed) over every sensel."""
        fine = (np.arange(8) - 3.5) / 8.0 * self.pitch
        inside = np.stack([c.ravel() for c in np.meshgrid(fine, fine)], axis=1) @ _turned(self.turn).T
        places = (self.real[:, None] + inside) / size / pads.RASTER_MM + (pads.RASTER_CELLS - 1) / 2.0
        return map_coordinates(raster, [places[..., 1], places[..., 0]], order=1).mean(axis=1)

    def table(self, shape, tool):
        """sensels.csv: the stated place of every cell at first touch."""
        lines = ["row,col,x_mm,y_mm,z_mm,area_mm2"]
        for k, (s, y) in enumerate(self.stated):
            x, z = (s, 0.0) if tool == "plate" else _on_rod(s, shape.rod_radius)
            lines.append(f"{k // CELLS},{k % CELLS},{x:.4f},{y:.4f},{z:.4f},{self.pitch**2:.4f}")
        return "\n".join(lines) + "\n"


class Press:
    """One press of a case by a tool: force over depth, pressures at three depths, in the study's size and modulus."""

    def __init__(self, case, tool, shape, modulus):
        self.scale, self.size, self.shape = modulus / pads.SHEAR_MPA, shape.size, shape
        self.force = table()[f"{case}/{tool}/force_n"] * self.scale * shape.size**2
        self.pressure = table()[f"{case}/{tool}/pressure_mpa"].astype(float) * self.scale
        self.depth = np.array(pads.STRAINS) * shape.thickness

    def write(self, path, random, noise, zero):
        """The load cell's file: a ramp at 1 mm/s (times the size), depths counted from the judged touch; its peak."""
        depth = np.linspace(0.0, self.depth[-1], SAMPLES)
        grown = PchipInterpolator(np.log(self.depth), np.log(self.force))
        slope = np.log(self.force[1] / self.force[0]) / np.log(self.depth[1] / self.depth[0])
        safe = np.log(np.maximum(depth, 1e-9))
        low = np.log(self.force[0]) + slope * (safe - np.log(self.depth[0]))
        force = np.where(depth < self.depth[0], np.exp(low), np.exp(grown(np.maximum(safe, np.log(self.depth[0])))))
        time = depth / self.size
        peak = force.max()
        force = force + noise * peak * colored(random, SAMPLES, time[1] - time[0])
        rows = [f"{t:.4f},{d + zero:.5f},{f:.6f}" for t, d, f in zip(time, depth, force, strict=True)]
        path.write_text("time_s,depth_mm,force_n\n" + "\n".join(rows) + "\n")
        return peak

    def frames(self, grid, random, noise):
        """Rows (time s, depth mm, sensel pressures kPa) of the map, and its largest pressure without noise, kPa."""
        means = 1000.0 * np.array([grid.means(raster, self.size) for raster in self.pressure])
        peak = means.max()
        noisy = means + noise * peak * random.standard_normal(means.shape)
        depths = self.depth[list(pads.MAPPED)]
        return [(d / self.size, d, p) for d, p in zip(depths, noisy, strict=True)], peak


@functools.cache
def table():
    """What the finite elements found: `case/tool/force_n` and `case/tool/pressure_mpa`."""
    return dict(np.load(TABLE))


def colored(random, count, step_s):
    """Noise of unit standard deviation whose correlation falls to 1/e in MEMORY_S."""
    keep = np.exp(-step_s / MEMORY_S)
    white = random.standard_normal(count)
    for k in range(1, count):
        white[k] = keep * white[k - 1] + np.sqrt(1.0 - keep**2) * white[k]
    return white


def _turned(degrees):
    """Rotation in the plane of the mat."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s], [s, c]])


def _on_rod(arc, radius):
    """x and z of a place on the rod's surface, an arc away from first touch."""
    return radius * np.sin(arc / radius), radius * (1.0 - np.cos(arc / radius))


def _mat_file(folder, entry, shape, threshold):
    """The mat's file of one press; what study.toml needs to know of it."""
    protocol, tool, number, repeat, frames, zero = entry
    lines = ["time_s,row,col,pressure_kpa,depth_mm"]
    for time, depth, pressures in frames:
        for k, value in enumerate(pressures):
            shown = 0.0 if value < threshold else value
            lines.append(f"{time:.4f},{k // CELLS},{k % CELLS},{shown:.4f},{depth + zero:.5f}")
    (folder / f"mat_{number}_{repeat}.csv").write_text("\n".join(lines) + "\n")
    return protocol, tool, number, repeat


def _study(shape, entries, sheet):
    """study.toml."""
    pitch, noise_n, threshold = sheet
    text = f"""[study]
title = "A pad over bone, pressed by a plate and a rod"
[skin]
mesh = "skin.ply"
[skin.materials.default]
g0_mpa = 0.008
g_lim_mpa = 0.015
d_lim_mm = {0.25 * shape.thickness:.3f}
thickness_mm = {shape.thickness:.3f}
[indenters.plate]
shape = "plane"
[indenters.rod]
shape = "cylinder"
radius_mm = {shape.rod_radius:.3f}
axis = [0.0, 1.0, 0.0]
[sites.pad]
point_mm = [0.0, 0.0, 0.0]
direction = [0.0, 0.0, -1.0]
"""
    for protocol, tool, number, repeat in entries:
        about = f'indenter = "{tool}"\nsite = "pad"\nprotocol = "{protocol}"\norder = {2 * number + repeat}\n'
        curve = f"press_{number}_{repeat}.csv"
        text += (
            f'[[recordings]]\nname = "{protocol}, force {repeat + 1}"\nkind = "indentation"\nfile = "{curve}"\n{about}'
        )
        text += f'[[recordings]]\nname = "{protocol}, mat {repeat + 1}"\nkind = "pressure_map"\n'
        text += f'file = "mat_{number}_{repeat}.csv"\nsensels = "sensels_{number}.csv"\nmotion = "{curve}"\n{about}'
    text += f"[instrument]\ngain_percent = {100.0 * REPEAT_GAIN:.1f}\nnoise_n = {noise_n:.6f}\n"
    return text + f"threshold_kpa = {threshold:.4f}\npitch_mm = {pitch}\nposition_mm = {POSITION_MM}\n"
