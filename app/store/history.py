"""The runs of a folder with what a list of them shows, read anew only where something changed."""

import json
import os
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Final, Literal

from catseye.app.errors import StorageError
from catseye.app.store.lock import is_being_written
from catseye.app.store.reader import Status, ending
from catseye.app.store.run_names import run_name, start_of
from catseye.app.store.schema import LAST_OPENED_OR_ENDED, open_reader
from catseye.app.store.seal import DATABASE
from catseye.app.store.tables import measured_rows

_Stamp = tuple[tuple[int, int], ...]
"""Time of change and size of a run's files."""

_OPEN: Final = frozenset({"running", "died"})
"""What a living or dead writer makes of the same files."""


@dataclass(frozen=True)
class RunLine:
    """One line of the history.

    Attributes:
        path: the run's directory.
        id: six hexadecimal digits.
        procedure: what was run.
        started_utc: when it began.
        status: how it ended; damaged when it cannot be read.
        duration_s: from its first record to its last, interruptions included; None when it has none, or the clock was
            set back by more than that.
        rows: of what it measures: points, or those of its path or search.
        simulated: every device is an emulator; None when the devices are not known.
        cell: name of the cell; empty when it is not known.
        fault: why a damaged one cannot be read.
    """

    path: Path
    id: str
    procedure: str
    started_utc: datetime
    status: Status | Literal["damaged"]
    duration_s: float | None = None
    rows: int = 0
    simulated: bool | None = None
    cell: str = ""
    fault: str = ""

    @property
    def name(self) -> str:
        """The run's name."""
        return self.path.name


class RunHistory:
    """The runs of a folder."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._known: dict[str, tuple[_Stamp, RunLine]] = {}

    @property
    def lines(self) -> list[RunLine]:
        """What is known, newest first."""
        return [self._known[name][1] for name in sorted(self._known, reverse=True)]

    def changes(self) -> Iterator[RunLine]:
        """Look at the folder, and yield each run that is new or has changed, newest first.

        Runs that are gone are forgotten before the first is yielded.
        """
        names = _names(self._root)
        for gone in self._known.keys() - set(names):
            del self._known[gone]
        for name in names:
            known = self._known.get(name)
            stamp = _stamp(self._root / name)
            if known is not None and known[0] == stamp and not _writer_changed(known[1]):
                continue
            line = _line(self._root / name)
            self._known[name] = stamp, line
            yield line


def _names(root: Path) -> list[str]:
    try:
        with os.scandir(root) as entries:
            found = [entry.name for entry in entries if _is_run(entry.name) and entry.is_dir()]
    except OSError:
        return []
    return sorted(found, reverse=True)


def _is_run(name: str) -> bool:
    try:
        _parts(name)
    except ValueError:
        return False
    return True


def _parts(name: str) -> tuple[datetime, str, str]:
    """Return when a run began, its procedure, and its id.

    Raises:
        ValueError: it is the name of something else.
    """
    match = run_name(name)
    if match is None:
        raise ValueError(f"{name} is not a run name")
    return start_of(match), match["procedure"], match["id"]


def _stamp(path: Path) -> _Stamp:
    found = []
    for name in (DATABASE, f"{DATABASE}-wal"):
        try:
            facts = os.stat(path / name)
        except OSError:
            continue
        # A reader leaves an empty log beside the file of a dead writer.
        if facts.st_size:
            found.append((facts.st_mtime_ns, facts.st_size))
    return tuple(found)


def _writer_changed(line: RunLine) -> bool:
    """Return whether a run that has no end yet is written by somebody now and was not, or the other way round."""
    if line.status not in _OPEN:
        return False
    try:
        return is_being_written(line.path) != (line.status == "running")
    except StorageError:
        return True


def _line(path: Path) -> RunLine:
    started, procedure, id_ = _parts(path.name)
    try:
        with closing(open_reader(path / DATABASE)) as connection:
            return _read(connection, path, id_, procedure, started)
    except (StorageError, sqlite3.Error, OSError, ValueError, KeyError, TypeError) as error:
        return RunLine(path, id_, procedure, started, "damaged", fault=str(error))


_FACTS: Final = """
SELECT
    (SELECT value FROM meta WHERE key = 'simulated') AS simulated,
    (SELECT value FROM meta WHERE key = 'cell') AS cell,
    (SELECT time_utc FROM events ORDER BY seq LIMIT 1) AS first_utc,
    (SELECT time_utc FROM events ORDER BY seq DESC LIMIT 1) AS last_utc
"""


def _read(connection: sqlite3.Connection, path: Path, id_: str, procedure: str, started: datetime) -> RunLine:
    facts = connection.execute(_FACTS).fetchone()
    return RunLine(
        path=path,
        id=id_,
        procedure=procedure,
        started_utc=started,
        status=_status(connection, path),
        duration_s=_between_s(facts["first_utc"], facts["last_utc"]),
        rows=measured_rows(connection),
        simulated=json.loads(facts["simulated"] or "null"),
        cell=str(json.loads(facts["cell"] or '""') or ""),
    )


def _between_s(first_utc: str | None, last_utc: str | None) -> float | None:
    if first_utc is None or last_utc is None:
        return None
    duration_s = (datetime.fromisoformat(last_utc) - datetime.fromisoformat(first_utc)).total_seconds()
    return duration_s if duration_s >= 0.0 else None


def _status(connection: sqlite3.Connection, path: Path) -> Status:
    last = connection.execute(LAST_OPENED_OR_ENDED).fetchone()
    return ending(last, path.name) or ("running" if is_being_written(path) else "died")
