"""Errors that clients can cause again and again, logged at a bounded rate."""

import logging
from typing import Final

from catseye.drivers.roles.clock import Clock

EVERY_S: Final = 10.0
"""Real s between two lines."""


class SparseLog:
    """Logs an error now and then; those between are counted.

    Args:
        logger: takes what is logged.
        clock: real time.
    """

    def __init__(self, logger: logging.Logger, clock: Clock) -> None:
        self._logger = logger
        self._clock = clock
        self._next_s = clock.monotonic_s()
        self._left_out = 0

    def error(self, text: str, error: BaseException) -> None:
        """Log an error with its traceback, unless another one was logged just before."""
        now_s = self._clock.monotonic_s()
        if now_s < self._next_s:
            self._left_out += 1
            return
        more = f" ({self._left_out} more errors were not logged)" if self._left_out else ""
        self._next_s, self._left_out = now_s + EVERY_S, 0
        self._logger.error("%s%s", text, more, exc_info=error)
