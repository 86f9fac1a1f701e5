"""What the command itself prints, whatever is to be done."""

import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest
from typer.testing import CliRunner

from catseye.app.cli import cli


def test_the_version_is_that_of_the_package() -> None:
    result = CliRunner().invoke(cli, ["--version"])
    assert (result.exit_code, result.output) == (0, f"catseye {version('catseye')}\n")


def test_help_says_what_the_software_stop_is_not() -> None:
    result = CliRunner().invoke(cli, ["-h"])
    assert result.exit_code == 0
    assert "is not an emergency stop" in result.output


def ended(words: list[str], stdout: int) -> "subprocess.CompletedProcess[bytes]":
    """Return how the command ended with this stdout."""
    command = [sys.executable, "-m", "catseye", *words]
    root = Path(__file__).parents[3]
    return subprocess.run(command, stdout=stdout, stderr=subprocess.PIPE, cwd=root, timeout=60, check=False)


@pytest.mark.parametrize("words", [["procedures"], ["procedures", "--json"], ["--version"]])
def test_a_closed_pipe_ends_a_command_quietly(words: list[str]) -> None:
    source, sink = os.pipe()
    os.close(source)
    try:
        result = ended(words, sink)
    finally:
        os.close(sink)
    assert (result.returncode, result.stderr) == (141, b"")


@pytest.mark.parametrize("words", [["procedures"], ["procedures", "--json"], ["--version"]])
def test_a_full_disk_behind_stdout_is_a_storage_error(words: list[str]) -> None:
    with open("/dev/full", "wb") as full:
        result = ended(words, full.fileno())
    assert result.returncode == 6
    assert result.stderr.decode().startswith("catseye: stdout cannot be written: No space left on device: ")
    assert result.stderr.count(b"\n") == 1
