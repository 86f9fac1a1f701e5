"""Rows of data as the tables hold them."""

import json
import math
import sqlite3
import zlib
from collections.abc import Mapping, Sequence
from typing import Final

from catseye.procedures.kit.context import Table
from catseye.procedures.kit.records import Json, Row

_POINTS_REQUIRED = {
    "reflector": str,
    "segment": int,
    "theta1_deg": float,
    "theta2_deg": float,
    "j3_mm": float,
    "j4_deg": float,
    "reported1_deg": float,
    "reported2_deg": float,
    "reported3_mm": float,
    "reported4_deg": float,
    "direction1": int,
    "direction2": int,
    "displacement_mm": float,
    "spread_mm": float,
    "readings": int,
    "signal": float,
    "time_utc": str,
    "duration_s": float,
}  # fmt: skip - one physical group a line
_PATH_REQUIRED = {
    "x_mm": float,
    "y_mm": float,
    "theta1_deg": float,
    "theta2_deg": float,
    "direction1": int,
    "direction2": int,
}  # fmt: skip - one physical group a line

REQUIRED: Final[Mapping[Table, Mapping[str, type]]] = {
    "points": _POINTS_REQUIRED,
    "search": {"reflector": str, "theta1_deg": float, "theta2_deg": float},
    "path": _PATH_REQUIRED,
    "records": {"kind": str},
}
"""Columns that every row has."""

OPTIONAL: Final[Mapping[Table, Mapping[str, type]]] = {
    "points": {
        "temperature_c": float,
        "pressure_hpa": float,
        "humidity_percent": float,
        "raw_displacement_mm": float,
        "refractive_index": float,
        "zero_refractive_index": float,
        "dead_path_mm": float,
        "formula": str,
    },
    "search": {"j4_deg": float, "lower_deg": float, "upper_deg": float, "signal": float},
    "path": {"x_meas_mm": float, "y_meas_mm": float, "u_mm": float},
    "records": {},
}
"""Columns that may be None or left out."""

Value = None | int | float | str


def to_json(value: Json | Mapping[str, Json]) -> str:
    """Return compact JSON.

    Raises:
        ValueError: a number is not finite; it could not be read back everywhere.
    """
    text = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    # Bytes of a path that are no UTF-8 stand as escapes, which JSON reads back as they were.
    return text.encode(errors="backslashreplace").decode()


def encode(table: Table, row: Row) -> tuple[Value, ...]:
    """Return the values of a row in the order of the table's columns, then the other keys as JSON.

    Raises:
        ValueError: a column is missing, has another type, or is not finite.
    """
    missing = [name for name in REQUIRED[table] if row.get(name) is None]
    if missing:
        raise ValueError(f"a row for {table} lacks {', '.join(missing)}; it has {', '.join(row)}")
    kinds = {**REQUIRED[table], **OPTIONAL[table]}
    values = [_checked(table, name, kind, row.get(name)) for name, kind in kinds.items()]
    extra = {name: value for name, value in row.items() if name not in kinds}
    return (*values, to_json(extra))


_COLUMNS: Final[Mapping[str, tuple[str, ...]]] = {
    "meta": ("key", "value"),
    "steps": ("step_id", "attempt", "title", "started_utc", "done_utc", "row_count", "result"),
    "events": ("seq", "time_utc", "kind", "data"),
    "prompts": ("seq", "id", "kind", "text", "asked_utc", "answered_utc", "answer", "who"),
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
        table: which table.
        key: step, attempt and number within the step.
        values: what `encode` returned.
    """
    # Named, since columns that came with an upgrade stand behind the older ones.
    names = ("step_id", "attempt", "seq", *REQUIRED[table], *OPTIONAL[table], "extra")
    _insert(db, table, names, (*key, *values))


def row_crc32(table: str, row: Mapping[str, Value]) -> int:
    """Return the check sum of a row as the journal keeps it.

    Args:
        table: where it stands.
        row: its values by column; what is None does not count, since an upgrade adds columns to older rows.

    Raises:
        TypeError: a value has a type that is never stored.
        ValueError: a number is not finite.
    """
    numbered = {"seq"} if table in _NUMBERED else set()
    told = {name: row[name] for name in sorted(row.keys() - numbered) if row[name] is not None}
    return zlib.crc32(to_json(told).encode())


def _insert(db: sqlite3.Connection, table: str, names: Sequence[str], values: Sequence[Value]) -> None:
    places = ", ".join("?" * len(names))
    stored = db.execute(f"INSERT INTO {table} ({', '.join(names)}) VALUES ({places})", values)
    entry = (table, stored.lastrowid, row_crc32(table, dict(zip(names, values, strict=True))))
    db.execute("INSERT INTO journal (of, row, crc32) VALUES (?, ?, ?)", entry)


def _checked(table: str, name: str, kind: type, value: Json) -> Value:
    if value is None:
        return None
    if kind is float and isinstance(value, int | float) and not isinstance(value, bool):
        # SQLite would store NaN as NULL: a value would vanish without a word.
        if math.isfinite(value):
            # Nor does it keep the sign of a zero, and the check sum is of what it gives back.
            return float(value) + 0.0
    elif kind is not float and type(value) is kind and isinstance(value, int | str):
        return value
    raise ValueError(f"{table}.{name} = {value!r} is not a usable {kind.__name__}")
