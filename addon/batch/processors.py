"""A processor of its own for each worker process of a machine (on Linux), from those that `PROCESSORS` tells.

Blender and the library hand work from thread to thread; between processors each time costs more than it gains.
"""

import os
import re
import tempfile
from contextlib import suppress
from pathlib import Path

from .child import PROCESSORS

SHARED = 0.6
"""Below this part of a processor over `LOOKED_AT_S` of solving, another program keeps to the same one."""
LOOKED_AT_S = 2.0
"""Seconds of solving over which that is judged."""


class Own:
    """This process on a processor that no other worker has claimed, or on all where none is left."""

    def __init__(self):
        self._allowed = [int(number) for number in os.environ.pop(PROCESSORS, "").split(",") if number]
        self._claim, self._span_s, self._used_s = None, 0.0, 0.0
        for number in sorted(self._allowed, key=_is_second):
            claim = _claimed(number)
            if claim is None:
                continue
            self._claim = claim
            _allow({number})
            return
        self.leave()

    def leave(self):
        """Take all processors again."""
        if self._claim is not None:
            self._claim.close()
            self._claim = None
        if self._allowed:
            _allow(self._allowed)

    def took(self, span_s, used_s):
        """Tell of a case: seconds, and those of a processor. Leaves one that others use: containers see no claims."""
        self._span_s, self._used_s = self._span_s + span_s, self._used_s + used_s
        if self._claim is None or self._span_s < LOOKED_AT_S:
            return
        if self._used_s < SHARED * self._span_s:
            self.leave()
        self._span_s = self._used_s = 0.0


def _claimed(number):
    """A file that is locked as long as it is open and this process lives; None where another worker has it."""
    import fcntl

    try:
        claim = (Path(tempfile.gettempdir()) / f"thenar-processor-{number}").open("a")
    except OSError:  # it is another user's
        return None
    try:
        fcntl.flock(claim, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        claim.close()
        return None
    return claim


def _is_second(number):
    """Whether a processor is the second thread of a core, which is taken after all the first."""
    try:
        with open(f"/sys/devices/system/cpu/cpu{number}/topology/thread_siblings_list") as told:
            return int(re.match(r"\d+", told.read())[0]) != number
    except (OSError, TypeError):
        return False


def _allow(processors):
    for thread in os.listdir("/proc/self/task"):
        with suppress(OSError):  # one that has just ended
            os.sched_setaffinity(int(thread), processors)
