"""TABLES CSV: look-up tables of joint step errors, written and read."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.files.columns import read_rows
from catseye.app.files.csv_lines import CsvRow
from catseye.app.files.csv_text import csv_text
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.tables import ExpectedErrors, JointTable, ResolutionTables, Sector
from catseye.procedures.kit.columns import ColumnRule, TableRule

REVERSAL: Final = "reversal_deg"
U_MEAN: Final = "error_u_mean_percent"
SIMULATED: Final = "simulated"

_NUMBERS: Final = ("position_deg", "command_deg", "error_mean_percent", "error_std_percent")
_HEADER: Final = ("joint", "direction", *_NUMBERS, REVERSAL, U_MEAN, SIMULATED)

TABLES: Final = TableRule(
    holds="step errors",
    row="a joint, a direction, a position, a step and its error",
    forms=(
        (
            ColumnRule("joint", "name", known_to="the arm"),
            ColumnRule("direction", "direction"),
            ColumnRule("position_deg"),
            ColumnRule("command_deg", positive=True),
            ColumnRule("error_mean_percent"),
            ColumnRule("error_std_percent"),
        ),
    ),
    source="tables of catseye resolution-model",
)
"""deg stands for mm of a joint that slides. What may be missing, such as the reversal, is read apart."""


@dataclass(frozen=True)
class TablesFile:
    """What a file with tables says.

    Attributes:
        tables: of the joints.
        simulated: a row comes from emulated devices.
    """

    tables: ResolutionTables
    simulated: bool


def write_joint_tables(tables: Sequence[JointTable], output: Path, *, simulated: bool) -> None:
    """Write tables; the standard deviation is that of one step with the uncertainty of the mean."""
    rows = (
        [*row, int(simulated)] for table in tables for sector in table.sectors for row in _rows(table, sector)
    )
    write_atomically(output, csv_text(_HEADER, rows))


def _rows(table: JointTable, sector: Sector) -> Iterator[list[object]]:
    errors = sector.errors
    std = np.hypot(errors.scatter_percent, errors.u_mean_percent)
    reversal = "" if sector.reversal is None else f"{sector.reversal:.6g}"
    for command, *values in zip(
        sector.commands, errors.mean_percent, std, errors.u_mean_percent, strict=True
    ):
        mean, whole, u_mean = (f"{value:.6g}" for value in values)
        yield [
            *(table.joint, table.direction, f"{sector.position:.9g}", f"{command:.9g}"),
            *(mean, whole, reversal, u_mean),
        ]


def read_joint_tables(path: Path, joints: Sequence[str]) -> TablesFile:
    """Read tables.

    Args:
        joints: names that the arm's joints have.

    Raises:
        UsageError: the file is missing, a column is missing, a value is wrong or stands twice; names file and line.
    """
    rows, columns = read_rows(path, TABLES, joints)
    numbers = columns.stacked(_NUMBERS)
    extra = np.array([[_optional(row, name) for name in (REVERSAL, U_MEAN)] for row in rows])
    keys = [
        (joints[int(joint)], int(direction))
        for joint, direction in zip(columns["joint"], columns["direction"], strict=True)
    ]
    order = sorted(range(len(rows)), key=lambda k: (keys[k], numbers[k, 0], numbers[k, 1]))
    _require_once(rows, order, keys, numbers)
    try:
        tables = ResolutionTables(
            JointTable(*key, tuple(_sectors(list(members), numbers, extra)))
            for key, members in groupby(order, keys.__getitem__)
        )
    except ArgumentError as error:
        raise UsageError(f"{path}: {error}") from error
    return TablesFile(tables, any(row.cells.get(SIMULATED, "0") not in {"", "0"} for row in rows))


def _sectors(order: Sequence[int], numbers: Floats, extra: Floats) -> Iterator[Sector]:
    for position, members in groupby(order, lambda k: float(numbers[k, 0])):
        rows = list(members)
        _, commands, mean, std = numbers[rows].T
        reversals, u_mean = extra[rows].T
        known = reversals[np.isfinite(reversals)]
        u_mean = np.minimum(np.nan_to_num(u_mean), std)
        errors = ExpectedErrors(mean, np.sqrt(std**2 - u_mean**2), u_mean)
        yield Sector(position, commands, errors, float(known[0]) if known.size else None)


def _require_once(
    rows: Sequence[CsvRow], order: Sequence[int], keys: Sequence[tuple[str, int]], numbers: Floats
) -> None:
    """Refuse a step that stands twice, and a negative standard deviation, which would be one of nothing."""
    for before, after in pairwise(order):
        if keys[before] == keys[after] and (numbers[before, :2] == numbers[after, :2]).all():
            line = rows[min(before, after)].line
            raise rows[max(before, after)].fault(f"stands on line {line} already: keep one of them")
    for row, std in zip(rows, numbers[:, 3], strict=True):
        if std < 0.0:
            raise row.fault(f"error_std_percent = {std:g} is below 0")


def _optional(row: CsvRow, name: str) -> float:
    """Return a number that may be empty or missing, NaN then.

    Raises:
        UsageError: it is no number from 0 on.
    """
    text = row.cells.get(name, "")
    try:
        value = float(text) if text else float("nan")
    except ValueError:
        value = -1.0
    if value < 0.0 or value == float("inf"):
        raise row.fault(f"{name} = {text!r} is not a number from 0 on; leave it empty where nothing is known")
    return value
