"""Ctrl-C and SIGTERM end a batch in order: tables are written, workers are ended, no traceback."""

import signal
import threading
from contextlib import contextmanager

_SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name)]


class Stopped(Exception):
    """The batch was stopped from outside; `code` is what a shell expects of a process that this signal ended."""

    def __init__(self, text, code):
        super().__init__(text)
        self.code = code


class Signalled(BaseException):
    """Raised where the batch is when the signal comes; `number` is the signal's."""

    def __init__(self, number):
        super().__init__(signal.Signals(number).name)
        self.number = number


@contextmanager
def by_signals():
    """Within, the first signal raises `Signalled`; later ones are ignored, so that the end is reached."""
    if threading.current_thread() is not threading.main_thread():  # signals come to the main thread alone
        yield
        return
    seen = []

    def take(number, _frame):
        if not seen:
            seen.append(number)
            raise Signalled(number)

    before = {number: signal.signal(number, take) for number in _SIGNALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)
