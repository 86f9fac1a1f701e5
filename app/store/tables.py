"""Tables of data: declared by record types, and read back from SQLite's own schema.

A table has the key of a row (step, attempt, number), the columns of its records, and `extra`: further values as JSON.
"""

import sqlite3
from collections.abc import Iterable
from typing import Final, get_args

from catseye.app.errors import StorageError
from catseye.app.store.schema import BASE_TABLES, CHUNKS, append_only
from catseye.procedures.kit.records import EXTRA, KEY, OBSERVATIONS, Column, ColumnKind, Table

_KINDS: Final = {kind: kind for kind in get_args(ColumnKind)}


def tables_in(db: sqlite3.Connection) -> dict[str, Table]:
    """Return the tables of data of a run by name, in the order of their making.

    Raises:
        LookupError: a column has a type that is never stored.
        ValueError: a table or column has a name that is never given.
    """
    return {name: Table(name, _columns(db, name)) for name in _names(db)}


def declare(db: sqlite3.Connection, tables: Iterable[Table]) -> dict[str, Table]:
    """Make the tables and columns that a run does not have yet; return all that it has then, by name.

    Args:
        db: the run's file.
        tables: that fit those of the run; see `require_fitting`.
    """
    known = tables_in(db)
    for table in tables:
        if table.name not in known:
            _make(db, table)
        else:
            _complete(db, known[table.name], table)
    return tables_in(db)


def require_fitting(known: Iterable[Table], tables: Iterable[Table]) -> None:
    """Check that a run of an earlier program can take what is to be stored.

    Args:
        known: tables of the run.
        tables: of what is to be stored.

    Raises:
        StorageError: a table has other columns than it would have now.
    """
    stored = {table.name: table for table in known}
    for table in tables:
        columns = {*stored.get(table.name, table).columns}
        lacking = {*table.columns} - columns
        if any(column.required for column in lacking) or not columns <= {*table.columns}:
            raise StorageError(
                f"the run's table {table.name} has other columns than this program stores; go on with the version "
                "that began the run, or start a new run"
            )


def measured_rows(db: sqlite3.Connection) -> int:
    """Return how many rows a run has of what it measures: those of its first table that is not empty."""
    tables = [name for name in _names(db) if name != OBSERVATIONS.name]
    counts = (int(db.execute(f'SELECT count(*) FROM "{name}"').fetchone()[0]) for name in tables)
    return next(filter(None, counts), 0)


def _names(db: sqlite3.Connection) -> list[str]:
    found = db.execute("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY rowid").fetchall()
    return [name for (name,) in found if name not in {*BASE_TABLES, CHUNKS}]


def _columns(db: sqlite3.Connection, name: str) -> tuple[Column, ...]:
    facts = db.execute('SELECT name, type, "notnull" FROM pragma_table_info(?)', (name,)).fetchall()
    return tuple(
        Column(column, _KINDS[kind], required=bool(required))
        for column, kind, required in facts
        if column not in {*KEY, EXTRA}
    )


def _make(db: sqlite3.Connection, table: Table) -> None:
    columns = "".join(f"{_definition(column)}, " for column in table.columns)
    db.execute(
        f'CREATE TABLE "{table.name}" (step_id TEXT NOT NULL, attempt INTEGER NOT NULL, seq INTEGER NOT NULL, '
        f"{columns}extra TEXT NOT NULL CHECK (json_valid(extra)), PRIMARY KEY (step_id, attempt, seq)) STRICT"
    )
    for trigger in append_only(table.name):
        db.execute(trigger)


def _complete(db: sqlite3.Connection, known: Table, table: Table) -> None:
    """Add the columns that a table of an earlier program lacks."""
    names = {column.name for column in known.columns}
    for column in (column for column in table.columns if column.name not in names):
        db.execute(f'ALTER TABLE "{table.name}" ADD COLUMN {_definition(column)}')


def _definition(column: Column) -> str:
    # Quoted, since a name that says what it is may be a word of SQL: index, order.
    return f'"{column.name}" {column.kind}{" NOT NULL" if column.required else ""}'
