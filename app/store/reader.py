"""Reading a run without changing it, whether it is finished, under way or dead."""

import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from app.errors import StorageError
from app.store.lock import is_being_written
from app.store.schema import open_reader
from app.store.seal import DATABASE
from procedures.context import Json, Table

Status = Literal["complete", "stopped", "aborted", "failed", "running", "died"]
_ENDINGS: tuple[Status, ...] = ("complete", "stopped", "aborted", "failed")


def ending(last: sqlite3.Row | None) -> Status | None:
    """Return how a run ended, from the last record of its being opened or ended; None when that is no end.

    Raises:
        StorageError: it ended in a way that only a newer program knows.
    """
    if last is None or last["kind"] != "run-ended":
        return None
    name = json.loads(last["data"])["status"]
    found = next((one for one in _ENDINGS if one == name), None)
    if found is None:
        raise StorageError(f"it ended as {name!r}, which this program does not know; install a newer catseye")
    return found


@dataclass(frozen=True)
class StoredStep:
    """A step that is done.

    Attributes:
        step_id: stable name within the run.
        attempt: which attempt succeeded, from 1.
        title: what it did.
        started_utc: ISO 8601 UTC time.
        done_utc: ISO 8601 UTC time.
        row_count: rows of data stored with it.
        result: what the step returned.
    """

    step_id: str
    attempt: int
    title: str
    started_utc: str
    done_utc: str
    row_count: int
    result: dict[str, Json]


@dataclass(frozen=True)
class StoredEvent:
    """Something that happened.

    Attributes:
        seq: number within the run, from 1 without gaps.
        time_utc: ISO 8601 UTC time.
        kind: what.
        data: details.
    """

    seq: int
    time_utc: str
    kind: str
    data: dict[str, Json]


class RunReader:
    """A run, read-only.

    It connects anew for each question: an open connection would keep the writer from closing the run.

    Args:
        path: the run's directory.

    Raises:
        StorageError: it is no run, it is damaged, or a newer program wrote it.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._database = path / DATABASE
        open_reader(self._database).close()

    @property
    def meta(self) -> dict[str, Json]:
        """What the run says about itself."""
        return {row["key"]: json.loads(row["value"]) for row in self._query("SELECT key, value FROM meta")}

    @property
    def status(self) -> Status:
        """How the run ended; running when a living process writes it, died without a closing record."""
        last = self._query(
            "SELECT kind, data FROM events WHERE kind IN ('run-opened', 'run-reopened', 'run-ended') "
            "ORDER BY seq DESC LIMIT 1"
        )
        ended = ending(last[0]) if last else None
        return ended or ("running" if is_being_written(self.path) else "died")

    @property
    def exit_code(self) -> int | None:
        """Exit code of the closing record, None without one."""
        if self.status not in _ENDINGS:
            return None
        last = self._query("SELECT data FROM events WHERE kind = 'run-ended' ORDER BY seq DESC LIMIT 1")
        return int(json.loads(last[0]["data"])["exit_code"])

    def steps(self) -> list[StoredStep]:
        """Return the done steps in the order of their completion."""
        rows = self._query("SELECT * FROM steps ORDER BY rowid")
        return [StoredStep(**{**dict(row), "result": json.loads(row["result"])}) for row in rows]

    def events(self) -> list[StoredEvent]:
        """Return what happened, in order."""
        rows = self._query("SELECT * FROM events ORDER BY seq")
        return [StoredEvent(**{**dict(row), "data": json.loads(row["data"])}) for row in rows]

    def prompts(self) -> list[dict[str, Json]]:
        """Return questions and answers, in order."""
        return [dict(row) for row in self._query("SELECT * FROM prompts ORDER BY seq")]

    def points(self) -> list[dict[str, Json]]:
        """Return the measured distances in measuring order."""
        return list(self._data("points"))

    def search(self) -> list[dict[str, Json]]:
        """Return the rows of searches in order."""
        return list(self._data("search"))

    def path_rows(self) -> list[dict[str, Json]]:
        """Return the rows of validation paths in order."""
        return list(self._data("path"))

    def records(self, kind: str | None = None) -> list[dict[str, Json]]:
        """Return what else was observed, in order: all of it, or one kind."""
        return [row for row in self._data("records") if kind is None or row["kind"] == kind]

    def count(self, table: Table | Literal["steps", "events"]) -> int:
        """Return how many rows a table has."""
        return int(self._query(f"SELECT count(*) FROM {table}")[0][0]) if self._has(table) else 0

    def integrity(self) -> list[str]:
        """Return what SQLite finds wrong with the file; empty when it is sound."""
        found = [str(row[0]) for row in self._query("PRAGMA integrity_check")]
        return [] if found == ["ok"] else found

    def _has(self, table: str) -> bool:
        """Return whether the file has a table: one of an older program lacks the later ones."""
        return bool(self._query(f"SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = '{table}'"))

    def _data(self, table: Table) -> Iterator[dict[str, Json]]:
        if not self._has(table):
            return
        for row in self._query(f"SELECT * FROM {table} ORDER BY rowid"):
            values = dict(row)
            extra: dict[str, Json] = json.loads(values.pop("extra"))
            yield {**values, **extra}

    def _query(self, sql: str) -> list[sqlite3.Row]:
        with closing(open_reader(self._database)) as connection:
            try:
                return connection.execute(sql).fetchall()
            except sqlite3.Error as error:
                raise StorageError(f"{self._database} cannot be read: {error}") from error
