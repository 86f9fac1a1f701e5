"""Layout of run.sqlite, its version, and how a connection is opened."""

import os
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Final
from urllib.parse import quote

from catseye.app.errors import StorageError
from catseye.app.store.lock import is_being_written

BASE_TABLES: Final = ("meta", "steps", "events", "prompts", "journal")
"""What every run has; its tables of data are declared by record types."""

CHUNKS: Final = "chunks"
"""What every run has, too: readings of its recordings, too many to be read like the rows of the other tables."""

_LAYOUT: Final = """
CREATE TABLE IF NOT EXISTS meta (
    key TEXT PRIMARY KEY, value TEXT NOT NULL CHECK (json_valid(value))
) STRICT;
CREATE TABLE IF NOT EXISTS steps (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, title TEXT NOT NULL,
    started_utc TEXT NOT NULL, done_utc TEXT NOT NULL, row_count INTEGER NOT NULL,
    result TEXT NOT NULL CHECK (json_valid(result)),
    PRIMARY KEY (step_id, attempt)
) STRICT;
CREATE TABLE IF NOT EXISTS events (
    seq INTEGER PRIMARY KEY, time_utc TEXT NOT NULL, kind TEXT NOT NULL,
    data TEXT NOT NULL CHECK (json_valid(data))
) STRICT;
CREATE TABLE IF NOT EXISTS prompts (
    seq INTEGER PRIMARY KEY, id TEXT NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL,
    asked_utc TEXT NOT NULL, answered_utc TEXT, answer TEXT, who TEXT
) STRICT;
CREATE TABLE IF NOT EXISTS journal (
    place INTEGER PRIMARY KEY, of TEXT NOT NULL, row INTEGER NOT NULL, crc32 INTEGER NOT NULL,
    UNIQUE (of, row)
) STRICT;
CREATE TABLE IF NOT EXISTS chunks (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, recording TEXT NOT NULL, seq INTEGER NOT NULL,
    readings INTEGER NOT NULL, data BLOB NOT NULL,
    PRIMARY KEY (step_id, attempt, recording, seq)
) STRICT;
"""
"""The journal has every row in the order of its being stored, with a check sum: clocks jump, and bits flip."""

VERSION: Final = 6
"""`user_version` of a file that this program writes.

Versions 1 to 4 had a fixed set of tables of data, the first three no journal, and the first five no chunks. A file of
theirs that goes on gets what it lacks; only newer programs read it then.
"""


def append_only(table: str) -> tuple[str, ...]:
    """Return the statements that keep a table from being changed."""
    return tuple(
        f'CREATE TRIGGER IF NOT EXISTS {table}_no_{verb.lower()} BEFORE {verb} ON "{table}" '
        f"BEGIN SELECT RAISE(ABORT, '{table} is append-only'); END;"
        for verb in ("UPDATE", "DELETE")
    )


LAST_OPENED_OR_ENDED = """
SELECT kind, data FROM events WHERE kind IN ('run-opened', 'run-reopened', 'run-ended') ORDER BY seq DESC LIMIT 1
"""
"""What says how a run ended, or that it has not."""

_JOURNAL_OF_ONE_PAGE_BYTES = 512 + 4 + 4096 + 4
"""A sector with its head, then a page with its number and its sum."""

UNREADABLE = (sqlite3.Error, UnicodeDecodeError)
"""What reading a damaged file ends with; a broken text may stand even in SQLite's own message."""


def open_writer(path: Path) -> sqlite3.Connection:
    """Open or create the file for writing, durable at every commit, and bring it to this version.

    Raises:
        StorageError: the file cannot be used, is newer, or does not take the durable settings.
    """
    connection = sqlite3.connect(path, isolation_level=None)
    try:
        _require(connection, "PRAGMA journal_mode=WAL", "PRAGMA journal_mode", "wal")
        _require(connection, "PRAGMA synchronous=FULL", "PRAGMA synchronous", 2)
        _lay_out(connection, path)
    except (sqlite3.Error, StorageError) as error:
        connection.close()
        raise StorageError(f"{path} cannot be opened for writing: {error}") from error
    return connection


def settle(path: Path) -> None:
    """Have SQLite end what a process was at when it died, which readers cannot.

    Raises:
        StorageError: it cannot be written.
    """
    try:
        with closing(sqlite3.connect(path, isolation_level=None)) as connection:
            connection.execute("PRAGMA user_version").fetchall()
    except sqlite3.Error as error:
        raise StorageError(f"{path} cannot be opened for writing: {error}") from error


def open_reader(path: Path) -> sqlite3.Connection:
    """Open the file without the right to change it.

    Raises:
        StorageError: the file is missing, damaged or newer, or may not be read.
    """
    if not is_file(path):
        raise StorageError(f"{path.parent} is not a run: it has no {path.name}")
    # A reader may not finish what SQLite was at, and need not: all that was stored is in the file either way.
    alone = "&immutable=1" if _mode_change_was_cut_short(path) else ""
    name = f"file:{quote(os.fsencode(path))}?mode=ro{alone}"
    connection = sqlite3.connect(name, uri=True, isolation_level=None)
    try:
        version = _version(connection, path)
        if version == 0:
            raise StorageError(f"{path} is not a finished run file: it has no tables")
    except (*UNREADABLE, StorageError) as error:
        connection.close()
        raise StorageError(f"{path} cannot be read: {error}") from error
    connection.row_factory = sqlite3.Row
    return connection


def _mode_change_was_cut_short(path: Path) -> bool:
    """Return whether a process has died while its log was given up at the end of a run, or was taken up again.

    That is the only change in SQLite's older mode, whose journal then holds the first page; the log is empty.
    """
    journal_bytes, log_bytes = (_size(Path(f"{path}-{kind}")) for kind in ("journal", "wal"))
    if not 0 < journal_bytes <= _JOURNAL_OF_ONE_PAGE_BYTES or log_bytes > 0:
        return False
    return not is_being_written(path.parent)


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0


def is_file(path: Path) -> bool:
    """Return whether there is a file.

    Raises:
        StorageError: the system does not let anybody look.
    """
    try:
        return path.is_file()
    except OSError as error:
        raise StorageError(f"{path} cannot be read: {error}") from error


def _require(connection: sqlite3.Connection, setting: str, question: str, expected: object) -> None:
    # A file system without the needed locks makes SQLite fall back silently; only reading back shows it.
    connection.execute(setting).fetchall()
    value = connection.execute(question).fetchone()[0]
    if value != expected:
        raise StorageError(f"{setting} was not taken (it reads {value!r}); use a local disk")


def _version(connection: sqlite3.Connection, path: Path) -> int:
    version: int = connection.execute("PRAGMA user_version").fetchone()[0]
    if version > VERSION:
        raise StorageError(
            f"{path} has format {version}, this program knows {VERSION}; install a newer catseye"
        )
    return version


def _lay_out(connection: sqlite3.Connection, path: Path) -> None:
    if _version(connection, path) < VERSION:
        guards = "".join(trigger for table in (*BASE_TABLES, CHUNKS) for trigger in append_only(table))
        connection.executescript(f"BEGIN IMMEDIATE;{_LAYOUT}{guards}PRAGMA user_version={VERSION};COMMIT;")
