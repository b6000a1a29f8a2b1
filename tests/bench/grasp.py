"""A hand that grasps a handle: the generated hand, each finger joint closed until its pad is sunk in."""

from dataclasses import dataclass

import numpy as np
import thenar
from bench.peers import problems
from proof import meshes

RADIUS_MM = 24.0
OVERLAP_MM = 3.5
FINGERS = ("index", "middle", "ring", "little")
MOST_FLEXION_DEG = 85.0
AXIS_Y_MM = 82.0  # the handle lies across the heads of the metacarpals
HANDLE_END_MM = 38.0  # short of the thumb


@dataclass
class Hand:
    """A hand to press: rest and posed positions, regions and materials, and the handle it holds."""

    rest: np.ndarray
    posed: np.ndarray
    triangles: np.ndarray
    regions: np.ndarray
    materials: list
    handle: tuple


def grasping():
    """The generated hand around a handle of 48 mm, palm and fingers sunk in by `OVERLAP_MM` each."""
    made = thenar.hand()
    axis = handle_axis(made)
    posed = curled(made, close(made, axis))
    return Hand(made["vertices_mm"], posed, made["triangles"], made["regions"], materials(made), handle_about(axis))


def handle_axis(made):
    """(y, z) of the handle's axis, which runs along x, where it is sunk into the palm by `OVERLAP_MM`."""
    palm = made["vertices_mm"][_on(made, ("distal_palm", "palm_hollow"))]
    low, high = 0.0, 100.0
    for _ in range(40):
        axis = np.array([AXIS_Y_MM, (low + high) / 2.0])
        low, high = (low, axis[1]) if _overlap(palm, axis) < OVERLAP_MM else (axis[1], high)
    return axis


def handle_about(axis):
    """The handle about that axis."""
    vertices, triangles = problems.handle()
    across = np.stack([vertices[:, 1], -vertices[:, 0], vertices[:, 2]], axis=1)
    return across + np.array([HANDLE_END_MM - vertices[:, 1].max(), *axis]), triangles


def materials(made):
    """The presets for the layer model, each region as thick as the hand says."""
    each = zip(made["kind"], made["thickness_mm"], strict=True)
    preset = {"finger": thenar.Material.finger_layer(), "palm": thenar.Material.palm_layer()}
    return [preset[kind].replace(thickness_mm=float(thickness)) for kind, thickness in each]


def _on(made, names):
    """Vertices in regions whose name starts with one of `names`."""
    is_named = np.array([name.startswith(names) for name in made["region_names"]])
    return (made["regions"] >= 0) & is_named[made["regions"]]


def _overlap(points, axis):
    return RADIUS_MM - np.hypot(*(points[:, 1:] - axis).T).min()


def close(made, axis):
    """Flexion of every finger joint (rad), base first, that sinks its pad into the handle by `OVERLAP_MM`."""
    flexion = {}
    for bone in (f"{finger}_{phalanx}" for finger in FINGERS for phalanx in ("proximal", "middle", "distal")):
        pad = _on(made, (f"{bone}_pad",))
        for angle in np.radians(np.arange(0.0, MOST_FLEXION_DEG, 1.0)):
            flexion[bone] = angle
            if _overlap(curled(made, flexion)[pad], axis) >= OVERLAP_MM:
                break
    return flexion


def curled(made, flexion):
    """The hand's vertices with the joints at the heads of the bones flexed by `flexion` (rad), linear blend."""
    place = {None: (np.eye(3), np.zeros(3))}
    posed = np.zeros_like(made["vertices_mm"])
    for bone, weight in zip(made["bones"], made["weights"].T, strict=True):
        turn, shift = place[bone["parent"]]
        local, head = meshes.rotation(bone["flexion_axis"], flexion.get(bone["name"], 0.0)), np.asarray(bone["head_mm"])
        turn, shift = turn @ local, turn @ (head - local @ head) + shift
        place[bone["name"]] = turn, shift
        posed += weight[:, None] * (made["vertices_mm"] @ turn.T + shift)
    return posed
