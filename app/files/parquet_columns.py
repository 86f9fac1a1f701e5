"""Parquet tables as columns."""

import importlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from catseye.app.errors import ConfigError, UsageError
from catseye.app.files.attached import attached_metadata
from catseye.app.files.column_rules import Form, doubled_fault, first_fault, form_of, places_among
from catseye.app.files.csv_lines import require_file
from catseye.calibration.core.types import Floats
from catseye.procedures.kit.columns import ColumnRule, Columns, Kind, TableRule

_BATCH_ROWS = 50_000


def parquet_blocks(path: Path, table: TableRule, names: tuple[str, ...]) -> Iterator[tuple[float, Columns]]:
    """Read a Parquet table block by block; see `columns.table_blocks`."""
    with _opened(path) as file:
        form = _parquet_form(path, table, file.schema_arrow.names)
        attached = attached_metadata(file.schema_arrow.metadata or {})
        total, read = max(file.metadata.num_rows, 1), 0
        for batch in file.iter_batches(_BATCH_ROWS, columns=[column.name for column in form]):
            block = replace(_batch_columns(batch, form, read + 1, names), attached=attached)
            if fault := first_fault(form, block):
                row, column = fault
                value = batch.column(column.name)[row].as_py()
                raise UsageError(
                    f"{path}: row {read + row + 1}: {column.name} = {value!r} cannot be; "
                    f"it has to be {_wanted(column, names)}"
                )
            read += len(block)
            yield read / total, block


def parquet_rows(path: Path) -> int:
    """Return the number of rows of a Parquet table.

    Raises:
        UsageError: the file is missing or no Parquet.
        ConfigError: the extra package is not installed.
    """
    with _opened(path) as file:
        return int(file.metadata.num_rows)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    try:
        parquet = importlib.import_module("pyarrow.parquet")
    except ImportError as error:
        raise ConfigError("Parquet needs an extra package: pip install 'catseye[parquet]'") from error
    # Parquet is read from its end, which a pipe does not have.
    require_file(path)
    try:
        with parquet.ParquetFile(path) as file:
            yield file
    except (OSError, ValueError, NotImplementedError) as error:
        # The last one is how pyarrow says that a column of lists or tables is none of numbers.
        raise UsageError(f"{path}: cannot be read as Parquet: {error}") from error


def _wanted(column: ColumnRule, names: tuple[str, ...]) -> str:
    if column.kind == "name":
        return f"one of {', '.join(names)}"
    return column.wanted + (
        "" if column.largest is None else f" and at most {column.largest:g} {column.unit}"
    )


def _parquet_form(path: Path, table: TableRule, present: Sequence[str]) -> Form:
    form = form_of(table, present)
    missing = [column.name for column in form if not column.optional and column.name not in present]
    if missing:
        faults = [text for name, text in table.misplaced if name in present]
        faults.append(f"column {', '.join(missing)} is missing")
        raise UsageError(f"{path}: {faults[0]}")
    if fault := doubled_fault(form, present):
        raise UsageError(f"{path}: {fault}")
    return tuple(column for column in form if column.name in present)


def _batch_columns(batch: Any, form: Form, first_row: int, names: tuple[str, ...]) -> Columns:
    values = {column.name: _batch_values(batch.column(column.name), column.kind, names) for column in form}
    return Columns(values, np.arange(first_row, first_row + batch.num_rows), names)


def _batch_values(array: Any, kind: Kind, names: tuple[str, ...]) -> Floats:
    """Return an array of Arrow as numbers; values that are missing become NaN, which no rule lets pass."""
    if kind != "name":
        return np.asarray(array.cast("double").to_numpy(zero_copy_only=False), dtype=np.float64)
    found = array.cast("string").dictionary_encode()
    # A name that is missing has the place -1: what stands last.
    places = np.append(places_among(np.array(found.dictionary.to_pylist(), dtype=np.str_), names), -1.0)
    indices = np.asarray(found.indices.to_numpy(zero_copy_only=False), dtype=np.float64)
    return places[np.nan_to_num(indices, nan=-1.0).astype(np.int64)]
