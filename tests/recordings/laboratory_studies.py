"""Study folders made of the shared laboratory recordings, with what their sources leave open assumed and said to be.

    write(name, shared, folder) -> Path        # name of STUDIES

The recordings stay where they lie and are copied, or cut, into the folder. A flat skin stands for every sample.
"""

import csv
import shutil
from pathlib import Path

import numpy as np

TIP_MM = 5.0  # assumed: no source says which tip pressed the skin
GEL_TIP_MM = 0.005  # assumed: "pr14" is not described


def write(name, shared, folder):
    """Writes one of `STUDIES` into a folder of its own; the folder."""
    folder = Path(folder) / name
    folder.mkdir(parents=True)
    STUDIES[name](Path(shared), folder)
    return folder


def force_ramps(shared, folder):
    """Four force ramps on what is probably hairy skin; neither tip nor thickness is known."""
    targets = (100, 400, 800, 1000)
    for target in targets:
        shutil.copy(shared / f"skin_indent_force_ramp/target_{target:04d}mN.ddf", folder / f"{target}.ddf")
    _skin(folder, 14.0, 1.0)
    names = [(f"to {target} mN", f"{target}.ddf", f"ramp to {target} mN") for target in targets]
    tool = f'shape = "sphere"\nradius_mm = {TIP_MM}'
    _study(folder, "Force ramps on skin, tip assumed", (0.01, 0.1, 4.0, "12.0", '["g0_mpa", "g_lim_mpa"]'), tool, names)


def gel_creep(shared, folder):
    """A gel under an undescribed tip: approach, 3 s at constant force, retraction that clings."""
    shutil.copy(shared / "afm_gel_and_soft_matrix/polymer_gel_creep.jpk-force", folder / "gel.jpk-force")
    _skin(folder, 0.012, 0.001)
    tool = f'shape = "sphere"\nradius_mm = {GEL_TIP_MM}'
    numbers = (1e-4, 1e-4, 1000.0, '"inf"', '["g0_mpa"]')
    _study(folder, "Polymer gel, tip assumed", numbers, tool, [("gel", "gel.jpk-force", "creep")])


def silicone(shared, folder):
    """Three cylinders of Ecoflex 00-10 under a plate, to 66.7 %; to 15 % here, beyond which no small strain holds."""
    names = []
    for sample in ("A1", "A2", "B1"):
        lines = (shared / f"silicone_compression/EF10_0T_{sample}.csv").read_text().splitlines()
        first = next(k for k, line in enumerate(lines) if line.startswith("Time"))
        rows = [row for row in csv.DictReader(lines[first:]) if float(row["Compression (mm)"]) <= 4.5]
        text = [f"{row['Time (s)']},{row['Compression (mm)']},{row['Load (N)']}" for row in rows]
        (folder / f"{sample}.csv").write_text("time_s,depth_mm,force_n\n" + "\n".join(text) + "\n")
        names.append((f"EF10 0T, {sample}", f"{sample}.csv", "compression"))
    _disc(folder, 25.0, 1.5)
    numbers = (0.02, 0.02, 1000.0, "30.0", '["g0_mpa"]')
    _study(folder, "Ecoflex 00-10 cylinders", numbers, 'shape = "plane"', names)


def finger_on_mat(shared, folder):
    """A finger pressed eleven times on an I-Scan mat, in raw counts; product and finger are assumed."""
    shutil.copy(shared / "finger_pressure_iscan/iscan_test.csv", folder / "mat.csv")
    line = np.linspace(-9.0, 9.0, 37)
    points = [(x, y, -(x * x / 14.0 + y * y / 22.0) / 2.0) for y in line for x in line]
    _mesh(folder, points, _faces(len(line)))
    numbers = (0.01, 0.05, 4.0, "7.0", '["g0_mpa", "g_lim_mpa"]')
    _study(folder, "Finger on I-Scan, product assumed", numbers, 'shape = "plane"', [("mat", "mat.csv", "presses")])
    # The middle of the field on which the finger lies: rows and columns 15 to 25 of cells of 1.27 mm.
    corner = -20.5 * 1.27
    text = (folder / "study.toml").read_text().replace('"indentation"', '"pressure_map"\ncalibrated = false')
    placing = f'[recordings.placing]\non = "plane"\norigin_mm = [{corner}, {corner}, 0.0]\n'
    (folder / "study.toml").write_text(text + placing + "columns = [1.0, 0.0, 0.0]\nrows = [0.0, 1.0, 0.0]\n")


STUDIES = {"force_ramps": force_ramps, "gel_creep": gel_creep, "silicone": silicone, "finger_on_mat": finger_on_mat}


def _skin(folder, half, spacing):
    """A flat square."""
    count = round(2 * half / spacing) + 1
    line = np.linspace(-half, half, count)
    _mesh(folder, [(x, y, 0.0) for y in line for x in line], _faces(count))


def _faces(count):
    """Triangles of a square of `count` by `count` points."""
    corners = [j * count + i for j in range(count - 1) for i in range(count - 1)]
    return [f for k in corners for f in ((k, k + 1, k + count), (k + 1, k + count + 1, k + count))]


def _disc(folder, radius, spacing):
    """A flat disc: the cylinder's end face."""
    rings = round(radius / spacing)
    points, faces, first = [(0.0, 0.0, 0.0)], [], [0]
    for ring in range(1, rings + 1):
        first.append(len(points))
        angles = np.arange(6 * ring) * 2 * np.pi / (6 * ring)
        points += [(radius * ring / rings * np.cos(a), radius * ring / rings * np.sin(a), 0.0) for a in angles]
    for ring in range(1, rings + 1):
        for side in range(6):
            for k in range(ring):
                outer = [first[ring] + (side * ring + k + step) % (6 * ring) for step in (0, 1)]
                inner = _inner(first, ring, side, k)
                faces.append((outer[0], outer[1], inner))
                if k < ring - 1:
                    faces.append((inner, outer[1], _inner(first, ring, side, k + 1)))
    _mesh(folder, points, faces)


def _inner(first, ring, side, k):
    return 0 if ring == 1 else first[ring - 1] + (side * (ring - 1) + k) % (6 * (ring - 1))


def _mesh(folder, points, faces):
    text = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in points]
    (folder / "skin.obj").write_text("\n".join(text + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]) + "\n")


def _study(folder, title, numbers, tool, names):
    g0, g_lim, d_lim, thickness, fit = numbers
    text = f"""[study]
title = "{title}"
[skin]
mesh = "skin.obj"
[skin.materials.default]
g0_mpa = {g0}
g_lim_mpa = {g_lim}
d_lim_mm = {d_lim}
thickness_mm = {thickness}
fit = {fit}
[indenters.tip]
{tool}
[sites.middle]
point_mm = [0.0, 0.0, 0.0]
direction = [0.0, 0.0, -1.0]
"""
    for name, file, protocol in names:
        text += f'[[recordings]]\nname = "{name}"\nkind = "indentation"\nfile = "{file}"\n'
        text += f'indenter = "tip"\nsite = "middle"\nprotocol = "{protocol}"\n'
    (folder / "study.toml").write_text(text)
