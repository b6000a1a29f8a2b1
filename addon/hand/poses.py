"""The pose library: anatomical joint angles in degrees, for any rig whose bones have roles.

Knows nothing of Blender. Flexion as (MCP, PIP, DIP) per finger; abduction towards the thumb; thumb angles by joint.
"""

from ..hand_bones.roles import FINGERS


def _fingers(*rows):
    """Role -> angles from one row (abduction, MCP, PIP, DIP) per finger, index to little."""
    out = {}
    for finger, (abduction, mcp, pip, dip) in zip(FINGERS, rows, strict=True):
        out[f"{finger}_proximal"] = {"flexion": mcp, "abduction": abduction}
        out[f"{finger}_middle"] = {"flexion": pip}
        out[f"{finger}_distal"] = {"flexion": dip}
    return out


def _thumb(cmc, mp, ip):
    """Role -> angles of the thumb: `cmc` is (flexion, abduction, twist) from rest, `mp` and `ip` flexion."""
    return {
        "thumb_metacarpal": dict(zip(("flexion", "abduction", "twist"), cmc, strict=True)),
        "thumb_proximal": {"flexion": mp},
        "thumb_distal": {"flexion": ip},
    }


def _cup(ring, little):
    """Role -> angles of the two metacarpals that let the palm cup."""
    return {"ring_metacarpal": {"flexion": ring}, "little_metacarpal": {"flexion": little}}


POSES = {
    "flat": {
        **_fingers((0, 0, 0, 0), (0, 0, 0, 0), (0, 0, 0, 0), (0, 0, 0, 0)),
        **_thumb((-10, 0, 0), 0, 0),
    },
    "open": {
        **_fingers((-5, 10, 8, 5), (0, 10, 8, 5), (5, 10, 8, 5), (11, 10, 8, 5)),
        **_thumb((0, 18, -14), 8, 10),
    },
    "relaxed": {
        **_fingers((0, 22, 30, 16), (0, 28, 34, 18), (0, 32, 36, 19), (0, 34, 36, 18)),
        **_thumb((8, 4, -14), 16, 18),
        **_cup(3, 6),
    },
    "power_48": {
        **_fingers((-12, 47, 72, 28), (-3, 43, 68, 36), (2, 41, 64, 37), (8, 40, 54, 26)),
        **_thumb((13, 8, -40), 0, 36),
        **_cup(4, 6),
    },
    "power_60": {
        **_fingers((-10, 40, 63, 25), (-3, 52, 62, 34), (5, 45, 55, 36), (14, 39, 42, 20)),
        **_thumb((6, 14, -40), 2, 28),
        **_cup(4, 5),
    },
    "power_100": {
        **_fingers((-20, 12, 36, 21), (-9, 36, 40, 36), (-7, 32, 43, 34), (0, 30, 34, 18)),
        **_thumb((-8, 18, -40), -9, 31),
        **_cup(10, 17),
    },
    "pinch": {
        **_fingers((2, 64, 36, 18), (0, 36, 38, 20), (0, 38, 40, 22), (0, 40, 40, 22)),
        **_thumb((20, 4, -39), 4, -10),
        **_cup(4, 8),
    },
    "precision": {
        **_fingers((-4, 60, 28, 16), (2, 55, 42, 22), (2, 50, 48, 24), (4, 48, 48, 24)),
        **_thumb((36, -6, -40), -7, -12),
        **_cup(6, 12),
    },
    "fingertip_press": {
        **_fingers((0, 28, 18, 3), (0, 6, 26, 14), (0, 8, 32, 16), (0, 12, 34, 16)),
        **_thumb((8, 4, 6), 14, 16),
        **_cup(2, 4),
    },
    "palm_press": {
        **_fingers((8, -8, 6, 3), (0, -8, 6, 3), (-4, -8, 6, 3), (-10, -8, 6, 3)),
        **_thumb((-16, -16, -6), -4, 0),
    },
}
"""Name -> role -> {angle: anatomical degrees}. The power grasps are near what *Grasp* finds on 48, 60, 100 mm
thick cylinders with a median hand, with less bent knuckles on 48 mm: starting points, to be fitted to a product.
In a pinch the thumb's pad faces the index finger's; a precision grip waits for an object about 10 mm thick."""

LABELS = {
    "flat": "Flat",
    "open": "Open",
    "relaxed": "Relaxed",
    "power_48": "Power grasp, 48 mm",
    "power_60": "Power grasp, 60 mm",
    "power_100": "Power grasp, 100 mm",
    "pinch": "Pinch",
    "precision": "Precision grip",
    "fingertip_press": "Fingertip press",
    "palm_press": "Palm press",
}

OPEN = {
    **_fingers((-5, 10, 8, 5), (0, 10, 8, 5), (5, 10, 8, 5), (11, 10, 8, 5)),
    **_thumb((0, 18, 12), 8, 10),
}
"""The open hand from which a grasp closes: fingers parallel, as they run together when they flex (index 11, ring 9,
little 19 degrees to the middle finger), the thumb out of the palm and opposite the fingers. The samples of Xie Table 6
were fitted from here, so the thumb keeps the twist outward that the pose *Open* does not have."""

PINCHED = {
    **_fingers((-4, 70, 24, 12), (2, 62, 38, 20), (2, 55, 48, 24), (2, 55, 48, 24)),
    **_thumb((34, -1, -39), -4, -13),
    **_cup(4, 9),
}
SPREAD = {
    **_fingers((-3, 10, 44, 24), (0, 14, 48, 25), (2, 14, 46, 24), (4, 14, 44, 22)),
    **_thumb((-12, 18, -40), 0, 15),
}
"""A pinch begins between these two: pads together and far apart. The thumb pronates in both, and its pad faces those of
index and middle finger within 21 degrees at every width of a median hand."""

LATERAL = {
    **_fingers((0, 60, 67, 32), (0, 66, 71, 36), (2, 68, 73, 38), (4, 68, 73, 38)),
    **_thumb((16, -13, -25), 7, 1),
    **_cup(4, 8),
}
LATERAL_SPREAD = {
    **_fingers((0, 56, 71, 32), (0, 62, 75, 36), (2, 64, 77, 38), (4, 64, 77, 38)),
    **_thumb((-3, -10, -14), 8, 17),
    **_cup(4, 8),
}
"""A grip between thumb and the side of the index finger begins between these two: the middles of the thumb's pad and of
the side of the index finger's middle phalanx 8 and 30 mm apart, each facing the other within 14 degrees (least squares
over the thumb's and the index finger's joints of a median hand, within their limits)."""

HELD_BOTTLE = {
    **_fingers(
        (2.39, 36.62, 58.01, 28.55),
        (5.89, 47.35, 60.01, 39.19),
        (12.03, 40.17, 52.88, 31.92),
        (2.19, 32.73, 46.9, 24.13),
    ),
    **_thumb((8.55, 11.73, -38.18), -9.0, 21.62),
    **_cup(2.4, 0.61),
}
HELD_BOTTLE["thumb_proximal"]["abduction"] = 3.34
HELD_BOTTLE_AT = (-22.92, 79.25, -61.13), (108.859, -70.243, 53.976)
"""A median right hand on `products.bottle`, and where it stands: mm and Euler XYZ degrees in the bottle's space. The
search of *Grasp* found it (light, power), and *Settle* balanced it at 60 N in sum over the skin. Kept as numbers, for
the first sample shall open at once."""
