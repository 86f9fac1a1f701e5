"""A measured file as a path: states of approach, ways there and back, and what speaks against the numbers."""

from pathlib import Path

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.columns import read_table
from catseye.app.results.scara.driven_path import driven_path
from catseye.app.results.scara.instrument_positions import ForeignPositions, matched_places
from catseye.app.results.scara.path_csv import (
    JOINTS,
    PLACE,
    CommandPath,
    Start,
    cartesian_commands,
    line_numbers,
    require_reach,
)
from catseye.app.results.scara.path_start import against_start, start_text
from catseye.app.results.scara.points import commands_of
from catseye.app.results.scara.validation import FEWEST_ROWS, TAKE_UP_DEG, PathMeasurement, established_rows
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.planar import Hand, forward
from catseye.calibration.scara.points import Commands
from catseye.procedures.kit.columns import Columns
from catseye.procedures.scara.path.instrument_file import IN_ONE_PLACE, are_spread
from catseye.procedures.scara.path.measured_path import MEASURED_PLACE, misplaced
from catseye.procedures.scara.path.tables import MEASURED, WISHED
from catseye.procedures.scara.path_lines import stretches

_ANGLE_UNITS = {"rad": 180.0 / np.pi, "mdeg": 1e-3}
"""What makes degrees of other units."""

_SPREAD_MM = 1.0
"""Commands within this are one place."""

_CONCLUSIVE_MM = 50.0
"""Smaller paths fit commands in any unit of angles."""

_TURNS_BACK = -0.9
"""Cosine between steps of a path that turns back on itself."""


def measured_path(
    file: Path,
    nominal: tuple[float, float],
    hand: Hand,
    start: Start,
    foreign: ForeignPositions | None = None,
) -> tuple[PathMeasurement, list[int], str]:
    """Return what a measured file holds, the line of each row, and what to know about its first row.

    Where a Cartesian path leaves its first row against the state that is said of it, nobody knows that state: the
    row is not compared.

    Args:
        nominal: nominal links, mm.
        hand: of Cartesian commands.
        start: states of approach of the first Cartesian command of each line; None for those of its first motion.
        foreign: how a file is read that another program wrote, and what was driven; None for a measured CSV.

    Raises:
        UsageError: the file is no such file, holds too few rows, is in another unit, or belongs to another path.
    """
    if foreign is not None:
        driven = driven_path(foreign.path, nominal, hand, start)
        _require_enough(foreign.path, len(driven.commands))
        _require_spread(foreign.path, driven.command_mm, _SPREAD_MM)
        places, passes = matched_places(file, foreign.mapping, driven)
        return _measurement(driven, places, passes)
    measured = read_table(file, MEASURED)
    _require_enough(file, len(measured))
    numbers = line_numbers(file, measured)
    commands, command_mm = _commands(file, measured, nominal, hand, start, numbers)
    _require_places(file, measured, command_mm, measured.stacked(MEASURED_PLACE), nominal)
    driven = CommandPath(commands, command_mm, cartesian=PLACE[0] in measured, numbers=numbers)
    return _measurement(driven, measured)


def _require_enough(file: Path, rows: int) -> None:
    if rows < FEWEST_ROWS:
        raise UsageError(
            f"{file}: holds {rows} row(s); the frames are aligned by three unknowns, so that a comparison "
            f"takes {FEWEST_ROWS} positions or more, spread out"
        )


def _require_spread(file: Path, place_mm: Floats, farther_than_mm: float = 0.0) -> None:
    if not are_spread(place_mm, farther_than_mm):
        raise UsageError(f"{file}: {IN_ONE_PLACE}")


def _measurement(
    driven: CommandPath, measured: Columns, arrivals: int = 1
) -> tuple[PathMeasurement, list[int], str]:
    commands, numbers = driven.commands, driven.numbers
    established, text = established_rows(commands, float(np.deg2rad(TAKE_UP_DEG)), numbers), ""
    if driven.cartesian:
        established &= ~against_start(commands, numbers).any(axis=1)
        text = start_text(commands, numbers)
    path = PathMeasurement(
        commands=commands,
        command_mm=driven.command_mm,
        travel=travel_of(driven.command_mm, numbers),
        measured_mm=measured.stacked(MEASURED_PLACE),
        u_mm=measured["u_mm"] if "u_mm" in measured else np.full(len(measured), np.nan),
        established=established,
        arrivals=arrivals,
        numbers=numbers,
    )
    return path, measured.lines.tolist(), text


def travel_of(command_mm: Floats, numbers: Ints | None = None) -> Ints:
    """Return 1 and −1 in turns, changing wherever a line turns back on itself, shape (n,).

    Args:
        command_mm: positions along the path, mm, shape (n, 2).
        numbers: number of the line of each row, shape (n,); None for one line.
    """
    travel = np.ones(len(command_mm), dtype=np.int64)
    for rows in [slice(None)] if numbers is None else stretches(numbers):
        travel[rows] = _turns(command_mm[rows])
    return travel


def _turns(command_mm: Floats) -> Ints:
    travel = np.ones(len(command_mm), dtype=np.int64)
    before, sign = np.zeros(2), 1
    for i, step in enumerate(np.diff(command_mm, axis=0), start=1):
        length = float(np.hypot(*step))
        if length > 0.0:
            if float(step @ before) / length < _TURNS_BACK:
                sign = -sign
            before = step / length
        travel[i] = sign
    return travel


def _commands(
    file: Path,
    measured: Columns,
    nominal: tuple[float, float],
    hand: Hand,
    start: Start,
    numbers: Ints | None,
) -> tuple[Commands, Floats]:
    if PLACE[0] in measured:
        place = measured.stacked(PLACE)
        require_reach(measured, file, place, nominal, hand)
        return cartesian_commands(place, nominal, hand, start, numbers), place
    commands = commands_of(measured)
    wished = [column.name for column in WISHED if column.name in measured]
    if len(wished) == 1:
        raise UsageError(
            f"{file}: column {wished[0]} stands alone: {', '.join(column.name for column in WISHED)} belong together"
        )
    if wished:
        return commands, measured.stacked(wished)
    return commands, forward(commands.theta1_rad, commands.theta2_rad, *nominal)


def _require_places(
    file: Path,
    measured: Columns,
    command_mm: Floats,
    places: Floats,
    nominal: tuple[float, float],
) -> None:
    _require_spread(file, command_mm, _SPREAD_MM)
    _require_spread(file, places)
    wrong = misplaced(command_mm, places)
    if wrong is None:
        return
    if JOINTS[0] in measured and np.ptp(places, axis=0).max() > _CONCLUSIVE_MM:
        for unit, factor in _ANGLE_UNITS.items():
            theta = np.radians(factor * measured.stacked(JOINTS))
            if misplaced(forward(theta[:, 0], theta[:, 1], *nominal), places) is None:
                raise UsageError(
                    f"{file}: the commands in theta1_deg, theta2_deg seem to be in {unit}: convert them to degrees"
                )
    where = "" if wrong.row is None else f":{measured.lines[wrong.row]}"
    raise UsageError(f"{file}{where}: {wrong.text}")
