"""Tables of any length, CSV or Parquet, as columns that are checked by the rules of their declaration."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.csv_columns import csv_blocks, csv_blocks_of_text
from catseye.app.files.csv_lines import CsvRow, require_file
from catseye.app.files.drawings import SUFFIX, drawn_columns, drawn_rows
from catseye.app.files.mapped_table import read_mapped
from catseye.app.files.parquet_columns import parquet_blocks
from catseye.procedures.kit.columns import Columns, TableRule
from catseye.procedures.kit.mapping import TableMapping


def read_table(path: Path, table: TableRule, names: Sequence[str] = ()) -> Columns:
    """Read a whole table; arguments and errors are those of `table_blocks`."""
    return _joined([block for _, block in table_blocks(path, table, names)])


def read_typed_table(file: str, table: TableRule | TableMapping) -> Columns:
    """Read a whole table from a file as somebody typed it.

    Raises:
        UsageError: as for `table_blocks`, or it is no regular file, or ~ stands for no folder.
    """
    try:
        path = Path(file.strip()).expanduser().absolute()
    except RuntimeError as error:
        raise UsageError(f"{file}: {error}; type the whole path") from error
    require_file(path)
    if isinstance(table, TableRule):
        return read_table(path, table)
    return read_mapped(path, table)


def table_blocks(path: Path, table: TableRule, names: Sequence[str] = ()) -> Iterator[tuple[float, Columns]]:
    """Read a table block by block, some 50 000 rows at a time.

    Args:
        path: the file; .parquet is Parquet, .toml a drawing where the table knows one, anything else CSV.
        names: that a column of names may hold, each once.

    Yields:
        The share of the file that is read, and a block of rows.

    Raises:
        UsageError: the file is missing or holds no rows, a column is missing, a value is wrong; names file and line.
        ConfigError: Parquet needs a package that is not installed.
    """
    if table.drawing is not None and path.suffix == SUFFIX:
        yield 1.0, drawn_columns(path, table.drawing)
        return
    read = parquet_blocks if path.suffix == ".parquet" else csv_blocks
    rows = 0
    for share, block in read(path, table, tuple(names)):
        rows += len(block)
        yield share, block
    if not rows:
        raise _without_rows(path, table)


def read_rows(path: Path, table: TableRule, names: Sequence[str] = ()) -> tuple[list[CsvRow], Columns]:
    """Read a CSV table, or a drawing, with the text of its cells.

    Args:
        names: as for `table_blocks`.

    Raises:
        UsageError: as for `table_blocks`.
    """
    if table.drawing is not None and path.suffix == SUFFIX:
        columns = drawn_columns(path, table.drawing)
        return drawn_rows(path, columns), columns
    rows: list[CsvRow] = []
    blocks: list[Columns] = []
    for found, block in csv_blocks_of_text(path, table, tuple(names)):
        rows += found
        blocks.append(block)
    if not rows:
        raise _without_rows(path, table)
    return rows, _joined(blocks)


def _joined(blocks: Sequence[Columns]) -> Columns:
    filled = [block for block in blocks if len(block)]
    values = {name: np.concatenate([block[name] for block in filled]) for name in filled[0].values}
    lines = np.concatenate([block.lines for block in filled])
    return replace(filled[0], values=values, lines=lines)


def _without_rows(path: Path, table: TableRule) -> UsageError:
    return UsageError(f"{path}: holds no {table.holds}; each row below the header line is {table.row}")
