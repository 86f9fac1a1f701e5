"""Path files: commands of a path in joints, positions or drawn segments, in one line or several (version 1)."""

from collections.abc import Sequence
from dataclasses import dataclass, field
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
from catseye.procedures.kit.columns import Columns
from catseye.procedures.scara.path import tables
from catseye.procedures.scara.path.reach import likely_unit, unit_text
from catseye.procedures.scara.path_lines import scattered, scattered_text, stretches

JOINTS = tuple(column.name for column in tables.JOINTS)
DIRECTIONS = tuple(column.name for column in tables.DIRECTIONS)
PLACE = tuple(column.name for column in tables.PLACE)

Start = tuple[int, int] | None
"""States of approach of the first row of a line; None for those of its first motion."""


class SegmentNumbers(tuple[int, ...]):
    """Numbers of the segments that rows come from, where a path was drawn; otherwise rows have lines of a file."""

    __slots__ = ()


@dataclass(frozen=True)
class ToolWish:
    """What a path says beyond the plane, shape (n,) each; None for what it does not say.

    Attributes:
        z_mm: height.
        c_deg: orientation in the world.
        speed_mm_s: along the path, NaN where it is left open.
    """

    z_mm: Floats | None = None
    c_deg: Floats | None = None
    speed_mm_s: Floats | None = None


@dataclass(frozen=True)
class CommandPath:
    """Commands of a path, in order.

    Attributes:
        commands: joint commands with directions of approach, n rows.
        command_mm: where the nominal arm would stand, shape (n, 2).
        cartesian: the file holds positions; otherwise joints.
        rows: lines of the file.
        numbers: number of the line that each row belongs to, shape (n,); None for a path that names none.
        tool: height and orientation.
        drawn: the file holds segments.
    """

    commands: Commands
    command_mm: Floats
    cartesian: bool
    rows: tuple[CsvRow, ...] = ()
    numbers: Ints | None = None
    tool: ToolWish = field(default_factory=ToolWish)
    drawn: bool = False

    @property
    def line(self) -> Ints:
        """Number of the line that each row belongs to, shape (n,); 1 throughout where the path names none."""
        return np.ones(len(self.commands), dtype=np.int64) if self.numbers is None else self.numbers

    @property
    def places(self) -> Sequence[int]:
        """Where each row stands in its file: line, or segment."""
        numbers = (row.line for row in self.rows)
        return SegmentNumbers(numbers) if self.drawn else list(numbers)


def read_path_csv(
    path: Path, nominal: tuple[float, float], hand: Hand = "right", start: Start = (1, 1)
) -> CommandPath:
    """Read a path file: CSV of joints or of positions, or TOML of segments.

    Args:
        nominal: nominal links, mm.
        hand: of positions: "right" has θ2 >= 0.
        start: states of approach of the first position of each line, 1 or -1; None for those of its first motion.

    Raises:
        UsageError: the file is missing, a column is missing, a value or segment is wrong or out of reach; names file
            and line or segment.
    """
    rows, columns = read_rows(path, tables.PATH)
    numbers = line_numbers(path, columns)
    if PLACE[0] in columns:
        command_mm = columns.stacked(PLACE)
        require_reach(columns, path, command_mm, nominal, hand)
        commands = cartesian_commands(command_mm, nominal, hand, start, numbers)
    else:
        commands = commands_of(columns)
        command_mm = forward(commands.theta1_rad, commands.theta2_rad, *nominal)
    return CommandPath(
        commands,
        command_mm,
        cartesian=PLACE[0] in columns,
        rows=tuple(rows),
        numbers=numbers,
        tool=ToolWish(columns.get("z_mm"), columns.get("c_deg"), columns.get("speed_mm_s")),
        drawn=columns.counted == "segment",
    )


def line_numbers(file: Path, columns: Columns) -> Ints | None:
    """Return the number of the line that each row of a file belongs to; None where the file names none.

    Raises:
        UsageError: rows of one line do not stand together; names file and line.
    """
    if (given := columns.get(tables.LINE.name)) is None:
        return None
    numbers = given.astype(np.int64)
    if (row := scattered(numbers)) is not None:
        raise UsageError(f"{file}:{columns.lines[row]}: {scattered_text(int(numbers[row]))}")
    return numbers


def start_states(text: str) -> Start:
    """Return the states of approach that an option gives, as in "1,-1"; None for "along".

    Raises:
        UsageError: the text is neither.
    """
    if text.strip() == ALONG:
        return None
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2 or any(part not in _STATES for part in parts):
        raise UsageError(
            f"--start-direction {text!r} has to be the states of J1 and J2 at the first row, each 1 (upwards) or -1 "
            f"(downwards), as in --start-direction 1,-1; or {ALONG}: each line is entered in its own direction"
        )
    return _STATES[parts[0]], _STATES[parts[1]]


ALONG = "along"
"""Each line is entered in its own direction."""

_STATES = {"1": 1, "+1": 1, "-1": -1}


def cartesian_commands(
    place_mm: Floats, nominal: tuple[float, float], hand: Hand, start: Start, numbers: Ints | None = None
) -> Commands:
    """Return the joint commands of positions along a path.

    J1 begins each line within ±180° and goes on without jumps of a turn; the states of approach follow from the
    changes.

    Args:
        place_mm: positions, mm, shape (n, 2).
        nominal: nominal links, mm.
        hand: "right" has θ2 >= 0.
        start: states of approach of the first position of each line, 1 or -1; None for those of its first motion.
        numbers: number of the line of each position, shape (n,); None for one line.

    Raises:
        OutOfReachError: a position cannot be reached.
    """
    theta = np.column_stack(inverse(place_mm, *nominal, hand))
    states = np.empty(theta.shape, dtype=np.int64)
    for rows in [slice(None)] if numbers is None else stretches(numbers):
        theta[rows, 0] = np.unwrap(theta[rows, 0])
        for joint in range(2):
            own = theta[rows, joint]
            states[rows, joint] = directions_of(own, _first_motion(own) if start is None else start[joint])
    return Commands(theta[:, 0], theta[:, 1], states[:, 0], states[:, 1])


def _first_motion(theta_rad: Floats) -> int:
    """Return the direction in which a joint first moves; 1 for one that never does."""
    steps = np.diff(theta_rad)
    moving = steps[np.abs(steps) > STANDS_STILL_RAD]
    return -1 if moving.size and moving[0] < 0.0 else 1


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


def require_reach(
    columns: Columns, file: Path, place_mm: Floats, nominal: tuple[float, float], hand: Hand
) -> None:
    """Refuse positions that the nominal arm does not reach.

    Args:
        columns: that the positions stand in, with where each of them stands.
        place_mm: positions, mm, shape (n, 2).
        nominal: nominal links, mm.

    Raises:
        UsageError: names file and line of the first one, or the unit that the positions seem to be in.
    """
    try:
        inverse(place_mm, *nominal, hand)
    except OutOfReachError:
        if unit := likely_unit(place_mm, nominal, hand):
            what = f"in {', '.join(PLACE)}" if columns.counted == "line" else "of the segments"
            raise UsageError(f"{file}: {unit_text(what, unit)}") from None
        for line, xy in zip(columns.lines, place_mm, strict=True):
            try:
                inverse(xy, *nominal, hand)
            except OutOfReachError as error:
                text = str(error).removeprefix("position 1 of 1 ")
                where = f":{line}" if columns.counted == "line" else f": segment {line}"
                raise UsageError(f"{file}{where}: the position {text}") from None
