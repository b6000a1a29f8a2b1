"""Joints of a standing body with its hands, as published proportions give them; nothing here is Thenar's.

Hands: Buchholz, Armstrong & Goldstein 1992 (segment lengths and base places in hand length and breadth), rest bends
as An & Cooney's splay and a slight cascade. Body: a man of 1.75 m by Drillis & Contini's shares. In mm, Z up, facing
-Y, arms spread; the right hand is at -X.
"""

import numpy as np

LENGTH, BREADTH = 189.0, 84.0
DIGITS = ("thumb", "index", "middle", "ring", "little")
# Splay to the thumb's side, degrees; knuckle: radial in breadths, distal in lengths; phalanges in lengths.
_FINGERS = {
    "index": (7.0, 0.251, 0.447, (0.245, 0.143, 0.097)),
    "middle": (0.0, 0.0, 0.446, (0.266, 0.170, 0.108)),
    "ring": (-6.0, -0.206, 0.409, (0.244, 0.165, 0.107)),
    "little": (-14.0, -0.402, 0.368, (0.204, 0.117, 0.093)),
}
_BASES = {"index": 0.126, "middle": 0.0, "ring": -0.129, "little": -0.223}
_THUMB = ((0.196, 0.073), (0.251, 0.196, 0.158))
_BENDS = (10.0, 15.0, 8.0)


def hand_points(bend=1.0):
    """(digit, k) -> place (3,) of a right hand: radial, distal, palmar from the wrist; k 0 metacarpal, 1..3, 4 tip.

    The thumb has 1..3 and 4. `bend` scales the cascade; 0 is a flat hand.
    """
    out = {}
    for digit, (splay, radial, distal, lengths) in _FINGERS.items():
        place = np.array([radial * BREADTH, distal * LENGTH, 0.0])
        out[digit, 0] = np.array([_BASES[digit] * BREADTH, 0.07 * LENGTH, 0.0])
        out[digit, 1] = place
        pitch = 0.0
        for k, (length, turn) in enumerate(zip(lengths, _BENDS, strict=True)):
            pitch += np.radians(turn * bend)
            yaw = np.radians(splay)
            step = np.array([np.sin(yaw) * np.cos(pitch), np.cos(yaw) * np.cos(pitch), np.sin(pitch)])
            place = place + step * length * LENGTH
            out[digit, k + 2] = place
    (radial, distal), lengths = _THUMB
    place = np.array([radial * BREADTH, distal * LENGTH, 5.0])
    out["thumb", 1] = place
    for k, length in enumerate(lengths):
        step = np.array([0.62, 0.66, 0.43]) + k * np.array([-0.1, 0.15, 0.05])
        place = place + step / np.linalg.norm(step) * length * LENGTH
        out["thumb", k + 2] = place
    return out


class Builder:
    """Bones one by one; `rows` holds name, parent, place (3,), whether it carries skin."""

    def __init__(self):
        self.rows = []

    def add(self, name, parent, place, has_skin=True):
        """One bone; its parent must be there, or be None."""
        assert parent is None or any(row[0] == parent for row in self.rows), parent
        assert all(row[0] != name for row in self.rows), name
        self.rows.append((name, parent, np.asarray(place, float), has_skin))
        return name

    def chain(self, parent, *bones):
        """Bones one below the other: `(name, place)` pairs. Returns the last name."""
        for name, place in bones:
            parent = self.add(name, parent, place)
        return parent


def sides():
    """`(side, sign)`: the right one has its arm at -X."""
    return (("right", -1.0), ("left", 1.0))


def place_hand(sign, point, wrist_x=700.0):
    """Hand coordinates to the body: fingers outwards, palm down, thumb forward."""
    radial, distal, palmar = point
    return np.array([sign * (wrist_x + distal), -radial, 1420.0 - palmar])


def arm(sign):
    """Places of clavicle, upper arm, elbow, half of the forearm, wrist."""
    return [np.array([sign * x, 0.0, 1420.0]) for x in (30.0, 180.0, 450.0, 575.0, 700.0)]


def leg(sign):
    """Places of hip, knee, ankle, ball."""
    x = sign * 95.0
    return [np.array(p) for p in ((x, 0, 930.0), (x, -10, 500.0), (x, 10, 85.0), (x, -130, 25.0))]


def toe(sign, number, k):
    """Place of the k-th (from 1) bone of a toe, 0 the big one; ends come after bone 3 (2 for the big toe)."""
    start = np.array([sign * (70.0 + 14.0 * number), -165.0 + 9.0 * number, 15.0])
    lengths = ((36.0, 26.0, 20.0) if number == 0 else (28.0 - 2 * number, 16.0 - number, 11.0))[: k - 1]
    return start + np.array([0.0, -sum(lengths), -2.0 * len(lengths)])
