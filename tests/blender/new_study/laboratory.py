"""Recordings as laboratories export them, in plain Python: presses of a ball on gel by Hertz, in any unit and habit."""

import math
import random

HEAD = ("time_s", "depth_mm", "force_n")
AS_IS = (1.0, 1.0, 1.0)


def hertz_n(depth_mm, radius_mm=6.0, g_mpa=0.012):
    """Force of a rigid ball on an incompressible half-space, N: 16/3 G sqrt(R) d^1.5 (Johnson 1985, 4.24)."""
    return 16.0 / 3.0 * g_mpa * math.sqrt(radius_mm) * max(depth_mm, 0.0) ** 1.5


def press(seed=0, speed_mm_s=1.0, deepest_mm=0.8, radius_mm=6.0, wait_s=0.2):
    """Rows of time (s), depth (mm), force (N): a wait, down, up; 4 mN of noise, and a gain of 1 % that scatters."""
    draw = random.Random(seed)
    gain, lift, step = 1.0 + 0.01 * draw.gauss(0.0, 1.0), 0.1, 0.02
    down = (deepest_mm + lift) / speed_mm_s
    count = round((wait_s + 2.0 * down) / step / max(1.0, 0.5 / speed_mm_s))
    rows = []
    for number in range(count):
        time = number * (wait_s + 2.0 * down) / (count - 1)
        moved = max(0.0, time - wait_s)
        depth = -lift + speed_mm_s * (moved if moved < down else 2.0 * down - moved)
        rows.append((time, depth, gain * hertz_n(depth, radius_mm) + 0.004 * draw.gauss(0.0, 1.0)))
    return rows


def write(path, rows, head=HEAD, factors=AS_IS, **habits):
    """Write rows with these names, each column times its factor. Returns the file's name.

    `habits`: `separator`, `comma` (decimal), `above` (free lines), `units` (rows below the names), `encoding`.
    """
    separator, comma = habits.get("separator", ","), habits.get("comma", False)
    lines = [*habits.get("above", ()), *([separator.join(head)] if head else ())]
    lines += [separator.join(units) for units in habits.get("units", ())]
    for row in rows:
        fields = [f"{value * factor:.7g}" for value, factor in zip(row, factors, strict=True)]
        lines.append(separator.join(field.replace(".", ",") if comma else field for field in fields))
    path.write_text("\n".join(lines) + "\n", encoding=habits.get("encoding", "utf-8"))
    return path.name
