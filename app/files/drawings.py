"""Tables that are drawn in TOML: segments that stand for rows."""

import math
from pathlib import Path
from typing import Final

import numpy as np
from pydantic import ValidationError
from pydantic_core import ErrorDetails

from catseye.app.errors import ConfigError, UsageError
from catseye.app.files.column_rules import LARGEST_NUMBER
from catseye.app.files.csv_lines import CsvRow
from catseye.app.files.documents import read_toml
from catseye.procedures.kit.columns import Columns, Drawing

SUFFIX: Final = ".toml"

_SHOWN_LENGTH: Final = 60
"""Of a wrong value."""


def drawn_columns(path: Path, drawing: type[Drawing]) -> Columns:
    """Read a drawing as the rows that it stands for.

    Raises:
        UsageError: the file is missing, is no TOML, or a segment is wrong; names file, segment and remedy.
    """
    try:
        columns = drawing.model_validate(read_toml(path)).columns()
    except ConfigError as error:
        raise UsageError(str(error)) from error
    except ValidationError as error:
        raise UsageError(f"{path}: {_complaint(error.errors()[0])}") from error
    for name, values in columns.values.items():
        if (wrong := np.flatnonzero(np.abs(values) > LARGEST_NUMBER)).size:
            number = columns.lines[wrong[0]]
            raise UsageError(f"{path}: segment {number}: {name} is more than {LARGEST_NUMBER:g}: correct it")
    return columns


def drawn_rows(path: Path, columns: Columns) -> list[CsvRow]:
    """Return rows of a drawing as text, as a CSV table of the same rows would hold them."""
    names = list(columns.values)
    return [
        CsvRow(path, int(number), {name: _text(value) for name, value in zip(names, row, strict=True)})
        for number, row in zip(columns.lines, columns.stacked(names).tolist(), strict=True)
    ]


def _text(value: float) -> str:
    # Six decimals are a nanometre; NaN is what a segment leaves open; adding 0.0 turns a rounded −0 into 0.
    return "" if math.isnan(value) else f"{round(value, 6) + 0.0:.6f}".rstrip("0").rstrip(".")


def _complaint(fault: ErrorDetails) -> str:
    where, keys = "", [part for part in fault["loc"] if not isinstance(part, int)]
    numbers = [part for part in fault["loc"] if isinstance(part, int)]
    if numbers and keys[:1] == ["segment"]:
        # Behind the number stands the kind, then the key.
        where, keys = f"segment {numbers[0] + 1}: ", keys[2:]
    key = str(keys[0]).removesuffix("_") if keys else "segment"
    match fault["type"]:
        case "value_error":
            return f"{where}{fault['msg'].removeprefix('Value error, ')}"
        case "missing":
            return f"{where}{key} is missing{_WANTED.get(key, '')}"
        case "extra_forbidden":
            return f"{where}{key} is not a valid key: see path files in docs/files.md"
        case "union_tag_invalid" | "union_tag_not_found":
            return f'{where}kind has to be "line", "arc" or "circle"'
    shown = repr(fault["input"])
    return f"{where}{key} = {shown[:_SHOWN_LENGTH]}: {fault['msg']}{_WANTED.get(key, '')}"


_WANTED: Final = {
    "segment": ': write [[segment]] tables with kind = "line", "arc" or "circle"',
    "points": "; it is how many rows the segment makes, both ends included",
    "from": "; write x and y in mm, as in from = [200.0, -400.0]",
    "to": "; write x and y in mm, as in to = [200.0, 400.0]",
    "centre": "; write x and y in mm, as in centre = [250.0, 0.0]",
    "via": "; write x and y in mm, as in via = [250.0, 0.0]",
}
