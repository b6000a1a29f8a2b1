"""A computation in steps: a generator that reads and writes the scene, and yields what any thread may compute.

Each thing yielded is `work(cancel, progress)`, whose value is sent back, or `PAUSE`, where the window may have a turn:
no stretch between two of them should last longer than a fifth of a second. What the generator returns is the outcome.
Knows nothing of threads and buttons.
"""

from collections.abc import Callable, Generator
from typing import Any, Protocol, TypeAlias, TypeVar, cast


class Cancel(Protocol):
    """Asked between pieces of work whether to stop."""

    def is_set(self) -> bool:
        """Whether to stop."""


T = TypeVar("T")
Progress: TypeAlias = Callable[[str, float], object]
Work: TypeAlias = Callable[[Cancel | None, Progress | None], Any] | None
Steps: TypeAlias = Generator[Work, Any, T]

PAUSE = None
"""Yielded where the scene is whole enough to be drawn, and nothing is to be computed."""


def at_once(steps: Steps[T]) -> T:
    """Run `steps` from start to end in this thread. Returns their outcome; raises what they raise."""
    try:
        work = next(steps)
        while True:
            work = hand_back(steps, work)
    except StopIteration as end:
        return cast(T, end.value)


def hand_back(steps: Steps[T], work: Work) -> Work:
    """Compute `work` here and give its value, or its error, to `steps`. Returns the next work.

    Raises `StopIteration` with the outcome when there is none.
    """
    if work is PAUSE:
        return steps.send(None)
    try:
        value = work(None, None)
    except BaseException as error:
        return steps.throw(error)
    return steps.send(value)
