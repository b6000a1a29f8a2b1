"""Twelve products that hands hold, modelled as designers do: sizes in mm, the place to hold at the origin.

Knows nothing of Thenar and of Blender. Some are one closed body, some several that stand in each other, some lack a
face that nobody sees; some are coarse as CAD exports, some dense as sculpts.
"""

import numpy as np
from handles.random_products import block, joined, outward, revolved, swept

AXIS = np.array([0.0, 1.0, 0.0])


def mug():
    """A mug of 82 mm with a D-shaped handle of 12 by 12 mm: two parts, the origin within the handle."""
    across = np.array([0.0, 39.0, 41.0, 41.0, 38.0, 38.0, 36.0, 0.0])
    along = np.array([-48.0, -48.0, -46.0, 47.0, 47.0, -41.0, -43.0, -43.0])
    cup = revolved(across, along, 64)
    turn = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 25)
    line = np.stack([39.0 + 33.0 * np.cos(turn), np.zeros(25), 32.0 * np.sin(turn)], axis=1)
    return _moved(joined([cup, swept(line, AXIS, 6.0, 12)]), (-66.0, 0.0, 0.0))


def pistol_grip():
    """A raked grip of 30 by 46 mm, dense, under a frame and a barrel that are boxes."""
    height = np.linspace(-55.0, 45.0, 41)
    half = np.stack([15.0 + 1.5 * np.cos(height / 16.0), 23.0 + 2.0 * np.sin(height / 14.0)], axis=1)
    rings = [_oval(a, b, 3.0, 48) + [0.0, -0.28 * z, z] for z, (a, b) in zip(height, half, strict=True)]
    frame = block([-13.0, -45.0, 40.0], [13.0, 110.0, 66.0], 1)
    guard = np.array([[0.0, 12.0, 42.0], [0.0, 30.0, 16.0], [0.0, 52.0, 18.0], [0.0, 60.0, 42.0]])
    return joined([loft(rings), frame, swept(guard, np.array([1.0, 0.0, 0.0]), 3.0, 8)])


def dumbbell():
    """A bellied bar of 28 to 32 mm between two six-sided heads: three coarse parts."""
    along = np.array([-66.0, -66.0, -40.0, -15.0, 0.0, 15.0, 40.0, 66.0, 66.0])
    across = np.array([0.0, 14.0, 14.3, 15.6, 16.0, 15.6, 14.3, 14.0, 0.0])
    heads = [
        revolved(np.array([0.0, 36.0, 44.0, 44.0, 36.0, 0.0]), at + np.array([-24, -24, -18, 18, 24, 24.0]), 6)
        for at in (-86.0, 86.0)
    ]
    return joined([revolved(across, along, 20), *heads])


def joystick():
    """A stick of 34 to 46 mm without a bottom, its pommel with a button, on a base of 120 mm."""
    height = np.linspace(-60.0, 55.0, 24)
    wide = 17.0 + 2.0 * np.cos(height / 9.0) + 4.0 * np.exp(-(((height - 50.0) / 14.0) ** 2))
    rings = [_oval(w, 1.12 * w, 2.4, 36) + [0.0, 5.0 * np.sin(z / 40.0), z] for z, w in zip(height, wide, strict=True)]
    stick = loft(rings, is_open_below=True)
    button = revolved(np.array([0.0, 6.0, 6.0, 5.0, 0.0]), np.array([52.0, 52.0, 59.0, 60.0, 60.0]), 16)
    base = block([-60.0, -60.0, -95.0], [60.0, 60.0, -62.0], 2)
    return joined([stick, base, _moved(button, (0.0, 5.0, 0.0))])


def toothbrush():
    """A slender handle of 8 to 15 mm, 190 mm long, with a head of bristles as one block."""
    height = np.linspace(-95.0, 75.0, 60)
    wide = 5.5 + 1.8 * np.sin((height + 95.0) / 27.0) * (height < 40.0) - 1.6 * (height >= 40.0)
    rings = [_oval(w, 0.8 * w, 2.6, 20) + [0.0, 3.0 * np.sin(z / 45.0), z] for z, w in zip(height, wide, strict=True)]
    return joined([loft(rings), block([-6.0, -1.0, 70.0], [6.0, 5.0, 98.0], 1), block([-5, 4.9, 73], [5, 15, 96], 1)])


