"""Chains of bones that carry skin, and the bones from which several of them fan out. Knows nothing of Blender."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

LEAST_CHAIN = 2
"""Bones of a digit at least; shorter side branches are twist, roll, bulge or leaf bones."""


@dataclass(frozen=True)
class Skeleton:
    """Bones at rest: names, parents (b) with -1 for none, heads (b, 3) in one space of any unit and any axes.

    `skin` (b): sum of the chosen mesh's vertex weights per bone; bones of weight 0 are passed over. Parents may
    stand in any order.
    """

    names: tuple
    parents: np.ndarray
    heads: np.ndarray
    skin: np.ndarray

    @cached_property
    def children(self):
        """Children of each bone, in the order of the bones."""
        out = [[] for _ in self.names]
        for bone, parent in enumerate(self.parents):
            if parent >= 0:
                out[parent].append(bone)
        return out

    @cached_property
    def order(self):
        """Bones, parents before children."""
        out = [bone for bone, parent in enumerate(self.parents) if parent < 0]
        for bone in out:
            out.extend(self.children[bone])
        return out


@dataclass(frozen=True)
class Chain:
    """One digit: its bones from the root of the fan on, and the bones above that it shares with other digits."""

    bones: tuple
    stem: tuple = ()


def fans(skeleton):
    """Root bone -> chains, for every bone below which 3 to 6 chains of skin-carrying bones separate."""
    below = {}
    twins = _twins(skeleton)
    out = {}
    for bone in reversed(skeleton.order):
        own = _own(skeleton, bone, twins)
        parts = [chain for child in skeleton.children[bone] if child != twins.get(bone) for chain in below[child]]
        long = [chain for chain in parts if len(chain.bones) >= LEAST_CHAIN]
        if len(long) > 1:
            shared = () if own is None else (own,)
            below[bone] = [Chain(chain.bones, shared + chain.stem) for chain in long]
            if 3 <= len(long) <= 6:
                out[bone] = long
        else:
            best = max(parts, key=lambda chain: (len(chain.bones), _length(skeleton, bone, chain)), default=Chain(()))
            head = () if own is None else (own,)
            below[bone] = [Chain(head + best.bones)] if not best.stem else [Chain(best.bones, head + best.stem)]
            below[bone] = [chain for chain in below[bone] if chain.bones]
    return out


def _own(skeleton, bone, twins):
    if skeleton.skin[bone] > 0.0:
        return bone
    return twins.get(bone)


def _twins(skeleton):
    """Control bone without skin -> the skin bone of the same place that hangs on it and carries nothing else."""
    size = np.ptp(skeleton.heads, axis=0).max(initial=0.0)
    out = {}
    for bone, children in enumerate(skeleton.children):
        if skeleton.skin[bone] > 0.0:
            continue
        for child in children:
            is_leaf = not any(skeleton.skin[below] > 0.0 for below in skeleton.children[child])
            apart = np.linalg.norm(skeleton.heads[child] - skeleton.heads[bone])
            if skeleton.skin[child] > 0.0 and is_leaf and apart <= 1e-4 * size and len(children) > 1:
                out[bone] = child
    return out


def _length(skeleton, bone, chain):
    """Way from `bone` along the chain."""
    heads = skeleton.heads[[bone, *chain.bones]]
    return float(np.linalg.norm(np.diff(heads, axis=0), axis=1).sum())
