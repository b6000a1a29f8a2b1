"""How a hand was made, kept on its object as text: shape, unit, counts, rest bones and weights.

What differs from it later is the user's own work. Knows nothing of Blender's windows and of the native module.
"""

import json
from dataclasses import asdict, dataclass

import numpy as np

KNUCKLES_PER_BREADTH = 0.653
"""Distance across of the heads of index and little finger's proximal bones, over hand breadth (rust/hand, skeleton)."""
KNUCKLE_PER_LENGTH = 0.446
"""Distance along of the head of the middle finger's proximal bone from the wrist, over hand length."""


@dataclass(frozen=True)
class Built:
    """One hand as it was made.

    `shape`: keywords of `thenar.hand`. `bones`: name -> head, tail and palm side (3 by 3), mm. `weights`: digest of the
    vertex groups of each kind, "bones" and "regions".
    """

    shape: dict
    mm_per_unit: float
    vertices: int
    faces: int
    bones: dict
    weights: dict

    def as_text(self):
        """JSON for the file."""
        return json.dumps(asdict(self))


def from_text(text):
    """The `Built` that `as_text` wrote."""
    return Built(**json.loads(text))


def describe(made, mm_per_unit, weights):
    """The `Built` of a hand made by `build.make`; `weights`: its digests."""
    bones = {}
    for bone in made["bones"]:
        head, tail = np.array(bone["head_mm"], float), np.array(bone["tail_mm"], float)
        along = (tail - head) / np.linalg.norm(tail - head)
        facing = np.cross(bone["flexion_axis"], along)
        bones[bone["name"]] = [head.tolist(), tail.tolist(), (facing / np.linalg.norm(facing)).tolist()]
    counts = len(made["vertices_mm"]), len(made["triangles"])
    return Built(dict(made["shape"]), mm_per_unit, *counts, bones, weights)


def measures_mm(built):
    """Length and breadth of the hand, mm, from its bones."""
    heads = {name: np.array(rows[0]) for name, rows in built.bones.items()}
    across = abs(heads["index_proximal"][0] - heads["little_proximal"][0])
    return float(heads["middle_proximal"][1] / KNUCKLE_PER_LENGTH), float(across / KNUCKLES_PER_BREADTH)


def frames_mm(built):
    """Name -> rig_from_bone (4, 4) at rest, mm, and the bone's length."""
    out = {}
    for name, (head, tail, facing) in built.bones.items():
        along = np.subtract(tail, head)
        length = float(np.linalg.norm(along))
        frame = np.eye(4)
        frame[:3, :3] = np.stack([np.cross(along / length, facing), along / length, facing], axis=1)
        frame[:3, 3] = head
        out[name] = frame, length
    return out
