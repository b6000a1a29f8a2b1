"""The fixed part of a split that CI runs: some cases of every kind that the public index tells apart, by hash."""

import hashlib

from trial import cases

MANY = 5  # of pads with all five protocols
SPOTTED = 2  # of each kind of mat
FEW = 1  # of every other kind


def kind(case):
    """What the index tells of a case: pad, mat, how many protocols, how many repeats."""
    about = cases.index()[case]
    return about["pad"], about.get("mat", ""), len(about.get("published", [])), about.get("repeats", 0)


def fixed(split):
    """Names, in their order."""
    groups = {}
    for case in cases.names(split):
        groups.setdefault(kind(case), []).append(case)
    found = []
    for (_, mat, protocols, _), members in groups.items():
        count = SPOTTED if mat else MANY if protocols == 5 else FEW
        found += sorted(members, key=lambda case: hashlib.sha256(case.encode()).hexdigest())[:count]
    return sorted(found)
