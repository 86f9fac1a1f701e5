"""Files are written before anything is printed: a reader that leaves early, as `head` does, costs none of them."""

import os
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout, suppress
from pathlib import Path
from typing import TextIO

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli import cli
from catseye.app.cli.narrator import Narrator
from catseye.app.errors import ReaderGoneError
from tests.unit.app.cli.arms import bare, stored, text_file
from tests.unit.app.cli.test_design import NODES1, NODES2
from tests.unit.app.results.serial_arm.tables import arm_file, poses_file, some_poses, tool_file

Words = list[str | Path]


def closed_pipe() -> TextIO:
    """Return a pipe that nobody reads any more; each line goes into it at once, as with stderr."""
    source, sink = os.pipe()
    os.close(source)
    return open(sink, "w", encoding="utf-8", buffering=1)


def call_with_closed_stdout(words: Words) -> None:
    with closed_pipe() as stdout, redirect_stdout(stdout), pytest.raises(ReaderGoneError):
        cli([*map(str, words)], standalone_mode=False)


def call_with_closed_stderr(words: Words) -> None:
    stderr = closed_pipe()
    try:
        with redirect_stderr(stderr):
            cli([*map(str, words)], standalone_mode=False)
    finally:
        with suppress(BrokenPipeError):
            stderr.close()


def validated(folder: Path) -> Words:
    rows = "".join(f"170,{y},170.01,{y},0.02\n" for y in range(280, 380, 5))
    measured = text_file(folder, "x_mm,y_mm,x_meas_mm,y_meas_mm,u_mm\n" + rows, "measured.csv")
    return ["validate", stored(folder, bare()), "--measured", measured, "-o", folder / "page.html"]


def predicted(folder: Path) -> Words:
    path = text_file(folder, "x_mm,y_mm\n170,330\n170,380\n")
    return ["predict", stored(folder, bare()), "--path", path, "-o", folder / "predicted.csv"]


def compensated(folder: Path) -> Words:
    path = text_file(folder, "x_mm,y_mm\n170,330\n170,380\n")
    return ["compensate", stored(folder, bare()), "--path", path, "-o", folder / "corrected.csv"]


def designed(folder: Path) -> Words:
    text = TEMPLATE.replace(NODES1, "theta1_deg = [-120.0, -60.0, 0.0, 40.0]")
    cell = text_file(folder, text.replace(NODES2, "theta2_deg = [20.0, 60.0, 100.0, 140.0]"), "cell.toml")
    asked: Words = ["--cell", cell, "--places", "30", "--commands", "12"]
    written: Words = ["--write-cell", folder / "found.toml", "--write-commands", folder / "chosen.csv"]
    return ["design", *asked, "-o", folder / "page.html", *written]


def calibrated(folder: Path) -> Words:
    poses, arm = poses_file(folder, some_poses()), arm_file(folder)
    given: Words = ["--poses", poses, "--arm", arm, "--tool", tool_file(folder)]
    return ["calibrate", *given, "--model", "geometric", "-o", folder / "arm.json"]


def chosen_poses(folder: Path) -> Words:
    given: Words = ["--arm", "irb120", "--tool", tool_file(folder), "--count", "9", "--starts", "1"]
    few: Words = ["--candidates", "40", "--model", "frames", "--no-bodies", "--station", "1800,0,400"]
    return ["select-poses", *given, *few, "-o", folder / "chosen.csv", "--report", folder / "page.html"]


@pytest.mark.parametrize("as_json", [False, True])
@pytest.mark.parametrize(
    "words_of",
    [validated, predicted, compensated, designed, calibrated, chosen_poses],
    ids=lambda f: f.__name__,
)
def test_a_closed_pipe_costs_no_file(
    words_of: Callable[[Path], Words], as_json: bool, tmp_path: Path
) -> None:
    words = words_of(tmp_path)
    outputs = [
        Path(words[i + 1])
        for i, word in enumerate(words)
        if str(word).startswith(("-o", "--write-", "--report"))
    ]
    call_with_closed_stdout([*words, *(["--json"] if as_json else [])])
    assert outputs
    assert [path.name for path in outputs if not path.is_file()] == []


def test_a_validation_of_an_arm_survives_a_closed_pipe(tmp_path: Path) -> None:
    call_with_closed_stdout(calibrated(tmp_path))
    measured = poses_file(tmp_path, some_poses(12, 7))
    page = tmp_path / "page.html"
    call_with_closed_stdout(["validate", tmp_path / "arm.json", "--measured", measured, "-o", page])
    assert page.is_file()


@pytest.mark.parametrize("words_of", [compensated, calibrated, chosen_poses], ids=lambda f: f.__name__)
def test_talk_that_nobody_reads_costs_no_file(
    words_of: Callable[[Path], Words], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = words_of(tmp_path)
    call_with_closed_stderr(words)
    assert Path(words[words.index("-o") + 1]).is_file()
    assert capsys.readouterr().out


def test_a_run_notices_that_nobody_reads_its_talk() -> None:
    stderr = closed_pipe()
    narrator = Narrator("warmup", as_json=False)
    with redirect_stderr(stderr), pytest.raises(BrokenPipeError):
        narrator.show("the arm moves")
    with suppress(BrokenPipeError):
        stderr.close()
