"""The runs below a directory, and which one a person means."""

import difflib
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from catseye.app.errors import StorageError, UsageError
from catseye.app.store.reader import Accept, RunReader, Status
from catseye.app.store.run_names import run_folders
from catseye.app.store.schema import is_file
from catseye.app.store.seal import DATABASE


@dataclass(frozen=True)
class RunSummary:
    """One line of the list of runs.

    Attributes:
        path: the run's directory.
        id: six hexadecimal digits.
        procedure: what was run.
        started: UTC time as in the name, yyyymmddThhmmssZ.
        status: how it ended; damaged when it cannot be read.
    """

    path: Path
    id: str
    procedure: str
    started: str
    status: Status | Literal["damaged"]

    @property
    def name(self) -> str:
        """The run's name."""
        return self.path.name


def list_runs(root: Path) -> list[RunSummary]:
    """Return the runs below a directory, oldest first.

    Raises:
        StorageError: the directory cannot be listed.
    """
    return [_summary(path, match) for path, match in run_folders(root)]


def paths_of(root: Path, procedure: str) -> list[Path]:
    """Return the directories of the runs of a procedure, oldest first; none of them is opened."""
    return [path for path, match in run_folders(root) if match["procedure"] == procedure]


def resolve_run(root: Path, text: str) -> Path:
    """Return the run that is meant by a path, a name, the beginning of a name, or an id.

    Raises:
        UsageError: none or several fit; the text lists them or the nearest.
        StorageError: the runs cannot be looked at.
    """
    direct = Path(text)
    if is_file(direct / DATABASE):
        return direct
    names = [path.name for path, _ in run_folders(root)]
    ids = [match["id"] for _, match in run_folders(root)]
    found = [name for name, run_id in zip(names, ids, strict=True) if name == text or run_id == text]
    found = found or [name for name in names if name.startswith(text)]
    if len(found) == 1:
        return root / found[0]
    if found:
        raise UsageError(f"{text!r} means several runs in {root}: {', '.join(found)}; write more of the name")
    raise UsageError(f"no run {text!r} in {root}; {_nearest(text, names, ids)}")


def _summary(path: Path, match: re.Match[str]) -> RunSummary:
    status: Status | Literal["damaged"]
    try:
        status = RunReader(path, Accept.UNCHECKED).status
    except StorageError:
        status = "damaged"
    return RunSummary(path, match["id"], match["procedure"], match["started"], status)


def _nearest(text: str, names: list[str], ids: list[str]) -> str:
    if not names:
        return "it holds no runs"
    close = difflib.get_close_matches(text, [*names, *ids], n=3, cutoff=0.4)
    near = [name for name, run_id in zip(names, ids, strict=True) if {name, run_id} & set(close)]
    return f"the nearest are {', '.join(near)}" if near else f"the newest is {names[-1]}"
