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


@dataclass(frozen=True)
class Written:
    """A file that a command has written on the way of a cell.

    Attributes:
        command: its name.
        file: that it wrote.
        results: that it was given.
        runs: folders of the runs that it was given.
    """

    command: str
    file: Path
    results: tuple[Path, ...]
    runs: tuple[Path, ...]


HeadlineOf = Callable[[Path], Headline | None]
"""Returns what stands for a run, by its folder, or for a result, by its file; None where nothing does."""


def no_headline(of: object) -> Headline | None:
    """Return nothing: whether a stage holds is left to its run alone."""
    del of
    return None


@dataclass(frozen=True)
class Headlines:
    """Where the figures of finished stages come from.

    Attributes:
        of_run: returns what stands for a run.
        of_result: returns what stands for a result.
        of_written: returns what stands for another file that a command has written.
    """

    of_run: HeadlineOf = no_headline
    of_result: HeadlineOf = no_headline
    of_written: Callable[[Written], Headline | None] = no_headline


NO_HEADLINES = Headlines()
"""Runs and files count by themselves."""
