"""Tissue as a bed of springs whose elastic curve is given: force over time with relaxation, lifts and damage.

    Bed(depth_mm, force_n).follow(time_s, tool_depth_mm, terms, damage) -> Followed

A bed of parallel springs, each of which the tool meets at a depth of its own, has any convex curve of force over depth:
its stiffness by depth of meeting is the curve's second difference. Each spring relaxes by a Prony series and cannot
pull; where the tool leaves it, it is free, and creeps back without load. So loading gives the convolution of the
elastic force (Lee and Radok 1960; Fung 1993), and lifts and cycles need no rule of their own. Damage grows in each
spring with the work done on it. Units: mm, N, s.
"""

from dataclasses import dataclass

import numpy as np

FINEST_S = 0.01


@dataclass(frozen=True)
class Followed:
    """At each time: force (N), and the largest depth of meeting at which the tool still touches (mm; 0 where apart)."""

    force_n: np.ndarray
    reach_mm: np.ndarray


class Damage:
    """Of each spring: the share that is lost at last, and the work of how many presses to a depth loses most of it."""

    def __init__(self, share, presses, deepest_mm):
        self.share = share
        self.work = presses * 0.5 * deepest_mm**2  # of a spring of unit stiffness that is met at touch
        self.done = 0.0

    def left(self):
        """Part of each spring's stiffness that is left."""
        return 1.0 - self.share * -np.expm1(-self.done / self.work)

    def grow(self, strain, further):
        """Takes up the work of strains (mm) that grow by `further` where that is above 0."""
        self.done = self.done + self.left() * strain * np.maximum(further, 0.0)


class Bed:
    """Springs of a curve of force (N) at even depths (mm) that begin with 0."""

    def __init__(self, depth_mm, force_n):
        slope = np.diff(force_n) / (depth_mm[1] - depth_mm[0])
        self.meets = depth_mm[:-1]
        self.stiffness = np.maximum(np.diff(np.append(0.0, slope)), 0.0)

    def follow(self, time_s, tool_depth_mm, terms=(), damage=None, slower=None):
        """Forces at times as the tool's depth goes straight between them, from rested springs; `terms`: (share, s).

        `slower(depth)` is a factor of the time constants at a depth of the tool; none is 1.
        """
        shares = np.array([share for share, _ in terms])
        taus = np.array([tau for _, tau in terms])
        strain = np.zeros(len(self.meets))
        branches = np.zeros((len(shares), len(strain)))
        force, reach = [], []
        before = (time_s[0], tool_depth_mm[0])
        for now in zip(time_s, tool_depth_mm, strict=True):
            count = max(1, int(np.ceil((now[0] - before[0]) / FINEST_S))) if len(terms) or damage else 1
            dt = max((now[0] - before[0]) / count, 1e-12)
            middle = slower(0.5 * (before[1] + now[1])) if slower else 1.0
            fade = np.exp(-dt / (taus * middle))
            rise = -shares * np.expm1(-dt / (taus * middle)) * taus * middle / dt
            for part in range(1, count + 1):
                depth = before[1] + (now[1] - before[1]) * part / count
                faded = fade[:, None] * branches
                # The strain at which a spring bears nothing after this step.
                lasting = 1.0 - shares.sum()
                free = (rise.sum() * strain - faded.sum(axis=0)) / (lasting + rise.sum())
                new = np.maximum(depth - self.meets, free)
                branches = faded + rise[:, None] * (new - strain)
                if damage is not None:
                    damage.grow(new, new - strain)
                strain = new
            bears = self.stiffness * (lasting * strain + branches.sum(axis=0))
            if damage is not None:
                bears = bears * damage.left()
            touched = (depth - self.meets >= free) & (depth > self.meets)
            force.append(bears[touched].sum())
            reach.append(self.meets[touched].max(initial=0.0))
            before = now
        return Followed(np.array(force), np.array(reach))


def dragged(slide_mm, normal_n, coefficient, shear_n_per_mm):
    """Force along the slide on the tool (N): skin sheared, up to Coulomb's limit; none with coefficient 0."""
    force = np.zeros(len(slide_mm))
    for k in range(1, len(force)):
        pulled = force[k - 1] - shear_n_per_mm * (slide_mm[k] - slide_mm[k - 1])
        force[k] = np.clip(pulled, -coefficient * normal_n[k], coefficient * normal_n[k])
    return force
