"""How the force of a grip is shared by its fingers: in proportion to their strength, as far as balance lets them.

Balance and sum leave it open which finger presses. Knows nothing of Blender.
"""

from dataclasses import dataclass

import numpy as np

STRENGTH = {"index": 0.25, "middle": 0.35, "ring": 0.25, "little": 0.14}
"""What each finger adds to a maximal grip (MacDermid and others, J. Hand Therapy 17 (2004) 364)."""

WEIGHT_MM = 24.0
"""1 % of the sum of forces on the wrong finger costs as much as 0.24 mm of a pad's depth; 1 % left over of the balance
costs 0.6 mm."""

POWER = 1.6
"""Force of a pad over its depth: between a half-space's 1.5 and a stiffening layer's 2."""

MOST = 1.5
"""Pads of a finger go deeper by no more in one round, and less deep by no more than its inverse."""


@dataclass(frozen=True)
class Sharing:
    """The `finger` (n,) of every vertex, its number in `shares`, or -1; the `shares` (f,) of their sum that fingers
    shall bear."""

    finger: np.ndarray
    shares: np.ndarray

    def excess(self, rows, force_n):
        """What each finger bears beyond its share (f,), N, of the forces (k,) of the vertices `rows`."""
        return self._beyond(self._sums(rows, force_n[:, None]))[:, 0]

    def slopes(self, rows, growth):
        """Derivative (f, d) of the same; `growth` (k, d): that of each force."""
        return self._beyond(self._sums(rows, growth))

    def sums(self, force_n):
        """Force of each finger (f,), N, of the forces (n,) of all vertices."""
        return self._sums(np.arange(len(force_n)), force_n[:, None])[:, 0]

    def unevenness(self, force_n):
        """Share of the fingers' force that is on the wrong fingers, 0 to 1, of the forces (n,) of all vertices."""
        borne = self.sums(force_n)
        return 0.5 * float(np.abs(borne / max(borne.sum(), 1e-9) - self.shares).sum())

    def factors(self, pads, force_n):
        """Factors for the depths of pads (p,): a finger that bears less than its share goes deeper, one that bears more
        less deep, by no more than `MOST`; all stay where no finger bears anything."""
        borne = self.sums(force_n)
        if borne.sum() <= 0.0:
            return np.ones(len(pads))
        ratio = self.shares * borne.sum() / np.maximum(borne, 1e-3 * max(float(force_n.sum()), 1e-9))
        own = np.append(np.clip(ratio ** (1.0 / POWER), 1.0 / MOST, MOST), 1.0)
        return own[[self.finger[pad.rows[0]] for pad in pads]]

    def _sums(self, rows, values):
        finger = self.finger[rows]
        out = np.zeros((len(self.shares), values.shape[1]))
        np.add.at(out, finger[finger >= 0], values[finger >= 0])
        return out

    def _beyond(self, sums):
        return sums - self.shares[:, None] * sums.sum(axis=0)


def sharing_of(pads, takes_part, count):
    """The `Sharing` of a hand of `count` vertices among the fingers of the `pads` that `takes_part` (p,); None for
    fewer than two."""
    fingers = ["palm" if pad.kind == "palm" else pad.role.partition("_")[0] for pad in pads]
    taking = {name for name, takes in zip(fingers, takes_part, strict=True) if takes}
    used = [name for name in STRENGTH if name in taking]
    if len(used) < 2:
        return None
    finger = np.full(count, -1)
    for pad, name in zip(pads, fingers, strict=True):
        if name in used:
            finger[pad.rows] = used.index(name)
    strength = np.array([STRENGTH[name] for name in used])
    return Sharing(finger, strength / strength.sum())
