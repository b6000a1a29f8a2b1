"""Rigid motion of a surface between two moments: turn and shift, and how far it is from being one."""

import numpy as np

from .units import Floats


def motion(before: Floats, after: Floats) -> tuple[Floats, float]:
    """The rigid motion (4, 4) that takes points `before` (n, 3) to `after`, and the largest distance it leaves, mm.

    Least squares (Kabsch 1976): the turn comes from the singular vectors of the points' covariance.
    """
    start, end = before.mean(axis=0), after.mean(axis=0)
    left, _, right = np.linalg.svd((before - start).T @ (after - end))
    mirror = np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right)) or 1.0])
    turn = (left @ mirror @ right).T
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = turn, end - turn @ start
    return whole, float(np.linalg.norm(moved(before, whole) - after, axis=1).max(initial=0.0))


def moved(points: Floats, whole: Floats) -> Floats:
    """Points (n, 3) taken along by a motion (4, 4)."""
    taken: Floats = points @ whole[:3, :3].T + whole[:3, 3]
    return taken


def seen(points: Floats, whole: Floats) -> Floats:
    """Points (n, 3) as something that was moved by `whole` (4, 4) sees them."""
    own: Floats = (points - whole[:3, 3]) @ whole[:3, :3]
    return own
