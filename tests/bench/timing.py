"""CPU time of calls: median of several, one thread."""

import statistics
import time


def cpu_ms(call, at_least=7, seconds=1.5):
    """Median CPU time of `call()` in ms, all threads of this process together, after one call that is not counted.

    Runs at least `at_least` times, and on until `seconds` of CPU are spent or 200 runs.
    """
    call()
    times = []
    while len(times) < at_least or (sum(times) < seconds and len(times) < 200):
        start = time.process_time_ns()
        call()
        times.append((time.process_time_ns() - start) * 1e-9)
    return statistics.median(times) * 1e3


def once_ms(call):
    """CPU time of one call in ms, and what it returned."""
    start = time.process_time_ns()
    value = call()
    return (time.process_time_ns() - start) * 1e-6, value
