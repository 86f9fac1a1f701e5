"""Make a target on each Python of this machine, on a newer or on the oldest one, and say which are missing.

Run as `python -m tests.pythons each|newer|oldest TARGET [VENV]`; it needs the standard library alone. Looked for are
the Python that runs this, python3.11, python3.12 … on PATH, and those of pyenv.
"""

import os
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from glob import escape, glob
from pathlib import Path

MINORS = range(11, 16)
"""Looked for by name, as 3.11; a newer one is found all the same where it is called python3."""

EXPECTED = range(11, 15)
"""Said to be missing where they are not found: released."""

_ASKED = """
import sys, ensurepip, sqlite3, venv
print(sys.version_info[1] if sys.version_info[0] == 3 and sys.version_info[3] == "final" else 0)
"""


def candidates(environment: Mapping[str, str]) -> Iterator[str]:
    """Yield what may be a Python: the one that runs this, those on PATH, pyenv's."""
    yield sys.executable
    for folder in environment.get("PATH", "").split(os.pathsep):
        yield from (str(Path(folder, f"python3.{minor}")) for minor in MINORS)
        yield str(Path(folder, "python3"))
    pyenv = environment.get("PYENV_ROOT") or str(Path.home() / ".pyenv")
    # A folder of somebody else, which this user may not enter, is an empty one to `glob`.
    yield from sorted(glob(f"{escape(pyenv)}/versions/3.*/bin/python"))


def found(paths: Iterable[str]) -> dict[int, str]:
    """Return the first Python of each minor version that can make environments, by that number, ascending."""
    pythons: dict[int, str] = {}
    for path in dict.fromkeys(paths):
        if os.access(path, os.X_OK) and (minor := _minor(path)) >= MINORS[0]:
            pythons.setdefault(minor, path)
    return dict(sorted(pythons.items()))


def _minor(path: str) -> int:
    """Return the minor version; 0 where it does not run, as a shim of pyenv, or lacks what an environment needs."""
    try:
        asked = subprocess.run([path, "-c", _ASKED], capture_output=True, text=True, check=True, timeout=60)
        return int(asked.stdout)
    except (OSError, ValueError, subprocess.SubprocessError):
        return 0


def chosen(which: str, minors: list[int], own: int) -> list[int]:
    """Return the minor versions that are asked for.

    Args:
        which: each; the newest if it is newer than the own; the oldest.
        minors: that were found, ascending.
        own: that runs this.

    Raises:
        KeyError: `which` is not each, newer or oldest.
    """
    newer = [minor for minor in minors if minor > own]
    return {"each": minors, "newer": newer[-1:], "oldest": minors[:1]}[which]


def missing(minors: Iterable[int]) -> list[int]:
    """Return the minor versions that were not found."""
    return sorted(set(EXPECTED) - set(minors))


def main(which: str, target: str, venv: str = ".venv") -> int:
    """Make the target with PYTHON and VENV set; return how many of the Pythons failed it."""
    pythons = found(candidates(os.environ))
    own = sys.version_info[1]
    minors = chosen(which, list(pythons), own)
    failed = [minor for minor in minors if not _make(target, minor, pythons[minor], venv)]
    if minors:
        _report(f"{target}: passed on {_names(sorted({*minors} - {*failed}))}; failed on {_names(failed)}")
    else:
        _report(f"{target}: no Python newer than 3.{own} was found")
    _report(f"not found, and not tried: {_names(missing(pythons))}")
    return len(failed)


def _make(target: str, minor: int, python: str, venv: str) -> bool:
    _report(f"{target} on Python 3.{minor}, {python}")
    command = [os.environ.get("MAKE", "make"), "--no-print-directory", target]
    # The flags of a make that runs this name descriptors that no child of Python has.
    environment = {name: value for name, value in os.environ.items() if name != "MAKEFLAGS"}
    made = subprocess.run(
        [*command, f"PYTHON={python}", f"VENV={venv}-3.{minor}"], check=False, env=environment
    )
    return made.returncode == 0


def _names(minors: Iterable[int]) -> str:
    return ", ".join(f"Python 3.{minor}" for minor in minors) or "none"


def _report(text: str) -> None:
    sys.stderr.write(f"{text}\n")


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
