"""Points CSV: one distance a row, in measuring order (version 1)."""

import csv
import io
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from app.errors import UsageError
from calibration.points import Commands, Points

T = TypeVar("T")

COLUMNS = (
    "reflector",
    "segment",
    "theta1_deg",
    "theta2_deg",
    "direction1",
    "direction2",
    "displacement_mm",
)
OPTIONAL = ("sigma_mm",)


@dataclass(frozen=True)
class PointRow:
    """One distance.

    Attributes:
        reflector: name.
        segment: number of the unbroken stretch; each has a dead path of its own.
        theta1_deg: J1 command.
        theta2_deg: J2 command.
        direction1: state of approach of J1, 1 or -1.
        direction2: state of approach of J2, 1 or -1.
        displacement_mm: relative to the segment's zero.
        sigma_mm: standard uncertainty; None when not stated.
    """

    reflector: str
    segment: int
    theta1_deg: float
    theta2_deg: float
    direction1: int
    direction2: int
    displacement_mm: float
    sigma_mm: float | None


def points_csv(rows: Iterable[PointRow]) -> str:
    """Return the text of a points file; numbers keep their full precision."""
    table = list(rows)
    with_sigma = any(row.sigma_mm is not None for row in table)
    names = COLUMNS + (OPTIONAL if with_sigma else ())
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([getattr(row, name) for name in names] for row in table)
    return out.getvalue()


def read_points_csv(path: Path, reflectors: Iterable[str]) -> list[PointRow]:
    """Read a points file.

    Args:
        path: the file.
        reflectors: names that the cell file knows.

    Raises:
        UsageError: the file is missing, a column is missing, a value is wrong; names file and line.
    """
    known = list(reflectors)
    rows = [_row(path, line, record, known) for line, record in _records(path)]
    if not rows:
        raise UsageError(f"{path}: holds no points; each row below the header line is one distance")
    return rows


def to_points(rows: list[PointRow], reflectors: Iterable[str]) -> Points:
    """Return rows as columns; reflectors in the order of the cell file."""
    present = {row.reflector for row in rows}
    names = tuple(name for name in reflectors if name in present)
    paths = tuple(dict.fromkeys((row.reflector, row.segment) for row in rows))
    path_index = {key: i for i, key in enumerate(paths)}
    sigma = [row.sigma_mm for row in rows]
    commands = Commands(
        np.deg2rad([row.theta1_deg for row in rows]),
        np.deg2rad([row.theta2_deg for row in rows]),
        np.array([row.direction1 for row in rows], dtype=np.int64),
        np.array([row.direction2 for row in rows], dtype=np.int64),
    )
    return Points(
        commands=commands,
        reflector=np.array([names.index(row.reflector) for row in rows], dtype=np.int64),
        dead_path=np.array([path_index[row.reflector, row.segment] for row in rows], dtype=np.int64),
        displacement_mm=np.array([row.displacement_mm for row in rows]),
        sigma_mm=None if None in sigma else np.array(sigma, dtype=np.float64),
        reflector_names=names,
        dead_paths=paths,
    )


def _records(path: Path) -> Iterator[tuple[int, Mapping[str, str]]]:
    lines = _lines(path)
    header: list[str] | None = None
    for number, line in lines:
        cells = _cells(path, number, line)
        if header is None:
            header = [cell.strip() for cell in cells]
            _require_columns(path, number, header)
            continue
        if len(cells) != len(header):
            raise UsageError(
                f"{path}:{number}: {len(cells)} values, but the header has {len(header)} columns"
            )
        yield number, {name: cell.strip() for name, cell in zip(header, cells, strict=True)}
    if header is None:
        raise UsageError(f"{path}: is empty; the first line has to be the header {','.join(COLUMNS)}")


def _cells(path: Path, number: int, line: str) -> list[str]:
    try:
        return next(csv.reader([line]))
    except csv.Error as error:
        raise UsageError(f"{path}:{number}: a value is too long for a points file: {error}") from error


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise UsageError(f"{path}: there is no such file") from error
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: is not UTF-8 text; export it as UTF-8 CSV") from error
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip() and not line.lstrip().startswith("#"):
            yield number, line


def _require_columns(path: Path, number: int, header: list[str]) -> None:
    missing = [name for name in COLUMNS if name not in header]
    if missing:
        raise UsageError(
            f"{path}:{number}: column {', '.join(missing)} is missing; the header has to be "
            f"{','.join(COLUMNS)}[,sigma_mm], comma separated"
        )
    doubled = sorted({name for name in header if header.count(name) > 1})
    unknown = [name for name in header if name not in COLUMNS + OPTIONAL]
    if doubled or unknown:
        what = (
            f"column {', '.join(doubled)} stands twice" if doubled else f"unknown column {', '.join(unknown)}"
        )
        raise UsageError(f"{path}:{number}: {what}; allowed are {','.join(COLUMNS)}[,sigma_mm]")


def _row(path: Path, line: int, record: Mapping[str, str], known: list[str]) -> PointRow:
    def value(name: str, convert: Callable[[str], T], wanted: str) -> T:
        try:
            return convert(record[name])
        except ValueError:
            raise UsageError(f"{path}:{line}: {name} = {record[name]!r} is not {wanted}") from None

    if record["reflector"] not in known:
        raise UsageError(
            f"{path}:{line}: unknown reflector {record['reflector']!r}; the cell file knows {', '.join(known)}"
        )
    return PointRow(
        reflector=record["reflector"],
        segment=value("segment", int, "an integer"),
        theta1_deg=value("theta1_deg", _finite, "a finite number"),
        theta2_deg=value("theta2_deg", _finite, "a finite number"),
        direction1=value("direction1", _direction, "1 or -1"),
        direction2=value("direction2", _direction, "1 or -1"),
        displacement_mm=value("displacement_mm", _finite, "a finite number"),
        sigma_mm=value("sigma_mm", _positive, "a finite number above 0") if "sigma_mm" in record else None,
    )


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(text)
    return number


def _positive(text: str) -> float:
    number = _finite(text)
    if number <= 0.0:
        raise ValueError(text)
    return number


def _direction(text: str) -> int:
    number = float(text)
    if number not in (1.0, -1.0):
        raise ValueError(text)
    return int(number)
