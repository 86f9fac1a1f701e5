"""How far a command is, from the lines that it really says."""

import itertools

import pytest

from catseye.app.cli.progress import ProgressBar
from catseye.app.tui.command_progress import CommandProgress, ProgressReader, progress_of


def test_line_of_the_program_is_understood(capsys: pytest.CaptureFixture[str]) -> None:
    """A bar whose clock goes on by 30 s at each look: at a quarter of the way three times as long is left."""
    clock = itertools.count(0.0, 30.0)
    bar = ProgressBar("Monte Carlo", lambda: next(clock))
    bar.update(2500, 10000, "2500 of 10000 draws")
    said = capsys.readouterr().err
    assert progress_of(said) == CommandProgress(0.25, 90.0, "2500 of 10000 draws")


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("diagnose   5%  0 s gone, ? left  harmonics", CommandProgress(0.05, None, "harmonics")),
        ("x 100%  1 h 02 min gone, 0 s left  done", CommandProgress(1.0, 0.0, "done")),
        ("x  50%  2 h 00 min gone, 2 h 01 min left", CommandProgress(0.5, 7260.0, "")),
        ("warning: run is stopped; 50% of it is there", None),
        ("", None),
    ],
)
def test_lines(line: str, expected: CommandProgress | None) -> None:
    assert progress_of(line) == expected


def test_pieces_are_put_together_and_the_last_line_counts() -> None:
    reader = ProgressReader()
    assert reader.take("a warning\nx  10%  1 s go") is None
    assert reader.take("ne, 9 s left  one\nx  20%  2 s gone, 8 s left  two\nx  3") == CommandProgress(
        0.2, 8.0, "two"
    )
    assert reader.take("0%  3 s gone, 7 s left  three\r") == CommandProgress(0.3, 7.0, "three")
