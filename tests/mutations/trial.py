"""One fault put into a copy of the program, and what the tests say of it."""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from enum import Enum
from pathlib import Path
from typing import Final

from tests.mutations.critical import Mutation

ROOT: Final = Path(__file__).parents[2]
LIMIT_S: Final = 900.0
"""Of the tests of one fault; a fault that makes them hang is caught."""

_LEFT_OUT: Final = shutil.ignore_patterns(
    ".git", ".venv*", "*_cache", "__pycache__", ".hypothesis", "catseye-*", "*.egg-info", "build", "dist"
)


class Outcome(Enum):
    """What became of a fault."""

    CAUGHT = "caught"
    SURVIVED = "SURVIVED"
    BROKEN = "BROKEN: the tests could not be run"


@contextmanager
def copied() -> Iterator[Path]:
    """Yield a copy of the program with its tests, which is removed afterwards."""
    with tempfile.TemporaryDirectory(prefix="catseye-mutation-") as folder:
        copy = Path(folder) / "catseye"
        shutil.copytree(ROOT, copy, symlinks=True, ignore=_LEFT_OUT)
        yield copy


@contextmanager
def put_in(mutation: Mutation, root: Path) -> Iterator[None]:
    """Change the files of a copy for a while.

    Raises:
        ValueError: a text does not stand exactly once where it should.
    """
    before = {edit.path: (root / edit.path).read_text(encoding="utf-8") for edit in mutation.edits}
    try:
        for edit in mutation.edits:
            path = root / edit.path
            text = path.read_text(encoding="utf-8")
            if text.count(edit.old) != 1:
                raise ValueError(f"{mutation.name}: {edit.path} has {text.count(edit.old)} × {edit.old!r}")
            path.write_text(text.replace(edit.old, edit.new), encoding="utf-8")
        yield
    finally:
        for name, text in before.items():
            (root / name).write_text(text, encoding="utf-8")


def passes(root: Path, tests: Iterable[str]) -> Outcome:
    """Run tests in a copy; those that pass let a fault survive."""
    command = (
        sys.executable,
        "-m",
        "pytest",
        "-c",
        "pyproject.toml",
        "-q",
        "-x",
        "-n",
        "0",
        "--timeout",
        "120",
    )
    # Compiled files of the time before the change may have its size and second.
    quiet = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        done = subprocess.run(
            (*command, *tests), cwd=root, env=quiet, timeout=LIMIT_S, capture_output=True, check=False
        )
    except subprocess.TimeoutExpired:
        return Outcome.CAUGHT
    return {0: Outcome.SURVIVED, 1: Outcome.CAUGHT}.get(done.returncode, Outcome.BROKEN)
