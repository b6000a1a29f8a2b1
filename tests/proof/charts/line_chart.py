"""A line chart as an SVG file: axes with ticks, curves with a name and color each; nothing but text is written."""

from pathlib import Path

import numpy as np

WIDTH, HEIGHT = 560, 320
LEFT, RIGHT, TOP, BOTTOM = 64, 150, 40, 48
COLORS = ("#c2410c", "#1d4ed8", "#15803d", "#7e22ce", "#475569")
FONT = 'font-family="sans-serif" font-size="12"'
MARGIN = 0.06
"""Share of the range that is left free above and below the curves."""


def write(path, words, curves):
    """Write `curves` ({name: (x, y)}; points that are NaN are left out); `words`: title, name of x and y with units."""
    points = [np.asarray(curve, dtype=float) for curve in curves.values()]
    points = [p[:, np.isfinite(p).all(axis=0)] for p in points]
    frame = _frame(np.hstack(points))
    parts = [*_axes(frame, words)]
    for (name, p), color in zip(zip(curves, points, strict=True), COLORS, strict=False):
        at = _place(frame, p)
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in at)
        parts.append(f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="2"/>')
        parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" fill="{color}"/>' for x, y in at if len(at) < 20]
        row = TOP + 18 * (1 + list(curves).index(name))
        parts.append(f'<rect x="{WIDTH - RIGHT + 12}" y="{row - 9}" width="12" height="4" fill="{color}"/>')
        parts.append(f'<text x="{WIDTH - RIGHT + 30}" y="{row - 3}">{name}</text>')
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" {FONT}>'
    body = "\n".join([head, f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>', *parts, "</svg>", ""])
    Path(path).write_text(body, encoding="utf-8")


def _frame(points):
    """((least x, greatest x), (least y, greatest y)) of the chart."""
    low, high = points.min(axis=1), points.max(axis=1)
    room = MARGIN * (high[1] - low[1] or 1.0)
    return (low[0], high[0]), (low[1] - room, high[1] + room)


def _place(frame, points):
    """(n, 2) places on the page of (2, n) points."""
    (x0, x1), (y0, y1) = frame
    across = LEFT + (points[0] - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT)
    down = HEIGHT - BOTTOM - (points[1] - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM)
    return np.column_stack([across, down])


def _axes(frame, words):
    title, name_x, name_y = words
    middle = (LEFT + WIDTH - RIGHT) / 2
    yield f'<text x="{LEFT}" y="22" font-size="14">{title}</text>'
    yield f'<text x="{middle}" y="{HEIGHT - 10}" text-anchor="middle">{name_x}</text>'
    turned = f"rotate(-90 16 {HEIGHT / 2})"
    yield f'<text x="16" y="{HEIGHT / 2}" text-anchor="middle" transform="{turned}">{name_y}</text>'
    for value in _ticks(frame[0]):
        ((x, _),) = _place(frame, np.array([[value], [frame[1][0]]]))
        yield f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}" stroke="#e5e7eb"/>'
        yield f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{value:g}</text>'
    for value in _ticks(frame[1]):
        ((_, y),) = _place(frame, np.array([[frame[0][0]], [value]]))
        yield f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}" stroke="#e5e7eb"/>'
        yield f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{value:g}</text>'


def _ticks(span):
    """Round numbers in a range, four to nine of them."""
    rough = (span[1] - span[0]) / 4.0
    power = 10.0 ** np.floor(np.log10(rough))
    step = max(s for s in (1.0, 2.0, 5.0) if s * power <= rough) * power
    return [round(k * step, 10) for k in range(int(np.ceil(span[0] / step)), int(np.floor(span[1] / step)) + 1)]
