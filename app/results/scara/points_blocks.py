"""Points files of any length, CSV or Parquet, block by block."""

import importlib
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from catseye.app.errors import ConfigError, UsageError
from catseye.app.files.csv_table import (
    LONGEST_LINE,
    csv_row,
    header_of,
    is_talk,
    named_faults,
    require_file,
    require_line,
)
from catseye.app.results.scara.point_columns import PointColumns, columns_of
from catseye.app.results.scara.points import COLUMNS, LARGEST_SEGMENT, point_row, require_columns
from catseye.calibration.core.types import Floats, Ints

_CHUNK_BYTES = 4_000_000
"""Some 50 000 lines."""

_BATCH_ROWS = 50_000


def points_blocks(path: Path, known: Sequence[str]) -> Iterator[tuple[float, PointColumns]]:
    """Read a points file.

    Args:
        path: the file; .parquet is Parquet, anything else CSV.
        known: names of the reflectors of the cell file.

    Yields:
        The share of the file that is read, and the distances of a block.

    Raises:
        UsageError: the file is missing, a column is missing, a value is wrong; names file and line.
        ConfigError: Parquet needs a package that is not installed.
    """
    if path.suffix == ".parquet":
        yield from _parquet_blocks(path, known)
    else:
        yield from _csv_blocks(path, known)


def _csv_blocks(path: Path, known: Sequence[str]) -> Iterator[tuple[float, PointColumns]]:
    header: list[str] = []
    for line, text, share in _chunks(path):
        below, number = text, line
        while not header and below:
            first, _, below = below.partition("\n")
            if not is_talk(first):
                header = header_of(path, number, first)
                require_columns(path, number, header)
            number += 1
        if below:
            clean = _clean_columns(below, header, known)
            yield share, clean if clean is not None else _checked_columns(path, number, below, header, known)
    if not header:
        raise UsageError(f"{path}: is empty; the first line has to be the header {','.join(COLUMNS)}")


def _chunks(path: Path) -> Iterator[tuple[int, str, float]]:
    """Return whole lines: the number of the first, the text, and the share of the file that is read."""
    with named_faults(path), path.open("rb") as stream:
        yield from _whole_lines(path, stream, max(path.stat().st_size, 1))


def _whole_lines(path: Path, stream: BinaryIO, size: int) -> Iterator[tuple[int, str, float]]:
    line, rest, read, encoding = 1, b"", 0, "utf-8-sig"
    while chunk := stream.read(_CHUNK_BYTES):
        read += len(chunk)
        whole, newline, rest = (rest + chunk).rpartition(b"\n")
        if newline:
            text = _checked_text(path, line, whole + newline, encoding)
            # A pipe has no size.
            yield line, text, min(read / size, 1.0)
            line, encoding = line + text.count("\n"), "utf-8"
        if len(rest) > 4 * LONGEST_LINE:
            require_line(path, line, rest.decode(encoding, "surrogateescape"))
    if rest:
        yield line, _checked_text(path, line, rest, encoding), 1.0


def _checked_text(path: Path, first_line: int, raw: bytes, encoding: str) -> str:
    text = raw.decode(encoding, "surrogateescape")
    if not text.isascii() or "\0" in text:
        for number, line in enumerate(text.split("\n"), first_line):
            require_line(path, number, line)
    return text


def _clean_columns(text: str, header: list[str], known: Sequence[str]) -> PointColumns | None:
    """Return lines as columns at once; None when a line is not of plain numbers and known names."""
    if "#" in text or '"' in text:
        return None
    width = 1 + max(len(name) for name in known)
    kinds = {"reflector": f"U{width}", "segment": "i8"}
    table = np.dtype([(name, kinds.get(name, "f8")) for name in header])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            rows = np.loadtxt(text.splitlines(), table, comments=None, delimiter=",", ndmin=1)
    except (ValueError, Warning):
        return None
    columns = PointColumns(
        _index(rows["reflector"], known),
        rows["segment"],
        rows["theta1_deg"],
        rows["theta2_deg"],
        rows["direction1"],
        rows["direction2"],
        rows["displacement_mm"],
        rows["sigma_mm"] if "sigma_mm" in header else None,
    )
    return None if columns.first_fault() else columns


