"""Functions that other processes look up by name."""

import os
import signal
import time
from pathlib import Path

import numpy as np

from catseye.calibration.core.errors import UnidentifiableError


def drawn(seed: np.random.SeedSequence) -> float:
    """Return a number that depends on the seed alone."""
    return float(np.random.default_rng(seed).normal(size=1000).sum())


def fails_at_three(item: int) -> int:
    """Fail at one item, with an error of more than one argument."""
    if item == 3:
        raise UnidentifiableError("three is too many", [["L1"]])
    return item


class TwoPartError(Exception):
    """An error that no pickle brings back."""

    def __init__(self, text: str, number: int) -> None:
        super().__init__(text)
        self.number = number


def fails_untellably(item: int) -> int:
    """Fail with an error that cannot travel."""
    raise TwoPartError("two parts", item)


def killed_at_three(item: int) -> int:
    """End the worker without a word."""
    if item == 3:
        os._exit(9)
    return item


def process_and_threads(_: int) -> tuple[int, str | None]:
    """Return which process this is and how many threads it gives the linear algebra."""
    return os.getpid(), os.environ.get("OMP_NUM_THREADS")


def hears_ctrl_c(_: int) -> bool:
    """Return whether Ctrl-C could interrupt this process."""
    return signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])


def lingering(folder: Path) -> None:
    """Signal that it runs, and take too long."""
    (folder / f"{os.getpid()}.running").touch()
    time.sleep(300.0)


def large(size: int) -> list[float]:
    """Return more than a pipe holds."""
    return [float(i) for i in range(size)]
