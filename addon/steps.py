"""A computation in steps: a generator that reads and writes the scene, and yields what any thread may compute.

Each thing yielded is `work(cancel, progress)`; its value is sent back. What the generator returns is the outcome.
Knows nothing of threads and buttons.
"""


def at_once(steps):
    """Run `steps` from start to end in this thread. Returns their outcome; raises what they raise."""
    try:
        work = next(steps)
        while True:
            work = hand_back(steps, work)
    except StopIteration as end:
        return end.value


def hand_back(steps, work):
    """Compute `work` here and give its value, or its error, to `steps`. Returns the next work.

    Raises `StopIteration` with the outcome when there is none.
    """
    try:
        value = work(None, None)
    except BaseException as error:
        return steps.throw(error)
    return steps.send(value)