def door_knob():
    """A knob of 54 mm on a neck of 22 mm with its rosette, one turned body."""
    along = np.array([-52, -52, -46, -44, -22, -16, -8, 2, 11, 18, 22, 24, 24.0])
    across = np.array([0, 33, 32, 12, 11, 17, 25, 27, 26, 21, 12, 6, 0.0])
    return revolved(across, along, 40)


def tube():
    """A pipe of 33.7 mm with a wall of 2.6 mm, both ends open, long triangles as a CAD export has them."""
    return revolved(np.array([16.85, 16.85, 14.25, 14.25]), np.array([-180.0, 180.0, 180.0, -180.0]), 48, is_loop=True)


def tray():
    """A tray of 3 mm with an upright rim: five boxes that stand in each other, the origin at the middle of one rim."""
    rims = [
        ([-150.0, -3.0, -12.0], [150.0, 0.0, 12.0]),
        ([-150.0, -200.0, -12.0], [150.0, -197.0, 12.0]),
        ([-150.0, -200.0, -12.0], [-147.0, 0.0, 12.0]),
        ([147.0, -200.0, -12.0], [150.0, 0.0, 12.0]),
    ]
    return joined([block([-150.0, -200.0, -12.0], [150.0, 0.0, -9.0], 1), *(block(low, high, 1) for low, high in rims)])


def steering_wheel():
    """A rim of 360 by 29 mm with three spokes and a hub; the origin within the rim."""
    turn = np.linspace(0.0, 2.0 * np.pi, 97)[:-1]
    ring = np.stack([180.0 + 14.5 * np.cos(_turns(20)), 14.5 * np.sin(_turns(20))], axis=1)
    vertices = np.stack([np.outer(np.cos(turn), ring[:, 0]), np.outer(np.sin(turn), ring[:, 0])], axis=-1)
    vertices = np.concatenate([vertices, np.broadcast_to(ring[None, :, 1:], (96, 20, 1))], axis=-1).reshape(-1, 3)
    rim = outward(vertices, _grid(96, 20, is_round=True))
    hub = revolved(np.array([0.0, 45.0, 45.0, 0.0]), np.array([-25.0, -25.0, 5.0, 5.0]), 32)
    spokes = [_turned(block([30.0, -14.0, -10.0], [178.0, 14.0, -2.0], 1), angle) for angle in (1.57, 3.3, 6.12)]
    return _moved(joined([rim, hub, *spokes]), (-180.0, 0.0, 0.0))


def spray_bottle():
    """An oval bottle with a neck of 30 mm that is held, a head and a trigger: three parts."""
    height = np.array([-170, -168, -150, -70, -50, -36, -24, 22, 30.0])
    wide = np.array([34, 38, 40, 40, 34, 22, 15.5, 15, 14.0])
    deep = np.array([24, 27, 28, 28, 26, 20, 15.5, 15, 14.0])
    bottle = loft([_oval(a, b, 2.3, 40) + [0, 0, z] for z, a, b in zip(height, wide, deep, strict=True)])
    head = block([-14.0, -22.0, 26.0], [14.0, 62.0, 56.0], 1)
    trigger = loft([_oval(6.0, 4.0, 3.0, 16) + [0, y, z] for y, z in ((42, 30), (40, 12), (44, -8), (52, -26))])
    return joined([bottle, head, trigger])