def _index(names: Any, known: Sequence[str]) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    index = np.full(names.size, -1, dtype=np.int64)
    for i, name in enumerate(known):
        index[names == name] = i
    return index


def _checked_columns(
    path: Path, first_line: int, text: str, header: list[str], known: Sequence[str]
) -> PointColumns:
    """Return lines as columns, each checked by itself: what is wrong is told with its line."""
    names = list(known)
    rows = [
        point_row(csv_row(path, number, line, header), names)
        for number, line in enumerate(text.splitlines(), first_line)
        if not is_talk(line)
    ]
    return columns_of(rows, known, with_sigma="sigma_mm" in header)


def _parquet_blocks(path: Path, known: Sequence[str]) -> Iterator[tuple[float, PointColumns]]:
    try:
        parquet = importlib.import_module("pyarrow.parquet")
    except ImportError as error:
        raise ConfigError("Parquet needs an extra package: pip install 'catseye[parquet]'") from error
    # Parquet is read from its end, which a pipe does not have.
    require_file(path)
    try:
        with parquet.ParquetFile(path) as file:
            present = file.schema_arrow.names
            missing = [name for name in COLUMNS if name not in present]
            if missing:
                raise UsageError(f"{path}: column {', '.join(missing)} is missing")
            wanted = [*COLUMNS, *(["sigma_mm"] if "sigma_mm" in present else [])]
            total, read = max(file.metadata.num_rows, 1), 0
            for batch in file.iter_batches(_BATCH_ROWS, columns=wanted):
                columns = _batch_columns(batch, known)
                if fault := columns.first_fault():
                    row, name = fault
                    raise UsageError(
                        f"{path}: row {read + row + 1}: {name} = {batch.column(name)[row].as_py()!r} cannot be; "
                        f"reflectors are {', '.join(known)}, segments integers, directions 1 or -1, numbers finite, "
                        "sigma_mm above 0"
                    )
                read += len(columns)
                yield read / total, columns
    except (OSError, ValueError, NotImplementedError) as error:
        # The last one is how pyarrow says that a column of lists or tables is none of numbers.
        raise UsageError(f"{path}: cannot be read as Parquet: {error}") from error


def _batch_columns(batch: Any, known: Sequence[str]) -> PointColumns:
    names = batch.column("reflector").cast("string").dictionary_encode()
    # A name that is missing has the place -1: what stands last.
    index = np.append(_index(np.array(names.dictionary.to_pylist(), dtype=np.str_), known), -1)
    # Values that are missing become NaN, which no check lets pass.
    numbers = {
        name: np.asarray(batch.column(name).cast("double").to_numpy(zero_copy_only=False), dtype=np.float64)
        for name in batch.schema.names
        if name != "reflector"
    }
    places = np.nan_to_num(
        np.asarray(names.indices.to_numpy(zero_copy_only=False), dtype=np.float64), nan=-1.0
    )
    return PointColumns(
        index[places.astype(np.int64)],
        _segments(numbers["segment"]),
        numbers["theta1_deg"],
        numbers["theta2_deg"],
        numbers["direction1"],
        numbers["direction2"],
        numbers["displacement_mm"],
        numbers.get("sigma_mm"),
    )


def _segments(numbers: Floats) -> Ints:
    """Return numbers as integers; what is none becomes one that no check lets pass."""
    whole = np.abs(numbers) <= LARGEST_SEGMENT
    whole[whole] = np.floor(numbers[whole]) == numbers[whole]
    return np.where(whole, numbers, 2.0 * LARGEST_SEGMENT).astype(np.int64)
