"""Rows of data as the tables hold them."""

import json
import math
import sqlite3
import zlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from catseye.procedures.kit.records import EXTRA, KEY, Column, Json, Row, Table

Value = None | int | float | str | bytes


def to_json(value: Json | Mapping[str, Json]) -> str:
    """Return compact JSON.

    Raises:
        ValueError: JSON cannot carry a value, or a number is not finite; the text says which.
    """
    try:
        text = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    except (TypeError, ValueError) as error:
        raise ValueError(next(_unfit(value, ""), str(error))) from None
    # Bytes of a path that are no UTF-8 stand as escapes, which JSON reads back as they were.
    return text.encode(errors="backslashreplace").decode()


def _unfit(value: object, place: str) -> Iterator[str]:
    """Say what of a value JSON cannot carry."""
    match value:
        case None | bool() | int() | str():
            return
        case float() if math.isfinite(value):
            return
        case dict():
            for key, each in value.items():
                yield from _unfit(each, f"{place}.{key}" if place else str(key))
        case list() | tuple():
            for number, each in enumerate(value):
                yield from _unfit(each, f"{place}[{number}]")
        case float():
            yield f"{place or 'a value'} = {value!r}: only a finite number can be kept"
        case _:
            yield f"{place or 'a value'} = {value!r} is a {type_name(value)}, which JSON cannot carry"


def type_name(value: object) -> str:
    """Return the name of the type of a value, with its module unless everybody knows it."""
    kind = type(value)
    return kind.__qualname__ if kind.__module__ == "builtins" else f"{kind.__module__}.{kind.__qualname__}"


def encode(table: Table, row: Row) -> tuple[Value, ...]:
    """Return the values of a row in the order of the table's columns, then the other keys as JSON.

    Raises:
        ValueError: a column is missing, has another type, or is not finite.
    """
    missing = [name for name in table.required if row.get(name) is None]
    if missing:
        raise ValueError(f"a row for {table.name} lacks {', '.join(missing)}; it has {', '.join(row)}")
    names = {column.name for column in table.columns}
    values = [_checked(table.name, column, row.get(column.name)) for column in table.columns]
    extra = {name: value for name, value in row.items() if name not in names}
    try:
        return (*values, to_json(extra))
    except ValueError as error:
        raise ValueError(f"{table.name}: {error}") from None


_COLUMNS: Final[Mapping[str, tuple[str, ...]]] = {
    "meta": ("key", "value"),
    "steps": ("step_id", "attempt", "title", "started_utc", "done_utc", "row_count", "result"),
    "events": ("seq", "time_utc", "kind", "data"),
    "prompts": ("seq", "id", "kind", "text", "asked_utc", "answered_utc", "answer", "who"),
    "chunks": ("step_id", "attempt", "recording", "seq", "readings", "data"),
}
_NUMBERED: Final = frozenset({"events", "prompts"})
"""Tables whose rows SQLite numbers, in `seq`."""


def insert(db: sqlite3.Connection, table: str, values: Sequence[Value]) -> None:
    """Insert one row, its values in the order of the table's columns."""
    _insert(db, table, _COLUMNS[table], values)


def insert_data(db: sqlite3.Connection, table: Table, key: Sequence[Value], values: Sequence[Value]) -> None:
    """Insert one row of data.

    Args:
        db: the run's file.
        key: step, attempt and number within the step.
        values: what `encode` returned.
    """
    # Named, since columns that were added to an older run stand behind its first ones.
    names = (*KEY, *(column.name for column in table.columns), EXTRA)
    _insert(db, table.name, names, (*key, *values))


def row_crc32(table: str, row: Mapping[str, Value]) -> int:
    """Return the check sum of a row as the journal keeps it.

    Args:
        row: its values by column; what is None does not count, since an upgrade adds columns to older rows.

    Raises:
        TypeError: a value has a type that is never stored.
        ValueError: a number is not finite.
    """
    numbered = {"seq"} if table in _NUMBERED else set()
    stored = {name: _plain(row[name]) for name in sorted(row.keys() - numbered) if row[name] is not None}
    return zlib.crc32(to_json(stored).encode())


def _plain(value: Value) -> int | float | str | None:
    """Return a value that JSON can carry; of bytes their own check sum."""
    return zlib.crc32(value) if isinstance(value, bytes) else value


def _insert(db: sqlite3.Connection, table: str, names: Sequence[str], values: Sequence[Value]) -> None:
    places = ", ".join("?" * len(names))
    columns = ", ".join(f'"{name}"' for name in names)
    stored = db.execute(f'INSERT INTO "{table}" ({columns}) VALUES ({places})', values)
    entry = (table, stored.lastrowid, row_crc32(table, dict(zip(names, values, strict=True))))
    db.execute("INSERT INTO journal (of, row, crc32) VALUES (?, ?, ?)", entry)


def _checked(table: str, column: Column, value: Json) -> Value:
    match column.kind, value:
        case _, None:
            return None
        case "REAL", int() | float() if not isinstance(value, bool) and math.isfinite(value):
            # Nor does SQLite keep the sign of a zero, and the check sum is of what it gives back.
            return float(value) + 0.0
        case "INTEGER", int() if not isinstance(value, bool):
            return value
        case "TEXT", str():
            return value
    # SQLite would store NaN as NULL: a value would vanish without a word.
    wanted = {"REAL": "a finite number", "INTEGER": "an int", "TEXT": "a str"}[column.kind]
    raise ValueError(f"{table}.{column.name} = {value!r} is a {type_name(value)}: it takes {wanted}")
