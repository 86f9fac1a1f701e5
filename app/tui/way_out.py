"""The way out on SIGTERM and SIGHUP, also when the terminal takes no more output."""

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final

LIMIT_S: Final = 3.0
"""For the program to end by itself, s."""


@contextmanager
def ends_on_signals(leave: Callable[[int], None]) -> Iterator[None]:
    """End the program on SIGTERM and SIGHUP.

    The handlers are those of the interpreter: the event loop hears of no signal while it waits for a terminal to take
    what is drawn, and a terminal that is gone or stands still never does.

    Args:
        leave: called with the signal's number; when the process has not ended some seconds later it is ended.
    """

    def heard(number: int, _frame: FrameType | None) -> None:
        watchdog = threading.Timer(LIMIT_S, os._exit, (128 + number,))
        watchdog.daemon = True
        watchdog.start()
        leave(number)

    before = {number: signal.signal(number, heard) for number in (signal.SIGTERM, signal.SIGHUP)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
