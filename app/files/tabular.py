"""Rows of one table as CSV or Parquet; columns that a row lacks stay empty."""

import importlib
import io
import json
from collections.abc import Mapping, Sequence

from catseye.app.errors import ConfigError
from catseye.app.files.csv_text import csv_text

Row = Mapping[str, object]
Cell = str | int | float | bool | None


def columns(rows: Sequence[Row]) -> list[str]:
    """Return the names of all columns in the order in which they first appear."""
    return list(dict.fromkeys(name for row in rows for name in row))


def table_csv(rows: Sequence[Row]) -> str:
    """Return rows as CSV with a header line; numbers keep their full precision, lists become JSON."""
    names = columns(rows)
    return csv_text(names, ([_cell(row.get(name)) for name in names] for row in rows))


def table_parquet(rows: Sequence[Row], about: Mapping[str, object] | None = None) -> bytes:
    """Return rows as Parquet; a column that holds texts and numbers holds texts.

    Args:
        rows: by name of the column; columns that a row lacks stay empty.
        about: what stands in the metadata of the schema, as JSON by name.

    Raises:
        ConfigError: the extra package is not installed.
    """
    try:
        pyarrow = importlib.import_module("pyarrow")
        parquet = importlib.import_module("pyarrow.parquet")
    except ImportError as error:
        raise ConfigError("Parquet needs an extra package: pip install 'catseye[parquet]'") from error
    arrays = {name: pyarrow.array(_column(rows, name)) for name in columns(rows)}
    buffer = io.BytesIO()
    metadata = {name: json.dumps(value, ensure_ascii=False) for name, value in (about or {}).items()}
    parquet.write_table(pyarrow.table(arrays).replace_schema_metadata(metadata or None), buffer)
    written: bytes = buffer.getvalue()
    return written


def _column(rows: Sequence[Row], name: str) -> list[Cell]:
    cells = [_cell(row.get(name)) for row in rows]
    if any(isinstance(cell, str) for cell in cells):
        return [None if cell is None else str(cell) for cell in cells]
    if any(isinstance(cell, float) for cell in cells):
        return [None if cell is None else float(cell) for cell in cells]
    return cells


def _cell(value: object) -> Cell:
    if value is None or isinstance(value, str | int | float):
        return value
    return json.dumps(value, ensure_ascii=False)
