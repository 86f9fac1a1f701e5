"""`catseye resolution` on recordings with moves that were not driven so: refused at their line, or said."""

from pathlib import Path

import numpy as np
import pytest

from catseye.app.results.resolution.result import ResolutionResult, read_resolution
from catseye.calibration.resolution.errors import MovesError
from tests.unit.app.cli.test_resolution import said
from tests.unit.app.results.resolution.recordings import Files, decaying_commands, write_test


def evaluated(tmp_path: Path, files: Files, *more: str) -> ResolutionResult:
    output = tmp_path / "result.json"
    place = ("--joint", "A1", "--position-deg", "-90", "--arm", "kr210-r2700", "--spacing-mm", "30")
    said("--recording", files.recording, "--moves", files.moves, "-o", output, *place, *more)
    return read_resolution(output)


def test_moves_that_were_not_driven_are_refused_at_their_line(tmp_path: Path) -> None:
    command = decaying_commands(109)
    moved = np.where(np.arange(109) < 60, command, 0.0)
    files = write_test(tmp_path, command.tolist(), moved.tolist())
    with pytest.raises(
        MovesError, match=r"moves\.csv:62: from move 61 of 109 on .* Leave out the moves from 61 on"
    ):
        evaluated(tmp_path, files, "--test", "decaying")


def test_moves_that_were_all_driven_leave_the_low_end_open(tmp_path: Path) -> None:
    command = decaying_commands(60)
    test = evaluated(
        tmp_path, write_test(tmp_path, command.tolist(), command.tolist()), "--test", "decaying"
    ).tests[0]
    assert test.lis is not None
    assert test.lis.low == 0.0
    assert test.lis.value == pytest.approx(command[-1])


def test_moves_of_a_series_with_another_ratio_are_refused(tmp_path: Path) -> None:
    command = decaying_commands(109)
    files = write_test(tmp_path, command.tolist(), (0.1 / 1.05 ** np.arange(109)).tolist())
    with pytest.raises(
        MovesError,
        match=r"moves\.csv:2: the steps fall by 1\.05 from one to the next, those commanded by 1\.072",
    ):
        evaluated(tmp_path, files, "--test", "decaying")


def test_moves_listed_too_late_are_refused(tmp_path: Path) -> None:
    command = decaying_commands(66)
    files = write_test(tmp_path, command.tolist(), command.tolist())
    lines = files.moves.read_text("utf-8").splitlines()
    later = [f"{float(t) + 0.5},{x}" for t, x in (line.split(",") for line in lines[1:])]
    files.moves.write_text("\n".join([lines[0], *later]) + "\n", "utf-8")
    with pytest.raises(
        MovesError, match=r"moves\.csv:2: the motions begin about 0\.[56] s before they were commanded"
    ):
        evaluated(tmp_path, files, "--test", "decaying")


def test_a_wrong_spacing_of_equal_steps_is_said(tmp_path: Path) -> None:
    command = 0.01 * np.repeat([1.0, -1.0, 1.0], 10)
    files = write_test(tmp_path, command.tolist(), command.tolist())
    (test,) = evaluated(tmp_path, files, "--test", "iso", "--spacing-mm", "45").tests
    (text,) = test.doubts
    assert "are 0.667 times those commanded" in text
    assert "the real one is 0.667 times the stated one" in text


def test_equal_steps_listed_too_late_are_refused(tmp_path: Path) -> None:
    command = 0.01 * np.repeat([1.0, -1.0, 1.0], 10)
    files = write_test(tmp_path, command.tolist(), command.tolist())
    lines = files.moves.read_text("utf-8").splitlines()
    later = [f"{float(t) + 0.5},{x}" for t, x in (line.split(",") for line in lines[1:])]
    files.moves.write_text("\n".join([lines[0], *later]) + "\n", "utf-8")
    with pytest.raises(
        MovesError, match=r"moves\.csv:2: the motions begin about 0\.[56] s before they were commanded"
    ):
        evaluated(tmp_path, files, "--test", "iso")


@pytest.mark.parametrize("lost", [35, 60])
def test_equal_steps_of_which_one_is_not_listed_are_refused(tmp_path: Path, lost: int) -> None:
    signs = np.repeat([1.0, -1.0, 1.0], 10)
    command = np.concatenate([0.002 * signs, 0.01 * signs])
    files = write_test(tmp_path, command.tolist(), command.tolist())
    lines = files.moves.read_text("utf-8").splitlines()
    del lines[lost]
    files.moves.write_text("\n".join(lines) + "\n", "utf-8")
    with pytest.raises(MovesError, match=r"moves\.csv:\d+: the sequences of 0.01° have .*9.* moves"):
        evaluated(tmp_path, files, "--test", "iso")
