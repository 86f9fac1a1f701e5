"""Commands that a scheduler starts without stdin, stdout and stderr."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from catseye.app.store.catalog import list_runs
from tests.patience import HANG_S
from tests.system.command import SPEED, emulated, environment

CLOSED = ">&- 2>&- <&-"
WORDS = {
    "--version": 0,
    "runs --json": 0,
    "doctor none.toml": 2,
    "tui": 2,
    "emulate none.toml": 2,
    "engine --cell none.toml --wait-for-client 0": 4,
    "run warmup --cell none.toml --detach": 2,
}


def ended(words: str, folder: Path, closed: str = CLOSED) -> "subprocess.CompletedProcess[str]":
    line = f"{shlex.quote(sys.executable)} -m catseye {words} {closed}"
    # The shell is what closes them.
    return subprocess.run(
        ["/bin/sh", "-c", line],
        cwd=folder,
        env=environment(),
        timeout=HANG_S,
        check=False,
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize("words", WORDS)
def test_a_command_runs_without_descriptors(words: str, tmp_path: Path) -> None:
    assert ended(words, tmp_path).returncode == WORDS[words]


def test_emulators_end_with_a_stdin_that_was_closed(tmp_path: Path) -> None:
    assert ended("init cell.toml", tmp_path, "").returncode == 0
    cell = tmp_path / "cell.toml"
    cell.write_text(
        re.sub(r"(://127\.0\.0\.1):\d+", r"\1:0", cell.read_text(encoding="utf-8")), encoding="utf-8"
    )
    assert ended("emulate cell.toml --end-with-stdin", tmp_path, "<&-").returncode == 0


def test_a_run_is_complete_without_descriptors(tmp_path: Path) -> None:
    with emulated(tmp_path, "--seed", "3") as bench:
        words = f"run reflector-search --cell {bench.cell} --speed {SPEED} --runs runs"
        done = ended(words, tmp_path)
    assert (done.returncode, [run.status for run in list_runs(tmp_path / "runs")]) == (0, ["complete"])
