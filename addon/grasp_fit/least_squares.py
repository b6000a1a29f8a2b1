"""Bounded robust least squares by Levenberg and Marquardt's method, in plain numpy.

Knows nothing of hands. Sources: Marquardt 1963; weights of the soft-L1 loss as in Triggs et al. 2000, section 4.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Problem:
    """`residuals(x)` -> (m,), `jacobian(x)` -> (m, n) at the last x given to `residuals`; bounds (n,) each.

    `robust(values)` (m,) bool marks the residuals whose loss is soft-L1 (linear beyond about `scale`) instead of
    squared; it may look at their sign. `is_narrow`: steps meet bounds all the time and are the best within them;
    otherwise a step is cut off at a bound, which leads to fewer wrong valleys where bounds are far.
    """

    residuals: object
    jacobian: object
    lower: np.ndarray
    upper: np.ndarray
    robust: object
    scale: float = 1.0
    is_narrow: bool = False


@dataclass(frozen=True)
class Solution:
    """Best `x`, its `cost`, how many residual evaluations it took, and whether a step fell below the tolerance."""

    x: np.ndarray
    cost: float
    evaluations: int
    has_converged: bool


def cost_of(values, robust, scale=1.0):
    """Half the squared residuals, soft-L1 beyond `scale` where `robust`."""
    squares = (values / scale) ** 2
    return 0.5 * scale**2 * float(np.where(robust, 2.0 * (np.sqrt(1.0 + squares) - 1.0), squares).sum())


def minimize(problem, start, evaluations=60, tolerance=1e-4, cancelled=None):
    """Minimise from `start`, never leaving the bounds; a variable pushed against a bound is left out of the step.

    Stops at `evaluations`, when the relative gain of a step falls below `tolerance`, or when `cancelled()` is true.
    """
    x = np.clip(start, problem.lower, problem.upper)
    values = problem.residuals(x)
    cost, damping, used = cost_of(values, problem.robust(values), problem.scale), 1e-2, 1
    while used < evaluations and not (cancelled and cancelled()):
        weights = np.where(problem.robust(values), 1.0 / np.sqrt(1.0 + (values / problem.scale) ** 2), 1.0)
        slope = problem.jacobian(x)
        gradient = slope.T @ (weights * values)
        free = ~((x <= problem.lower) & (gradient > 0.0)) & ~((x >= problem.upper) & (gradient < 0.0))
        hessian = (slope[:, free] * weights[:, None]).T @ slope[:, free]
        scale = np.maximum(np.diag(hessian), 1e-9 * max(float(np.diag(hessian).max(initial=0.0)), 1e-12))
        gained = None
        while used < evaluations and damping < 1e8:
            step = np.zeros_like(x)
            matrix = hessian + damping * np.diag(scale)
            if problem.is_narrow:
                room = problem.lower[free] - x[free], problem.upper[free] - x[free]
                step[free] = _within(matrix, gradient[free], room)
            else:
                step[free] = np.linalg.solve(matrix, -gradient[free])
            trial = np.clip(x + step, problem.lower, problem.upper)
            trial_values = problem.residuals(trial)
            trial_cost = cost_of(trial_values, problem.robust(trial_values), problem.scale)
            used += 1
            if trial_cost < cost:
                gained, damping = cost - trial_cost, max(damping / 5.0, 1e-8)
                x, values, cost = trial, trial_values, trial_cost
                break
            damping *= 4.0
        if gained is None or gained < tolerance * cost:
            return Solution(x, cost, used, has_converged=True)
    return Solution(x, cost, used, has_converged=False)


def _within(matrix, gradient, room):
    """The step that minimises gradient s + s matrix s / 2 within `room` (lower, upper), nearly: what would leave it
    stops at its bound and the others step again, as they would with it held there."""
    low, high = room
    step, held = np.zeros_like(gradient), np.zeros(len(gradient), bool)
    while not held.all():
        free = ~held
        right = -gradient[free] - matrix[np.ix_(free, held)] @ step[held]
        step[free] = np.linalg.solve(matrix[np.ix_(free, free)], right)
        beyond = free & ((step < low) | (step > high))
        if not beyond.any():
            break
        step = np.where(beyond, np.clip(step, low, high), step)
        held |= beyond
    return step
