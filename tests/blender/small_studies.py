"""Small studies as folders: a skin, one tool and presses whose force is a formula, made without the code under test."""

import numpy as np


def write_skin(path, vertices_mm, triangles):
    """A skin as OBJ, mm."""
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in vertices_mm]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]
    path.write_text("\n".join(lines) + "\n")


def flat_skin(half=6):
    """A flat square of millimetre cells: vertices (n, 3), triangles (m, 3)."""
    side = np.arange(-half, half + 1.0)
    count = len(side)
    vertices = [(x, y, 0.0) for y in side for x in side]
    triangles = []
    for row in range(count - 1):
        for column in range(count - 1):
            a = row * count + column
            triangles += [(a, a + 1, a + count + 1), (a, a + count + 1, a + count)]
    return np.array(vertices), np.array(triangles)


def hertz_n(depth_mm, radius_mm=8.0, g_mpa=0.02):
    """Force of a rigid ball on an incompressible half space, N (Hertz: 4/3 E* sqrt(R) d^1.5 with E* = 4 G)."""
    return 4 / 3 * 4 * g_mpa * np.sqrt(radius_mm) * depth_mm**1.5


def write(folder, skin, point_mm=(0.0, 0.0, 0.0), direction=(0.0, 0.0, -1.0)):
    """A study of one press by a ball of 8 mm on `skin` (vertices, triangles). Returns study.toml."""
    write_skin(folder / "skin.obj", *skin)
    depth = np.linspace(0.05, 0.8, 30)
    rows = "".join(f"{0.1 * k + 0.1},{d},{f}\n" for k, (d, f) in enumerate(zip(depth, hertz_n(depth), strict=True)))
    (folder / "press.csv").write_text("time_s,depth_mm,force_n\n" + rows)
    path = folder / "study.toml"
    path.write_text(
        '[study]\ntitle = "Ball"\n[skin]\nmesh = "skin.obj"\n[skin.materials.default]\ng0_mpa = 0.03\n'
        'g_lim_mpa = 0.05\nd_lim_mm = 4.0\nthickness_mm = "inf"\n[indenters.ball]\nshape = "sphere"\nradius_mm = 8.0\n'
        f"[sites.middle]\npoint_mm = {[float(x) for x in point_mm]}\n"
        f"direction = {[float(x) for x in direction]}\n"
        '[[recordings]]\nname = "press"\nkind = "indentation"\nfile = "press.csv"\nindenter = "ball"\nsite = "middle"\n'
    )
    return path


