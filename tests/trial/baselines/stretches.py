"""What the refitted base leaves of a study's curves, as one row of numbers: means over stretches of every protocol."""

import numpy as np
from trial import protocols
from trial.baselines.curves import UNIT_MPA

PLAIN, CYCLIC = 11, 14  # stretches of a protocol


def stretches(curves):
    """Features: by protocol the mean residual (share of the largest force) by stretch, repeats together; how repeats
    and halves of the session differ; NaN where a protocol is missing."""
    left = residual(curves)
    rows = []
    for protocol, how in protocols.PROTOCOLS.items():
        here = [k for k, name in enumerate(curves.protocols) if name == protocol]
        count = CYCLIC if how.cycles > 1 else PLAIN
        if not here:
            rows.append(np.full(count + 2, np.nan))
            continue
        many = np.stack([_means(left[k], curves.depth[k], count) for k in here])
        change = np.nanmean(left[here[-1]]) - np.nanmean(left[here[0]]) if len(here) > 1 else np.nan
        rough = np.nanstd(np.diff(left[here], n=2, axis=1)) / np.sqrt(6.0)
        rows.append(np.concatenate([many.mean(axis=0), [change, rough]]))
    whole = [np.sqrt(np.nanmean(left**2)), np.nanmedian(np.abs(left))]
    return np.concatenate([*rows, whole])


def residual(curves):
    """Shares of every recording's largest force, after a linear refit of G0 and Glim to all together."""
    depth = np.maximum(np.nan_to_num(curves.depth), 0.0)
    base = np.stack([one(row) for one, row in zip(curves.base, depth, strict=True)]) / UNIT_MPA / curves.scale()
    there, growth = np.isfinite(curves.force), np.clip(depth / curves.limit, 0.0, 1.0)
    columns = np.stack([base[there], (base * growth)[there]], axis=1)
    seen = (curves.force / curves.scale())[there]
    left = np.full(curves.force.shape, np.nan)
    left[there] = seen - columns @ np.linalg.lstsq(columns, seen, rcond=None)[0]
    return left


def _means(left, depth, count):
    """Means over stretches: ways in and out in parts, the hold in parts, the rest; of cycles each way of each."""
    kept = np.isfinite(left)
    left, depth = left[kept], depth[kept]
    way = np.sign(np.round(np.diff(depth, prepend=depth[0]), 5))
    if count == CYCLIC:
        return _by_ways(left, way, count)
    deep = depth / depth.max()
    load, hold = (way > 0.0) & (deep > 0.0), (way == 0.0) & (deep > 0.5)
    away, rest = (way < 0.0) & (deep > 0.0), deep <= 0.0
    found = [left[load & (deep > low) & (deep <= high)] for low, high in ((0, 0.35), (0.35, 0.7), (0.7, 2))]
    found += np.array_split(left[hold], 4)
    found += [left[away & (deep > low) & (deep <= high)] for low, high in ((0.7, 2), (0.3, 0.7), (0, 0.3))]
    return np.array([one.mean() if len(one) else np.nan for one in (*found, left[rest])])


def _by_ways(left, way, count):
    """Halves of the first seven ways, down and up in turn."""
    edges = np.flatnonzero(np.diff(way) != 0.0) + 1
    parts = [part for part in np.split(left, edges) if len(part) > 3][: count // 2]
    halves = [half.mean() for part in parts for half in np.array_split(part, 2)]
    return np.array(halves + [np.nan] * (count - len(halves)))
