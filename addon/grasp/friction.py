"""How much friction a held product needs: the least coefficient with which the skin's tangential forces carry what the
normal forces leave over. Knows nothing of Blender.
"""

import numpy as np

STEPS = 60
"""Passes of Lawson's method; the coefficient found is always sufficient, and falls toward the least."""

LEAST_WEIGHT = 1e-4
"""No point's weight falls below this share of the mean: the system would be singular."""

NOTHING = 0.02
"""So small a share of the forces counts as nothing left over: a grasp that is in balance to it is in balance."""

EASE_STEPS = 20
HALVES = 0.5 ** np.arange(8)

LEAST_SHARE = 1e-4
"""Vertices that carry less of the sum are left out."""


EASE = 0.2
"""Fingers press so much harder or softer than they were fitted before they need friction."""

RELUCTANCE = 0.003
"""Weight of the changes against what is left over, in parts of what the forces reach with ease: no force changes much
for what it can hardly help."""


def eased(points, push, net, moment):
    """Net force (3), N, and moment (3), N mm, that stay when each of the forces `push` changes by up to `EASE` of it so
    that less is left over, less `NOTHING`; arguments as of `needed`.

    Bounded least squares in its six dual unknowns by Newton's method, for each force a column.
    """
    size = np.linalg.norm(push, axis=1)
    used = size > LEAST_SHARE * size.sum()
    points, push, size = points[used], push[used], size[used]
    if len(size) == 0:
        return net, moment
    arm = max(float(np.linalg.norm(points - points.mean(axis=0), axis=1).mean()), 1.0)
    maps = np.concatenate([push, np.cross(points, push) / arm], axis=1).T / size.sum()
    wrench = np.concatenate([net, moment / arm]) / size.sum()
    weight = RELUCTANCE * float(np.linalg.eigvalsh(maps @ maps.T)[-1])
    left = wrench
    for _ in range(EASE_STEPS):
        change = np.clip(-(left @ maps) / weight, -EASE, EASE)
        miss = left - wrench - maps @ change
        free = maps[:, np.abs(change) < EASE]
        step = np.linalg.solve(np.eye(6) + free @ free.T / weight, -miss)
        for share in HALVES:
            trial = left + share * step
            if np.linalg.norm(trial - wrench - maps @ np.clip(-(trial @ maps) / weight, -EASE, EASE)) < np.linalg.norm(
                miss
            ):
                break
        left = trial
    left = wrench + maps @ np.clip(-(left @ maps) / weight, -EASE, EASE)
    left = left * size.sum() * max(0.0, 1.0 - NOTHING / max(float(np.linalg.norm(left)), 1e-12))
    return left[:3], arm * left[3:]


def needed(points, push, net, moment):
    """The coefficient of friction that suffices to balance a net force and moment, or infinity if none does.

    `points` (k, 3) mm from the place that the moment is about, `push` (k, 3) normal forces on the product there, N;
    `net` (3) N and `moment` (3) N mm, of these and of all else that acts. Coulomb's cone at every point, any direction
    of the tangential force; the least greatest ratio by Lawson's method (Lawson 1961; Rice and Usow 1968).
    """
    size = np.linalg.norm(push, axis=1)
    used = size > LEAST_SHARE * size.sum()
    points, push, size = points[used], push[used], size[used]
    if len(size) == 0:
        return np.inf
    normal = push / size[:, None]
    arm = max(float(np.linalg.norm(points - points.mean(axis=0), axis=1).mean()), 1.0)
    wrench = -np.concatenate([net, moment / arm])
    if np.linalg.norm(wrench) < 1e-9 * size.sum():
        return 0.0
    tangent = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    spin = np.zeros((len(size), 3, 3))
    x, y, z = (points / arm).T
    spin[:, 0, 1], spin[:, 0, 2], spin[:, 1, 2] = -z, y, -x
    spin[:, 1, 0], spin[:, 2, 0], spin[:, 2, 1] = z, -y, x
    maps = np.concatenate([tangent, spin @ tangent], axis=1)
    weights, best = np.full(len(size), 1.0 / len(size)), np.inf
    for _ in range(STEPS):
        ease = size / np.maximum(weights, LEAST_WEIGHT / len(size))
        total = np.einsum("k,kij,klj->il", ease, maps, maps)
        share, *_ = np.linalg.lstsq(total, wrench, rcond=1e-9)
        if np.linalg.norm(total @ share - wrench) > 1e-6 * np.linalg.norm(wrench):
            break
        drag = ease[:, None] * np.einsum("kij,i->kj", maps, share)
        ratio = np.linalg.norm(drag, axis=1) / size
        best = min(best, float(ratio.max()))
        weights = weights * ratio
        weights = weights / weights.sum()
    return best