def write_mat(folder, skin, point_mm, dull):
    """A study of four frames of a flat mat under the lowest point of a ball, whose sensel `dull` reads a tenth.

    The readings are Hertz pressures of a ball of 8 mm on a plate; they need not be what the model gives.
    """
    write_skin(folder / "skin.obj", *skin)
    side, pitch = 7, 1.5
    cells = [(row, column) for row in range(side) for column in range(side)]
    places = {cell: ((cell[1] - side // 2) * pitch, (cell[0] - side // 2) * pitch) for cell in cells}
    x, y, z = point_mm
    rows = [f"{r},{c},{x + places[r, c][0]},{y + places[r, c][1]},{z},{pitch**2}" for r, c in cells]
    (folder / "sensels.csv").write_text("row,col,x_mm,y_mm,z_mm,area_mm2\n" + "\n".join(rows) + "\n")
    lines, motion = [], []
    for time, depth in ((0.5, 0.5), (1.0, 1.0), (1.5, 1.5), (2.0, 2.0)):
        radius, peak = np.sqrt(8.0 * depth), 2 / np.pi * 4 * 0.02 * np.sqrt(depth / 8.0) * 1e3
        motion.append(f"{time},{depth},{hertz_n(depth)}")
        for cell, (along, across) in places.items():
            share = 1 - (along**2 + across**2) / radius**2
            reading = peak * np.sqrt(max(share, 0.0)) * (0.1 if cell == dull else 1.0)
            lines.append(f"{time},{cell[0]},{cell[1]},{reading}")
    (folder / "mat.csv").write_text("time_s,row,col,pressure_kpa\n" + "\n".join(lines) + "\n")
    (folder / "motion.csv").write_text("time_s,depth_mm,force_n\n" + "\n".join(motion) + "\n")
    path = folder / "study.toml"
    path.write_text(
        '[study]\ntitle = "Mat"\n[skin]\nmesh = "skin.obj"\n[skin.materials.default]\ng0_mpa = 0.02\n'
        'g_lim_mpa = 0.05\nd_lim_mm = 4.0\nthickness_mm = 7.0\n[indenters.plate]\nshape = "plane"\n[sites.low]\n'
        f"point_mm = {[float(v) for v in point_mm]}\ndirection = [0.0, 0.0, 1.0]\n"
        '[[recordings]]\nname = "mat"\nkind = "pressure_map"\nfile = "mat.csv"\nsensels = "sensels.csv"\n'
        'motion = "motion.csv"\nindenter = "plate"\nsite = "low"\n'
    )
    return path


def write_relaxing(folder, share, seed=1):
    """A study of two balls at two speeds, each held and pressed twice, on skin whose force fades by `share` in 1.4 s.

    Force by superposition of Hertz's over a Prony series of one term (Fung 1993, 7.6), with 1 % noise and repeats that
    differ by 2 % in gain. Returns study.toml.
    """
    noise = np.random.default_rng(seed)
    write_skin(folder / "skin.obj", *flat_skin(half=9))
    head = (
        '[study]\ntitle = "Fading"\n[skin]\nmesh = "skin.obj"\n[skin.materials.default]\ng0_mpa = 0.02\n'
        'g_lim_mpa = 0.02\nd_lim_mm = 4.0\nthickness_mm = "inf"\n[sites.middle]\npoint_mm = [0.0, 0.0, 0.0]\n'
        "direction = [0.0, 0.0, -1.0]\n"
    )
    parts = [head]
    for name, radius in (("small", 4.0), ("large", 10.0)):
        parts.append(f'[indenters.{name}]\nshape = "sphere"\nradius_mm = {radius}\n')
    for tool, radius in (("small", 4.0), ("large", 10.0)):
        for speed in (0.5, 5.0):
            for repeat in (1, 2):
                time, depth = _press_and_hold(speed, 0.8)
                elastic = hertz_n(np.maximum(depth, 0.0), radius)
                force = _faded(time, elastic, (share, 1.4)) * (1 + 0.02 * noise.standard_normal())
                force += 0.01 * elastic.max() * noise.standard_normal(len(time))
                file = f"{tool}-{speed:g}-{repeat}.csv"
                rows = "".join(f"{t:.4f},{d:.5f},{f:.6f}\n" for t, d, f in zip(time, depth, force, strict=True))
                (folder / file).write_text("time_s,depth_mm,force_n\n" + rows)
                parts.append(
                    f'[[recordings]]\nname = "{tool}, {speed:g} mm/s, repeat {repeat}"\nkind = "indentation"\n'
                    f'file = "{file}"\nindenter = "{tool}"\nsite = "middle"\nprotocol = "{tool}, {speed:g} mm/s"\n'
                    "rest_s = 300.0\n"
                )
    path = folder / "study.toml"
    path.write_text("".join(parts))
    return path


def _press_and_hold(speed_mm_s, deepest_mm):
    """Times and depths: 0.3 s above the skin, pressed in, held for 6 s, drawn back, 0.3 s above the skin."""
    down = deepest_mm / speed_mm_s
    corners = [0.0, 0.3, 0.3 + down, 6.3 + down, 6.3 + 2 * down, 6.6 + 2 * down]
    depths = [-0.05, 0.0, deepest_mm, deepest_mm, 0.0, -0.05]
    time = np.unique(np.concatenate([np.linspace(a, b, 16) for a, b in zip(corners, corners[1:], strict=False)]))
    return time + 0.1, np.interp(time, corners, depths)


def _faded(time, elastic, series):
    """Force of skin that forgets `share` of every step of the elastic force in `tau` s."""
    share, tau = series
    fine = np.linspace(time[0], time[-1], 4000)
    steps = np.diff(np.interp(fine, time, elastic), prepend=0.0)
    kept, out, step = 0.0, np.empty_like(fine), fine[1] - fine[0]
    total = 0.0
    for place, change in enumerate(steps):
        kept = kept * np.exp(-step / tau) + change
        total += change
        out[place] = (1 - share) * total + share * kept
    return np.maximum(np.interp(time, fine, out), 0.0)  # nothing holds skin and tool together
