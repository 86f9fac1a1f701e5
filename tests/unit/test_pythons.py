"""Which Pythons of a machine the suite is run on, and with which versions at least."""

import shutil
import stat
import subprocess
import sys
from fnmatch import fnmatch
from pathlib import Path

import pytest

from tests.lowest import pins
from tests.pythons import candidates, chosen, found, missing


def python(path: Path, answer: str) -> str:
    """Make what answers as a Python of that minor version does."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{answer}\n", encoding="utf-8")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def test_first_of_each_minor_version_is_taken(tmp_path: Path) -> None:
    first = python(tmp_path / "one" / "python3.12", "echo 12")
    newer = python(tmp_path / "two" / "python3", "echo 13")
    again = python(tmp_path / "two" / "python3.12", "echo 12")
    assert found([newer, first, again]) == {12: first, 13: newer}


def test_shims_old_pythons_and_prereleases_are_none(tmp_path: Path) -> None:
    shim = python(tmp_path / "shim", "exit 127")
    old = python(tmp_path / "old", "echo 10")
    prerelease = python(tmp_path / "next", "echo 0")
    assert found([shim, old, prerelease, str(tmp_path / "absent")]) == {}


def test_python_that_runs_this_is_asked_truly() -> None:
    assert found([sys.executable]) == {sys.version_info[1]: sys.executable}


def test_own_path_and_pyenv_are_searched_in_that_order(tmp_path: Path) -> None:
    kept = python(tmp_path / "pyenv" / "versions" / "3.14.1" / "bin" / "python", "echo 14")
    looked = list(candidates({"PATH": f"{tmp_path}/a b:{tmp_path}/c", "PYENV_ROOT": f"{tmp_path}/pyenv"}))
    assert looked[0] == sys.executable
    assert looked[-1] == kept
    assert looked.index(f"{tmp_path}/a b/python3.13") < looked.index(f"{tmp_path}/c/python3.12")


@pytest.mark.parametrize(
    ("which", "minors", "expected"),
    [
        ("each", [11, 12, 13], [11, 12, 13]),
        ("newer", [11, 12, 13], [13]),
        ("newer", [11, 12], []),
        ("oldest", [11, 12, 13], [11]),
    ],
)
def test_choice_among_what_was_found(which: str, minors: list[int], expected: list[int]) -> None:
    assert chosen(which, minors, 12) == expected


def test_released_versions_that_are_absent_are_named() -> None:
    assert missing([11, 13]) == [12, 14]


def test_pins_are_the_lower_bounds() -> None:
    assert pins(["numpy>=1.26", "textual>=8.2.8,<9", "numpy>=1.26"]) == ["numpy==1.26", "textual==8.2.8"]
    with pytest.raises(ValueError, match=r"'numpy' in pyproject\.toml has no lower bound"):
        pins(["numpy"])


def test_versions_that_cannot_be_worked_out_leave_no_file(tmp_path: Path) -> None:
    for name in ("Makefile", "pyproject.toml", "tests/lowest.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(Path(__file__).parents[2] / name, tmp_path / name)
    versions = "build/constraints-lowest.txt"
    made = subprocess.run(["make", "PYTHON=false", versions], cwd=tmp_path, capture_output=True, check=False)
    assert made.returncode != 0
    assert not (tmp_path / versions).exists()


def test_make_clean_removes_ignored_folders_alone() -> None:
    root = Path(__file__).parents[2]
    recipe = next(
        line for line in (root / "Makefile").read_text().splitlines() if line.startswith("\trm -rf .venv")
    )
    patterns = recipe.split()[2:]
    ignored = [line.rstrip("/") for line in (root / ".gitignore").read_text().splitlines()]
    assert [one for one in patterns if not any(fnmatch(one, line) for line in ignored)] == []
    assert [path.name for one in patterns for path in root.glob(one) if not path.is_dir()] == []
