"""A whole path turned round: corrected commands, states of approach that hold, and where a take-up is needed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.app.errors import LimitError
from catseye.app.results.scara.path_csv import CommandPath, directions_of
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.compensation import Compensation, compensate
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.points import Commands
from catseye.calibration.scara.prediction import predict
from catseye.procedures.kit.motion.clear_way import refused_target
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.approach import Command, Waypoint, with_take_up

STEP_DEG = 0.001
"""What the controller sets J1 and J2 by."""

_DECIMALS = 3

Range = tuple[float, float]


@dataclass(frozen=True)
class CompensatedPath:
    """A path with corrected commands; numbers of rows without a correction are NaN.

    Attributes:
        path: what was asked for.
        nominal: links that uncorrected commands are calculated with, mm.
        solution: corrected commands with their states of approach, n rows.
        sent_deg: corrected J1 and J2 on the controller's step, shape (n, 2).
        stops: what is driven to: corrected commands, before them take-up positions where they are needed.
        contradicted: joints whose step to a row goes against their state of approach there, shape (n, 2).
        rounding_mm: how far the step of the controller leaves the arm from where it shall stand, shape (n,).
        loose_mm: how far it stands from there without the take-up, shape (n,); 0 where none is needed.
    """

    path: CommandPath
    nominal: tuple[float, float]
    solution: Compensation
    sent_deg: Floats
    stops: tuple[Waypoint, ...]
    contradicted: Bools
    rounding_mm: Floats
    loose_mm: Floats

    @property
    def correction_rad(self) -> Floats:
        """Corrected minus uncorrected J1 and J2, shape (n, 2)."""
        commands, corrected = self.path.commands, self.solution.commands
        return np.column_stack(
            [corrected.theta1_rad - commands.theta1_rad, corrected.theta2_rad - commands.theta2_rad]
        )

    @property
    def shift_mm(self) -> Floats:
        """Position that the nominal arm would take at the corrected command, minus the wished one, shape (n, 2)."""
        corrected = self.solution.commands
        there = forward(corrected.theta1_rad, corrected.theta2_rad, *self.nominal)
        return np.asarray(there - self.path.command_mm, dtype=np.float64)

    @property
    def take_up(self) -> Bools:
        """Joints that have to come from a take-up position, shape (n, 2)."""
        return _taken_up(self.stops, len(self.path.commands))


def compensate_path(
    arm: IdentifiedArm, path: CommandPath, nominal: tuple[float, float], take_up_deg: float
) -> CompensatedPath:
    """Return the commands that make the arm stand on a path.

    Positions leave the states of approach free: they are those that the corrected path itself brings about, which
    near a turning point are not always those of the uncorrected one. Joint commands come with states that somebody
    brings about: they are kept, and a step that goes against one is a warning.

    Args:
        path: wished positions, or commands whose nominal positions are wished.
        nominal: nominal links, mm.
        take_up_deg: overshoot that brings a state of approach about, deg.
    """
    solution = _consistent(arm, path) if path.cartesian else _solved(arm, path, _states(path.commands))
    solved, states = solution.solved, _states(solution.commands)
    sent_deg = np.asarray(np.round(np.rad2deg(_angles(solution.commands)), _DECIMALS), dtype=np.float64)
    stops = with_take_up(_targets(sent_deg, states, solved), take_up_deg)
    steps = np.diff(np.where(solved[:, None], sent_deg, np.nan), axis=0, prepend=np.nan)
    return CompensatedPath(
        path,
        nominal,
        solution,
        sent_deg,
        stops,
        steps * states < 0.0,
        _miss(arm, path.command_mm, sent_deg, states),
        _loose(arm, solution, _taken_up(stops, len(path.commands))),
    )


def require_limits(path: CompensatedPath, j1_deg: Range, j2_deg: Range, lines: Sequence[int]) -> None:
    """Refuse commands and take-up positions outside the limits of the joints.

    Args:
        j1_deg: smallest and largest J1.
        j2_deg: smallest and largest J2.
        lines: line of each row in its file.

    Raises:
        LimitError: names the first line, and the remedy.
    """
    # Of a row the command is named before its take-up.
    for row, stop in sorted(zip(_rows_of(path.stops), path.stops, strict=True), key=_row_first):
        for joint, angle, (low, high) in (("J1", stop.theta1_deg, j1_deg), ("J2", stop.theta2_deg, j2_deg)):
            if not low <= angle <= high:
                raise LimitError(
                    f"line {lines[row]}: {_what(stop)} needs {joint} = {angle:.3f}°, outside its limits "
                    f"{low:g}°…{high:g}° of the cell file: take the row out, or choose the other hand or another path"
                )


def require_clear(path: CompensatedPath, bench: ScaraBench, j4_deg: float, lines: Sequence[int]) -> None:
    """Refuse commands and take-up positions where, or on the way to which, bodies come too near each other.

    Args:
        lines: line of each row in its file.

    Raises:
        LimitError: names the first line, both bodies, how near they come, and the remedy.
    """
    way = [(stop.theta1_deg, stop.theta2_deg, bench.j3_mm, j4_deg) for stop in path.stops]
    if (refused := refused_target(way, bench)) is not None:
        target, obstacle = refused
        row = _rows_of(path.stops)[target]
        raise LimitError(
            f"line {lines[row]}: {_what(path.stops[target])} cannot be driven to: {obstacle}: take the row out, or "
            "choose the other hand or another path, or correct dimensions in the cell file ([[body]], [workspace])"
        )


def _rows_of(stops: Sequence[Waypoint]) -> list[int]:
    """Return the row that each stop is driven for; a take-up is driven for the row after it."""
    rows: list[int] = []
    for stop in reversed(stops):
        rows.append(rows[-1] if stop.command is None else stop.command.index)
    return rows[::-1]


def _row_first(found: tuple[int, Waypoint]) -> tuple[int, bool]:
    row, stop = found
    return row, stop.command is None


def _what(stop: Waypoint) -> str:
    return "the take-up before it" if stop.command is None else "the corrected command"


def _consistent(arm: IdentifiedArm, path: CommandPath) -> Compensation:
    """Return a solution whose states are those that its own steps bring about, as far as there is one.

    A state that would have to change a second time has none: whichever it is, the step goes the other way. It stays
    as it is then, and needs a take-up.
    """
    states = _states(path.commands)
    start = states[0]
    changed = np.zeros(states.shape, dtype=np.bool_)
    while True:
        solution = _solved(arm, path, states)
        angles = np.where(solution.solved[:, None], _angles(solution.commands), _angles(path.commands))
        found = np.column_stack([directions_of(angles[:, n], int(start[n])) for n in range(2)])
        changes = (found != states) & ~changed
        if not changes.any():
            return solution
        states = np.where(changes, found, states)
        changed |= changes


def _solved(arm: IdentifiedArm, path: CommandPath, states: Ints) -> Compensation:
    theta1, theta2 = path.commands.theta1_rad, path.commands.theta2_rad
    return compensate(arm, Commands(theta1, theta2, states[:, 0], states[:, 1]), path.command_mm)


def _targets(sent_deg: Floats, states: Ints, solved: Bools) -> tuple[Command, ...]:
    return tuple(
        Command(int(i), float(one), float(two), int(s1), int(s2))
        for i, (one, two), (s1, s2) in zip(
            np.flatnonzero(solved), sent_deg[solved], states[solved], strict=True
        )
    )


def _taken_up(stops: tuple[Waypoint, ...], rows: int) -> Bools:
    flags = np.zeros((rows, 2), dtype=np.bool_)
    before: Waypoint | None = None
    for stop in stops:
        if stop.command is not None and before is not None and before.command is None:
            come_from = (before.theta1_deg, before.theta2_deg)
            flags[stop.command.index] = [
                a != b for a, b in zip(come_from, (stop.theta1_deg, stop.theta2_deg), strict=True)
            ]
        before = stop
    return flags


def _miss(arm: IdentifiedArm, wished_mm: Floats, theta_deg: Floats, states: Ints) -> Floats:
    """Return how far the arm stands from wished positions at commands, mm, shape (n,)."""
    theta = np.deg2rad(theta_deg)
    commands = Commands(theta[:, 0], theta[:, 1], states[:, 0], states[:, 1])
    link1, link2 = arm.parameters[:2]
    offset = predict(arm, commands, float(link1), float(link2)).position_mm - wished_mm
    return np.asarray(np.hypot(offset[:, 0], offset[:, 1]), dtype=np.float64)


def _loose(arm: IdentifiedArm, solution: Compensation, take_up: Bools) -> Floats:
    """Return the miss where every joint that needs a take-up stands on its other flank."""
    states = _states(solution.commands)
    theta_deg = np.rad2deg(_angles(solution.commands))
    miss = _miss(arm, solution.wished_mm, theta_deg, np.where(take_up, -states, states))
    return np.where(take_up.any(axis=1), miss, 0.0)


def _angles(commands: Commands) -> Floats:
    return np.column_stack([commands.theta1_rad, commands.theta2_rad])


def _states(commands: Commands) -> Ints:
    return np.column_stack([commands.direction1, commands.direction2])
