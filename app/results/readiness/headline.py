"""What stands for a finished stage. Who reads runs and results makes them: they are of three systems."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Headline:
    """What stands for a finished stage.

    Attributes:
        text: a figure, in a few words.
        holds: what was wanted is reached.
    """

    text: str
    holds: bool = True


HeadlineOf = Callable[[Path], Headline | None]
"""Returns what stands for a run, by its folder, or for a result, by its file; None where nothing does."""


def no_headline(path: Path) -> Headline | None:
    """Return nothing: whether a stage holds is left to its run alone."""
    del path
    return None
