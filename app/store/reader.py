"""Reading a run without changing it, whether it is finished, under way or dead."""

import json
import math
import sqlite3
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from enum import Enum, auto
from pathlib import Path
from typing import Any, Literal

from catseye.app.errors import StorageError
from catseye.app.store.chunks import Chunk, chunk_misfits, chunks_of
from catseye.app.store.lines import HEALS
from catseye.app.store.lock import is_being_written
from catseye.app.store.rows import row_crc32
from catseye.app.store.schema import BASE_TABLES, LAST_OPENED_OR_ENDED, UNREADABLE, open_reader
from catseye.app.store.seal import DATABASE
from catseye.app.store.soundness import changes, damage
from catseye.app.store.tables import measured_rows, tables_in
from catseye.procedures.kit.recording import Recorded
from catseye.procedures.kit.records import OBSERVATIONS, Json, Table

Status = Literal["complete", "stopped", "aborted", "failed", "running", "died"]
_ENDINGS: tuple[Status, ...] = ("complete", "stopped", "aborted", "failed")


def ending(last: sqlite3.Row | None, run: str) -> Status | None:
    """Return how a run ended, from the last record of its being opened or ended; None when that is no end.

    Args:
        last: that record; None without one.

    Raises:
        StorageError: it ended in a way that only a newer program knows.
    """
    if last is None or last["kind"] != "run-ended":
        return None
    name = json.loads(last["data"])["status"]
    found = next((one for one in _ENDINGS if one == name), None)
    if found is None:
        raise StorageError(
            f"{run} ended as {name!r}, which this program does not know; install a newer catseye"
        )
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
        place: among everything that was stored, from 1; None in a file of an older program.
    """

    step_id: str
    attempt: int
    title: str
    started_utc: str
    done_utc: str
    row_count: int
    result: dict[str, Json]
    place: int | None = None


@dataclass(frozen=True)
class StoredEvent:
    """Something that happened.

    Attributes:
        seq: number within the run, from 1 without gaps.
        time_utc: ISO 8601 UTC time.
        kind: what.
        data: details.
        place: among everything that was stored, from 1; None in a file of an older program.
    """

    seq: int
    time_utc: str
    kind: str
    data: dict[str, Json]
    place: int | None = None

    @property
    def text(self) -> str:
        """The sentence that it carries; empty without one."""
        return str(self.data.get("text") or "")


class Accept(Enum):
    """Which runs a reader takes."""

    SOUND = auto()
    """Those whose files are what was written."""

    CHANGED = auto()
    """Sealed ones too whose files were changed; what they are used for says so."""

    UNCHECKED = auto()
    """All, unseen: for lists of runs, and for what checks them itself."""


def accept(*, unverified: bool) -> Accept:
    """Return which runs a command takes, with or without `--unverified`."""
    return Accept.CHANGED if unverified else Accept.SOUND


class RunReader:
    """A run, read-only.

    It connects anew for each question: an open connection would keep the writer from closing the run. A sealed run is
    compared with its manifest first, which takes about a second for each GB and is done once in a process; keep it
    off an event loop.

    Args:
        path: the run's directory.

    Attributes:
        path: the run's directory.
        unverified: what speaks against this run, and against those that were opened beside it.

    Raises:
        StorageError: it is no run, it is damaged or was changed, or a newer program wrote it.
    """

    def __init__(self, path: Path, terms: Accept = Accept.SOUND) -> None:
        self.path = path
        self.unverified: list[str] = []
        self._terms = terms
        self._database = path / DATABASE
        # A name, not a folder's way of writing it: "." has none.
        self._name = path.resolve().name
        open_reader(self._database).close()
        found = () if terms is Accept.UNCHECKED else changes(path)
        if found and terms is Accept.SOUND:
            raise StorageError(
                f"{self._name} is not what was sealed at its end: {'; '.join(found)}; catseye verify checks it. "
                "identify, report, dossier, export and show take it with --unverified, and what comes out says so"
            )
        self.unverified += [f"{self._name}: {text}" for text in found]
        self._checked = terms is not Accept.UNCHECKED and not found
        if self._checked and (texts := damage(path)):
            raise self._damaged("; ".join(texts))

    def beside(self, path: Path) -> "RunReader":
        """Open another run that this one is used together with, on the same terms.

        Raises:
            StorageError: as for the first one.
        """
        other = RunReader(path, self._terms)
        self.unverified += [text for text in other.unverified if text not in self.unverified]
        other.unverified = self.unverified
        return other

    @property
    def name(self) -> str:
        """Name of the run."""
        return self._name

    @property
    def meta(self) -> dict[str, Json]:
        """What the run says about itself."""
        rows = self._rows("meta")
        with self._decoding():
            return {row["key"]: json.loads(row["value"]) for row in rows}

    @property
    def procedure(self) -> str:
        """Name of what was run; empty in a run that does not say."""
        return str(self.meta.get("procedure") or "")

    @property
    def clock_speed(self) -> float | None:
        """Bench seconds in one real second; None in a run that does not say."""
        speed = self.meta.get("clock_speed")
        return float(speed) if isinstance(speed, int | float) else None

    @property
    def status(self) -> Status:
        """How the run ended; running when a living process writes it, died without a closing record."""
        last = self._query(LAST_OPENED_OR_ENDED)
        with self._decoding():
            ended = ending(last[0], self._name) if last else None
        return ended or ("running" if is_being_written(self.path) else "died")

    @property
    def exit_code(self) -> int | None:
        """Exit code of the closing record, None without one."""
        if self.status not in _ENDINGS:
            return None
        last = self._query("SELECT data FROM events WHERE kind = 'run-ended' ORDER BY seq DESC LIMIT 1")
        with self._decoding():
            return int(_fields(last[0]["data"])["exit_code"])

    def heals(self) -> Counter[str]:
        """Return how often the links of each device were healed; what went on until a death is not counted."""
        heals: Counter[str] = Counter()
        for ended in self.data_of("run-ended"):
            counts: Any = ended.get(HEALS, {})
            heals.update(counts)
        return heals

    def steps(self) -> list[StoredStep]:
        """Return the done steps in the order of their completion."""
        rows = self._rows("steps")
        with self._decoding():
            return [StoredStep(**{**row, "result": _fields(row["result"])}) for row in rows]

    def result(self, step_id: str) -> dict[str, Json] | None:
        """Return the last result of a step; None when it was not done."""
        return next((step.result for step in reversed(self.steps()) if step.step_id == step_id), None)

    def data_of(self, kind: str) -> list[dict[str, Json]]:
        """Return the data of all events of a kind, in order."""
        return [event.data for event in self.events() if event.kind == kind]

    def answers(self) -> dict[str, str | None]:
        """Return the last answer to each question by its id; None for one that stayed without."""
        return {str(prompt["id"]): prompt["answer"] for prompt in self.prompts()}

    def events(self) -> list[StoredEvent]:
        """Return what happened, in order."""
        rows = self._rows("events")
        with self._decoding():
            return [StoredEvent(**{**row, "data": _fields(row["data"])}) for row in rows]

    def prompts(self) -> list[dict[str, Any]]:
        """Return questions and answers in the order of the answers, with their places among all that was stored."""
        return self._rows("prompts")

    def tables(self) -> list[Table]:
        """Return the tables of data, in the order of their making."""
        with self._connected() as connection, self._decoding():
            return list(tables_in(connection).values())

    def rows(self, table: str) -> list[dict[str, Json]]:
        """Return the rows of a table of data, in order; none where the run has no such table."""
        return [row for _, row in self.placed_rows(table)]

    def placed_rows(self, table: str) -> list[tuple[int, dict[str, Json]]]:
        """Return the rows of a table of data with their places among all that was stored.

        A place counts from 1; it is 0 where no journal says it, in a file of an older program.
        """
        rows = self._rows(table)
        with self._decoding():
            return [(row["place"] or 0, _whole(row)) for row in rows]

    def records(self, kind: str | None = None) -> list[dict[str, Json]]:
        """Return what else was observed, in order: all of it, or one kind."""
        return [row for row in self.rows(OBSERVATIONS.name) if kind is None or row["kind"] == kind]

    def recordings(self) -> list[dict[str, Json]]:
        """Return what is known of each recording of a step that is done, in order."""
        return self.rows(Recorded.table)

    def chunks(self, recorded: Mapping[str, Json]) -> Iterator[Chunk]:
        """Yield the readings of a recording, a chunk at a time: a long one need not fit into memory.

        Args:
            recorded: one of `recordings`.

        Raises:
            StorageError: a chunk is missing, or is not what was written.
        """
        return chunks_of(self.path, recorded)

    def count(self, table: str) -> int:
        """Return how many rows a table has; 0 where the run has no such one."""
        if not self._query("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?", table):
            return 0
        return int(self._query(f'SELECT count(*) FROM "{table}"')[0][0])

    @property
    def measured(self) -> int:
        """How many rows there are of what the run measures."""
        with self._connected() as connection, self._decoding():
            return measured_rows(connection)

    def misfits(self) -> list[str]:
        """Return which rows are not what the journal says; empty for a sound record.

        Raises:
            StorageError: it cannot be read.
        """
        tables = (*BASE_TABLES, *(table.name for table in self.tables()))
        texts = [text for table in tables for text in self._misfits(table, *self._found(table))]
        return texts + chunk_misfits(self.path)

    def _rows(self, table: str) -> list[dict[str, Any]]:
        """Return all rows of a table with their places in the journal.

        Raises:
            StorageError: one is missing, or is not what was written; not said of a run that is known to be changed.
        """
        rows, entries = self._found(table)
        if self._checked and (texts := self._misfits(table, rows, entries)):
            raise self._damaged(texts[0])
        # What was stored before an upgrade has no entry and is older than all that has one.
        return [{**row, "place": entries.get(number, (None, 0))[0]} for number, row in rows.items()]

    def _found(self, table: str) -> tuple[dict[int, dict[str, Any]], dict[int, tuple[int, int]]]:
        """Return rows by number, and place and check sum of those in the journal; an older file may lack both."""
        with self._connected() as connection:
            # One snapshot: a writer adds a row and its entry together.
            connection.execute("BEGIN")
            tables = {
                row[0] for row in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
            }
            if table not in tables:
                return {}, {}
            entries = {}
            if "journal" in tables:
                found = connection.execute("SELECT row, place, crc32 FROM journal WHERE of = ?", (table,))
                entries = {row: (place, crc32) for row, place, crc32 in found}
            rows = connection.execute(f'SELECT rowid AS "#", * FROM "{table}" ORDER BY rowid').fetchall()
        numbered = [dict(row) for row in rows]
        return {row.pop("#"): row for row in numbered}, entries

    def _misfits(
        self, table: str, rows: dict[int, dict[str, Any]], entries: dict[int, tuple[int, int]]
    ) -> list[str]:
        texts = []
        with self._decoding():
            for number, (_, crc32) in entries.items():
                if number not in rows:
                    texts.append(f"row {number} of {table} is missing")
                elif row_crc32(table, rows[number]) != crc32:
                    texts.append(f"row {number} of {table} is not what was written")
            # Rows from before an upgrade have no entry; whatever was stored after the first entry has one.
            first = min(entries, default=math.inf)
            unlisted = [number for number in rows if number > first and number not in entries]
        return texts + [f"row {number} of {table} has no entry in the journal" for number in unlisted]

    def _query(self, sql: str, *values: str) -> list[sqlite3.Row]:
        with self._connected() as connection:
            return connection.execute(sql, values).fetchall()

    @contextmanager
    def _connected(self) -> Iterator[sqlite3.Connection]:
        with closing(open_reader(self._database)) as connection:
            try:
                yield connection
            except UNREADABLE as error:
                raise StorageError(f"{self._database} cannot be read: {error}") from error

    @contextmanager
    def _decoding(self) -> Iterator[None]:
        """Distinguish values that no writer has stored from faults of the program."""
        try:
            yield
        except (TypeError, ValueError, LookupError, RecursionError) as error:
            raise self._damaged(f"a stored value cannot be read: {error}") from error

    def _damaged(self, text: str) -> StorageError:
        return StorageError(
            f"{self._database} is damaged: {text}; catseye verify says more, a copy of the run may be sound"
        )


def _fields(text: str) -> dict[str, Any]:
    """Return the object that a JSON text holds.

    Raises:
        ValueError: it holds something else.
    """
    found = json.loads(text)
    if not isinstance(found, dict):
        raise ValueError(f"{text[:40]!r} is not a JSON object")
    return found


def _whole(row: dict[str, Any]) -> dict[str, Json]:
    """Return a row of data with the columns that only its kind has."""
    del row["place"]
    return {**row, **_fields(row.pop("extra"))}
