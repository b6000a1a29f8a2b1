"""Brings a fitted grasp to a wanted total force: pad depths are scaled until the pressed skin carries it."""

from dataclasses import replace

import numpy as np

from .. import workflow
from ..grasp_fit import fitter
from ..hand.skinning import pose_matrices, skin

TOLERANCE = 0.02
"""A force within this share of the target counts as reached."""
ROUNDS = 6
BISECTIONS = 14
LARGEST_STEP = 1.12
"""Depths change by no more a round: fingers sent far in one step fold into the product and the force leaps."""
SCALES = (0.2, 2.0)
"""Pad depths are scaled between these at most; beyond, the target is not a matter of depth."""


def contact_of(fit, found, cancel=None):
    """The pressed contact of a grasp without a force target; `cancel` ends the press. Raises `Refusal`."""
    rig = fit.hand.rig.moved(found.place)
    read = fit.press.reading
    posed = skin(rig, pose_matrices(rig, found.angles)) - read.hand.origin_mm
    press = replace(fit.press, force_n=None, reading=replace(read, hand=replace(read.hand, posed_mm=posed)))
    return workflow.compute(press, cancel)


def force_of(fit, found, cancel=None):
    """Total compressive force of a grasp, N: the sum over the skin, as a mat reads it; `cancel` ends the press."""
    return float(np.asarray(contact_of(fit, found, cancel).force_n).sum())


def reach(fit, first, watch=fitter.ALONE):
    """The grasp whose total force is `fit.force_n`.

    The pads' target depths are scaled and the grasp fitted again until one carries too little and one too much. On the
    way from the one to the other, joint by joint, force has no leaps: it is bisected. Returns the nearest grasp
    found, with a warning if the force is not within `TOLERANCE`.
    """
    tried = [(force_of(fit, first, watch.cancel), first)]
    scale = 1.0
    for count in range(ROUNDS):
        force, found = tried[-1]
        if _is_bracketed(tried, fit.force_n) or _miss(tried, fit.force_n) <= TOLERANCE or watch.cancelled():
            break
        watch.report(f"Force {force:.0f} N", 0.6 + 0.04 * count)
        step = (fit.force_n / max(force, 1e-3 * fit.force_n)) ** (1.0 / 1.5)
        scale = float(np.clip(scale * np.clip(step, 1.0 / LARGEST_STEP, LARGEST_STEP), *SCALES))
        targets = {kind: scale * value for kind, value in fit.wish.targets_mm.items()}
        found = fitter.refit(fit.hand, found, replace(fit.wish, targets_mm=targets), watch)
        tried.append((force_of(fit, found, watch.cancel), found))
    if _is_bracketed(tried, fit.force_n):
        low = max((entry for entry in tried if entry[0] < fit.force_n), key=lambda entry: entry[0])[1]
        high = min((entry for entry in tried if entry[0] >= fit.force_n), key=lambda entry: entry[0])[1]
        for count in range(BISECTIONS):
            if _miss(tried, fit.force_n) <= TOLERANCE or watch.cancelled():
                break
            watch.report("Force between two grasps", 0.85 + 0.01 * count)
            middle = _between(low, high)
            tried.append((force_of(fit, middle, watch.cancel), middle))
            low, high = (middle, high) if tried[-1][0] < fit.force_n else (low, middle)
    force, found = min(tried, key=lambda entry: abs(entry[0] - fit.force_n))
    warnings = found.warnings
    if _miss(tried, fit.force_n) > TOLERANCE:
        warnings = (*warnings, f"the force reached is {force:.0f} N, wanted {fit.force_n:.0f} N")
    return replace(found, force_n=force, warnings=warnings)


def _is_bracketed(tried, wanted):
    return any(force < wanted for force, _ in tried) and any(force >= wanted for force, _ in tried)


def _miss(tried, wanted):
    """Smallest difference from the wanted force, relative."""
    return min(abs(force - wanted) for force, _ in tried) / wanted


def _between(low, high):
    """The grasp half-way between two, joint by joint; its place by the rotation nearest to the mean of theirs."""
    place = 0.5 * (low.place + high.place)
    left, _, right = np.linalg.svd(place[:3, :3])
    place[:3, :3] = left @ right
    depths = {name: 0.5 * (depth + high.depths_mm[name]) for name, depth in low.depths_mm.items()}
    return replace(low, angles=0.5 * (low.angles + high.angles), place=place, depths_mm=depths)
