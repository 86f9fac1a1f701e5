"""Path CSV: commands of a path, in joints or in Cartesian positions (version 1)."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.columns import read_rows
from catseye.app.files.csv_lines import CsvRow
from catseye.app.results.scara.points import commands_of
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.errors import OutOfReachError
from catseye.calibration.scara.planar import Hand, forward, inverse
from catseye.calibration.scara.points import Commands
from catseye.procedures.kit.columns import TableRule
from catseye.procedures.scara.path import tables

JOINTS = tuple(column.name for column in tables.JOINTS)
DIRECTIONS = tuple(column.name for column in tables.DIRECTIONS)
PLACE = tuple(column.name for column in tables.PLACE)

PATH = TableRule("commands", "one", tables.COMMAND_FORMS, mixed=tables.TWO_FORMS)


@dataclass(frozen=True)
class CommandPath:
    """Commands of a path, in order.

    Attributes:
        commands: joint commands with directions of approach, n rows.
        command_mm: where the nominal arm would stand, shape (n, 2).
        cartesian: the file holds positions; otherwise joints.
        rows: lines of the file.
    """

    commands: Commands
    command_mm: Floats
    cartesian: bool
    rows: tuple[CsvRow, ...] = ()


def read_path_csv(
    path: Path, nominal: tuple[float, float], hand: Hand = "right", start: tuple[int, int] = (1, 1)
) -> CommandPath:
    """Read a path.

    Args:
        nominal: nominal links, mm.
        hand: of positions: "right" has θ2 >= 0.
        start: states of approach of the first position, 1 or -1.

    Raises:
        UsageError: the file is missing, a column is missing, a value is wrong or out of reach; names file and line.
    """
    rows, columns = read_rows(path, PATH)
    if PLACE[0] in columns:
        return _cartesian(rows, columns.stacked(PLACE), nominal, hand, start)
    commands = commands_of(columns)
    command_mm = forward(commands.theta1_rad, commands.theta2_rad, *nominal)
    return CommandPath(commands, command_mm, cartesian=False, rows=tuple(rows))


def start_states(text: str) -> tuple[int, int]:
    """Return the states of approach that an option gives, as in "1,-1".

    Raises:
        UsageError: the text is no such pair.
    """
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2 or any(part not in _STATES for part in parts):
        raise UsageError(
            f"--start-direction {text!r} has to be the states of J1 and J2 at the first row, each 1 (upwards) or -1 "
            "(downwards), as in --start-direction 1,-1"
        )
    return _STATES[parts[0]], _STATES[parts[1]]


_STATES = {"1": 1, "+1": 1, "-1": -1}


def cartesian_commands(
    place_mm: Floats, nominal: tuple[float, float], hand: Hand, start: tuple[int, int]
) -> Commands:
    """Return the joint commands of positions along a path.

    J1 begins within ±180° and goes on without jumps of a turn; the states of approach follow from the changes.

    Args:
        place_mm: positions, mm, shape (n, 2).
        nominal: nominal links, mm.
        hand: "right" has θ2 >= 0.
        start: states of approach of the first position, 1 or -1.

    Raises:
        OutOfReachError: a position cannot be reached.
    """
    theta1, theta2 = inverse(place_mm, *nominal, hand)
    theta1 = np.unwrap(theta1)
    return Commands(theta1, theta2, directions_of(theta1, start[0]), directions_of(theta2, start[1]))


def directions_of(theta_rad: Floats, start: int) -> Ints:
    """Return the state of approach along a path: the sign of the last change, shape (n,).

    Args:
        theta_rad: angles of one joint along the path, rad, shape (n,).
        start: state at the first row.
    """
    change = np.diff(theta_rad, prepend=theta_rad[:1])
    moved = np.where(np.abs(change) > STANDS_STILL_RAD, np.sign(change), 0.0)
    moved[0] = start
    last = np.maximum.accumulate(np.where(moved != 0.0, np.arange(moved.size), 0))
    return moved[last].astype(np.int64)


STANDS_STILL_RAD = 1e-8
"""Changes below this (2 nm at the end of a link) are rounding of the positions, no motion."""


def _cartesian(
    rows: Sequence[CsvRow], place: Floats, nominal: tuple[float, float], hand: Hand, start: tuple[int, int]
) -> CommandPath:
    require_reach([row.line for row in rows], rows[0].path, place, nominal, hand)
    commands = cartesian_commands(place, nominal, hand, start)
    return CommandPath(commands, place, cartesian=True, rows=tuple(rows))


def require_reach(
    lines: Sequence[int], file: Path, place_mm: Floats, nominal: tuple[float, float], hand: Hand
) -> None:
    """Refuse positions that the nominal arm does not reach.

    Args:
        lines: line of each position in its file.
        place_mm: positions, mm, shape (n, 2).
        nominal: nominal links, mm.

    Raises:
        UsageError: names file and line of the first one, or the unit that the positions seem to be in.
    """
    try:
        inverse(place_mm, *nominal, hand)
    except OutOfReachError:
        _require_unit(file, place_mm, nominal, hand)
        for line, xy in zip(lines, place_mm, strict=True):
            try:
                inverse(xy, *nominal, hand)
            except OutOfReachError as error:
                text = str(error).removeprefix("position 1 of 1 ")
                raise UsageError(f"{file}:{line}: the position {text}") from None


def _require_unit(file: Path, place_mm: Floats, nominal: tuple[float, float], hand: Hand) -> None:
    """Refuse positions that the arm would all reach in another unit and reaches nowhere as they stand."""
    radius = np.hypot(*place_mm.T)
    if np.any((radius >= abs(nominal[0] - nominal[1])) & (radius <= sum(nominal))):
        return
    for unit, factor in _UNITS_MM.items():
        with suppress(OutOfReachError):
            inverse(factor * place_mm, *nominal, hand)
            raise UsageError(
                f"{file}: the positions in {', '.join(PLACE)} seem to be in {unit}: the arm reaches none of them in "
                f"mm and all of them in {unit}; convert them to mm"
            )


_UNITS_MM = {"m": 1e3, "inches": 25.4, "cm": 10.0, "µm": 1e-3}
"""What makes mm of other units."""
