"""Layout of run.sqlite, its version, and how a connection is opened."""

import os
import sqlite3
from pathlib import Path
from urllib.parse import quote

from catseye.app.errors import StorageError

_FIRST = """
CREATE TABLE meta (
    key TEXT PRIMARY KEY, value TEXT NOT NULL CHECK (json_valid(value))
) STRICT;
CREATE TABLE steps (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, title TEXT NOT NULL,
    started_utc TEXT NOT NULL, done_utc TEXT NOT NULL, row_count INTEGER NOT NULL,
    result TEXT NOT NULL CHECK (json_valid(result)),
    PRIMARY KEY (step_id, attempt)
) STRICT;
CREATE TABLE points (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, seq INTEGER NOT NULL,
    reflector TEXT NOT NULL, segment INTEGER NOT NULL,
    theta1_deg REAL NOT NULL, theta2_deg REAL NOT NULL, j3_mm REAL NOT NULL, j4_deg REAL NOT NULL,
    reported1_deg REAL NOT NULL, reported2_deg REAL NOT NULL,
    reported3_mm REAL NOT NULL, reported4_deg REAL NOT NULL,
    direction1 INTEGER NOT NULL, direction2 INTEGER NOT NULL,
    displacement_mm REAL NOT NULL, spread_mm REAL NOT NULL, readings INTEGER NOT NULL, signal REAL NOT NULL,
    time_utc TEXT NOT NULL, duration_s REAL NOT NULL,
    temperature_c REAL, pressure_hpa REAL, humidity_percent REAL,
    extra TEXT NOT NULL CHECK (json_valid(extra)),
    PRIMARY KEY (step_id, attempt, seq)
) STRICT;
CREATE TABLE search (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, seq INTEGER NOT NULL,
    reflector TEXT NOT NULL, theta1_deg REAL NOT NULL, theta2_deg REAL NOT NULL,
    j4_deg REAL, lower_deg REAL, upper_deg REAL, signal REAL,
    extra TEXT NOT NULL CHECK (json_valid(extra)),
    PRIMARY KEY (step_id, attempt, seq)
) STRICT;
CREATE TABLE path (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, seq INTEGER NOT NULL,
    x_mm REAL NOT NULL, y_mm REAL NOT NULL, theta1_deg REAL NOT NULL, theta2_deg REAL NOT NULL,
    direction1 INTEGER NOT NULL, direction2 INTEGER NOT NULL,
    x_meas_mm REAL, y_meas_mm REAL, u_mm REAL,
    extra TEXT NOT NULL CHECK (json_valid(extra)),
    PRIMARY KEY (step_id, attempt, seq)
) STRICT;
CREATE TABLE events (
    seq INTEGER PRIMARY KEY, time_utc TEXT NOT NULL, kind TEXT NOT NULL,
    data TEXT NOT NULL CHECK (json_valid(data))
) STRICT;
CREATE TABLE prompts (
    seq INTEGER PRIMARY KEY, id TEXT NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL,
    asked_utc TEXT NOT NULL, answered_utc TEXT, answer TEXT, who TEXT
) STRICT;
"""

_FIRST_TABLES = ("meta", "steps", "points", "search", "path", "events", "prompts")


def _guards(*tables: str) -> str:
    """Return triggers that keep tables append-only."""
    return "".join(
        f"CREATE TRIGGER IF NOT EXISTS {table}_no_{verb.lower()} BEFORE {verb} ON {table} "
        f"BEGIN SELECT RAISE(ABORT, '{table} is append-only'); END;\n"
        for table in tables
        for verb in ("UPDATE", "DELETE")
    )


RAW_TABLES = (*_FIRST_TABLES, "records", "journal")
"""All tables: the whole record is append-only."""

_COMPENSATION = """
ALTER TABLE points ADD COLUMN raw_displacement_mm REAL;
ALTER TABLE points ADD COLUMN refractive_index REAL;
ALTER TABLE points ADD COLUMN zero_refractive_index REAL;
ALTER TABLE points ADD COLUMN dead_path_mm REAL;
ALTER TABLE points ADD COLUMN formula TEXT;
"""

_RECORDS = """
CREATE TABLE records (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, seq INTEGER NOT NULL,
    kind TEXT NOT NULL,
    extra TEXT NOT NULL CHECK (json_valid(extra)),
    PRIMARY KEY (step_id, attempt, seq)
) STRICT;
"""

_JOURNAL = """
CREATE TABLE IF NOT EXISTS journal (
    place INTEGER PRIMARY KEY, of TEXT NOT NULL, row INTEGER NOT NULL, crc32 INTEGER NOT NULL,
    UNIQUE (of, row)
) STRICT;
"""
"""Every row in the order of its being stored, with a check sum: clocks jump, and bits flip."""

UPGRADES: tuple[str, ...] = (
    _FIRST + _guards(*_FIRST_TABLES),
    _COMPENSATION,
    _RECORDS + _guards("records"),
    _JOURNAL + _guards("journal"),
)
"""UPGRADES[n] takes a file of version n to version n + 1; an empty file has version 0."""

VERSION = len(UPGRADES)
"""`user_version` of a file that this program writes."""


LAST_OPENED_OR_ENDED = """
SELECT kind, data FROM events WHERE kind IN ('run-opened', 'run-reopened', 'run-ended') ORDER BY seq DESC LIMIT 1
"""
"""What says how a run ended, or that it has not."""

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
        _upgrade(connection, path)
    except (sqlite3.Error, StorageError) as error:
        connection.close()
        raise StorageError(f"{path} cannot be opened for writing: {error}") from error
    return connection


def open_reader(path: Path) -> sqlite3.Connection:
    """Open the file without the right to change it.

    Raises:
        StorageError: the file is missing, damaged or newer, or may not be read.
    """
    if not is_file(path):
        raise StorageError(f"{path.parent} is not a run: it has no {path.name}")
    connection = sqlite3.connect(f"file:{quote(os.fsencode(path))}?mode=ro", uri=True, isolation_level=None)
    try:
        version = _version(connection, path)
        if version == 0:
            raise StorageError(f"{path} is not a finished run file: it has no tables")
    except (*UNREADABLE, StorageError) as error:
        connection.close()
        raise StorageError(f"{path} cannot be read: {error}") from error
    connection.row_factory = sqlite3.Row
    return connection


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


def _upgrade(connection: sqlite3.Connection, path: Path) -> None:
    for version in range(_version(connection, path), VERSION):
        connection.executescript(
            f"BEGIN IMMEDIATE;{UPGRADES[version]}PRAGMA user_version={version + 1};COMMIT;"
        )