def racket():
    """An eight-sided grip of 32 by 28 mm with its butt, a shaft, and a flat hoop: coarse, three parts."""
    flat = np.array([1, 0.42, -0.42, -1, -1, -0.42, 0.42, 1]), np.array([0.42, 1, 1, 0.42, -0.42, -1, -1, -0.42])
    scale = [(1.15, -95.0), (1.12, -86.0), (1.0, -78.0), (0.98, 95.0)]
    grip = loft([np.stack([16.0 * k * flat[0], 14.0 * k * flat[1], np.full(8, z)], 1) for k, z in scale])
    shaft = block([-9.0, -8.0, 80.0], [9.0, 8.0, 330.0], 1)
    turn = _turns(64)
    line = np.stack([130.0 * np.cos(turn), np.zeros(64), 500.0 + 175.0 * np.sin(turn)], axis=1)
    ring = np.stack([8.0 * np.cos(_turns(10)), 11.0 * np.sin(_turns(10))], axis=1)
    out = np.stack([np.cos(turn), np.zeros(64), np.sin(turn)], axis=1)
    hoop = line[:, None] + ring[None, :, :1] * out[:, None] + ring[None, :, 1:] * AXIS
    return joined([grip, shaft, outward(hoop.reshape(-1, 3), _grid(64, 10, is_round=True))])


def gaming_mouse():
    """A mouse of 68 by 124 by 40 mm with grooves between its buttons and a flat bottom: one dense body."""
    u, turn = np.linspace(-1.0, 1.0, 81)[1:-1], _turns(96)
    rings = []
    for s in u:
        half = 34.0 * (1.0 - 0.12 * np.cos(2.5 * s)) * (1.0 - np.abs(s) ** 3.2) ** (1.0 / 3.2)
        top = 40.0 * (0.62 + 0.38 * np.cos(1.4 * (s + 0.25))) * (1.0 - np.abs(s) ** 4) ** 0.25
        x, z = half * _power(np.cos(turn), 0.8), np.maximum(np.sin(turn), -0.25) * top
        groove = 1.2 * np.exp(-((x / 1.6) ** 2)) * (s > 0.15) * (np.sin(turn) > 0.0)
        rings.append(np.stack([x, np.full(96, 62.0 * s), z - groove - 14.0], axis=1))
    return loft(rings)


SHAPES = {
    "mug handle": mug,
    "pistol grip": pistol_grip,
    "dumbbell": dumbbell,
    "joystick": joystick,
    "toothbrush": toothbrush,
    "door knob": door_knob,
    "tube": tube,
    "tray edge": tray,
    "steering wheel": steering_wheel,
    "spray bottle": spray_bottle,
    "tennis racket": racket,
    "gaming mouse": gaming_mouse,
}


def loft(rings, is_open_below=False):
    """A skin over rings (k, n, 3) of equal count, its ends closed by fans."""
    rings = np.asarray(rings, float)
    count, around = rings.shape[:2]
    vertices = np.concatenate([rings.reshape(-1, 3), rings[[0, -1]].mean(axis=1)])
    k, after, last = np.arange(around), (np.arange(around) + 1) % around, (count - 1) * around
    low = np.stack([np.full(around, count * around), after, k], axis=1)
    high = np.stack([np.full(around, count * around + 1), last + k, last + after], axis=1)
    vertices, triangles = outward(vertices, np.concatenate([_grid(count, around), low, high]))
    if is_open_below:
        triangles = triangles[(triangles != count * around).all(axis=1)]
    return vertices, triangles


def _grid(rows, around, is_round=False):
    """Triangles between rows of closed rings; `is_round`: the last row is joined to the first."""
    i = np.arange(rows if is_round else rows - 1)[:, None] * around
    j = (np.arange(rows if is_round else rows - 1)[:, None] + 1) % rows * around
    k, after = np.arange(around), (np.arange(around) + 1) % around
    corners = (i + k, i + after, j + after, j + k)
    a, b, c, d = (x.ravel() for x in np.broadcast_arrays(*corners))
    return np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def _oval(half_x, half_y, power, count):
    """A superellipse about z (count, 3)."""
    turn = _turns(count)
    x, y = _power(np.cos(turn), 2.0 / power), _power(np.sin(turn), 2.0 / power)
    return np.stack([half_x * x, half_y * y, np.zeros(count)], axis=1)


def _power(values, exponent):
    return np.sign(values) * np.abs(values) ** exponent


def _turns(count):
    return 2.0 * np.pi * (np.arange(count) + 0.5) / count


def _moved(mesh, way):
    return mesh[0] + np.asarray(way), mesh[1]


def _turned(mesh, angle):
    c, s = np.cos(angle), np.sin(angle)
    return mesh[0] @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]), mesh[1]
