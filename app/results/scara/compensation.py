"""A whole path turned round: corrected commands, states of approach that hold, and where a take-up is needed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.app.errors import LimitError
from catseye.app.results.scara.path_csv import CommandPath, directions_of
from catseye.app.results.scara.path_range import place_word
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.arm import arm_design
from catseye.calibration.scara.compensation import Compensation, compensate
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.points import Commands
from catseye.calibration.scara.prediction import predict
from catseye.drivers.roles.pose import Pose, Range
from catseye.procedures.kit.motion.clear_way import refused_target
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.approach import Command, Waypoint, with_take_up
from catseye.procedures.scara.path_lines import stretches
from catseye.procedures.scara.tool_zero import AS_THE_JOINTS, ToolZero

STEP_DEG = 0.001
"""What the controller sets J1 and J2 by."""

_DECIMALS = 3

J4_RANGE_DEG: Final[Range] = (-360.0, 360.0)
"""Of the paper's arm, where no cell file states it."""


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
        j3_mm: J3 that keeps the height, shape (n,); None for a path that states none.
        j4_deg: J4 that keeps the orientation beside where J1 and J2 really stand, shape (n,); None likewise.
        c_sign: 1 where the orientation grows with J4, else -1.
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
    j3_mm: Floats | None = None
    j4_deg: Floats | None = None
    c_sign: int = 1

    @property
    def sent_j4_deg(self) -> Floats | None:
        """J4 that keeps the orientation beside the J1 and J2 that are sent, shape (n,)."""
        if self.j4_deg is None:
            return None
        rounded = np.rad2deg(_angles(self.solution.commands)) - self.sent_deg
        return np.asarray(self.j4_deg + self.c_sign * rounded.sum(axis=1), dtype=np.float64)

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
    arm: IdentifiedArm,
    path: CommandPath,
    nominal: tuple[float, float],
    take_up_deg: float,
    zero: ToolZero = AS_THE_JOINTS,
    j4_limits_deg: Range = J4_RANGE_DEG,
) -> CompensatedPath:
    """Return the commands that make the arm stand on a path.

    Positions leave the states of approach free: they are those that the corrected path itself brings about, which
    near a turning point are not always those of the uncorrected one. Joint commands come with states that somebody
    brings about: they are kept, and a step that goes against one is a warning. Each line begins with a take-up.
    The height is kept, and so is the orientation in the world: J4 takes back by how much the true J1 and J2 differ
    from the uncorrected ones.

    Args:
        path: wished positions, or commands whose nominal positions are wished.
        nominal: nominal links, mm.
        take_up_deg: overshoot that brings a state of approach about, deg.
        zero: how height and orientation are counted.
        j4_limits_deg: range of J4, whose middle it keeps near to.
    """
    solution = _consistent(arm, path) if path.cartesian else _solved(arm, path, _states(path.commands))
    solved, states = solution.solved, _states(solution.commands)
    sent_deg = np.asarray(np.round(np.rad2deg(_angles(solution.commands)), _DECIMALS), dtype=np.float64)
    targets = _targets(sent_deg, states, solved)
    stops = tuple(
        stop
        for rows in stretches(path.line)
        for stop in with_take_up(
            tuple(one for one in targets if rows.start <= one.index < rows.stop), take_up_deg
        )
    )
    steps = np.diff(np.where(solved[:, None], sent_deg, np.nan), axis=0, prepend=np.nan)
    # No step leads from line to line: each is entered anew.
    steps[[rows.start for rows in stretches(path.line)]] = np.nan
    return CompensatedPath(
        path,
        nominal,
        solution,
        sent_deg,
        stops,
        steps * states < 0.0,
        _miss(arm, path.command_mm, sent_deg, states),
        _loose(arm, solution, _taken_up(stops, len(path.commands))),
        None if path.tool.z_mm is None else zero.j3_mm(path.tool.z_mm),
        _kept_orientation(arm, path, solution, zero, j4_limits_deg),
        zero.c_sign,
    )


def _kept_orientation(
    arm: IdentifiedArm, path: CommandPath, solution: Compensation, zero: ToolZero, limits_deg: Range
) -> Floats | None:
    """Return J4 beside the angles at which J1 and J2 really stand: what they deviate by turns the tool, too."""
    if path.tool.c_deg is None:
        return None
    uncorrected = np.rad2deg(_angles(path.commands))
    nominal = zero.j4_deg(path.tool.c_deg, uncorrected, path.line, limits_deg)
    turned = np.full(uncorrected.shape, np.nan)
    solved = solution.solved
    design = arm_design(arm.layout, solution.commands.select(solved))
    turned[solved] = np.rad2deg(np.column_stack(design.angles(arm.parameters))) - uncorrected[solved]
    return np.asarray(nominal - zero.c_sign * turned.sum(axis=1), dtype=np.float64)


def require_limits(path: CompensatedPath, limits: Mapping[str, Range], lines: Sequence[int]) -> None:
    """Refuse commands and take-up positions outside the limits of the joints.

    Args:
        limits: smallest and largest value by joint; of J3 and J4 what the path itself says is looked at.
        lines: line of each row in its file.

    Raises:
        LimitError: names the first line, and the remedy.
    """
    # Of a row the command is named before its take-up.
    for row, stop in sorted(zip(_rows_of(path.stops), path.stops, strict=True), key=_row_first):
        asked = {"J1": (stop.theta1_deg, "°"), "J2": (stop.theta2_deg, "°")}
        if path.j3_mm is not None:
            asked["J3"] = (float(path.j3_mm[row]), " mm")
        if path.j4_deg is not None:
            asked["J4"] = (float(path.j4_deg[row]), "°")
        for joint, (value, unit) in asked.items():
            low, high = limits[joint]
            if not low <= value <= high:
                raise LimitError(
                    f"{place_word(lines)} {lines[row]}: {_what(stop)} needs {joint} = {value:.3f}{unit}, outside its "
                    f"limits {low:g}{unit.strip()}…{high:g}{unit.strip()} of the cell file: {_REMEDIES[joint]}"
                )


_OTHER_PATH = "take the row out, or choose the other hand or another path"

_REMEDIES = {
    "J1": _OTHER_PATH,
    "J2": _OTHER_PATH,
    "J3": "choose another z_mm, or widen j3_range_mm in [robot]",
    "J4": "choose another c_deg, or split the line in two",
}


def require_clear(path: CompensatedPath, bench: ScaraBench, j4_deg: float, lines: Sequence[int]) -> None:
    """Refuse commands and take-up positions where, or on the way to which, bodies come too near each other.

    Args:
        j4_deg: J4 where the path does not say its orientation.
        lines: line of each row in its file.

    Raises:
        LimitError: names the first line, both bodies, how near they come, and the remedy.
    """
    way = stop_poses(path, bench.j3_mm, j4_deg)
    if (refused := refused_target(way, bench)) is not None:
        target, obstacle = refused
        row = _rows_of(path.stops)[target]
        raise LimitError(
            f"{place_word(lines)} {lines[row]}: {_what(path.stops[target])} cannot be driven to: {obstacle}: "
            f"{_OTHER_PATH}, or correct dimensions in the cell file ([[body]], [workspace])"
        )


def stop_poses(path: CompensatedPath, j3_mm: float, j4_deg: float) -> list[Pose]:
    """Return all joints at each stop; a take-up has J3 and J4 of the row that it is for.

    Args:
        j3_mm: where the path does not say its height.
        j4_deg: where the path does not say its orientation.
    """
    height, turned = path.j3_mm, path.sent_j4_deg
    return [
        (
            stop.theta1_deg,
            stop.theta2_deg,
            j3_mm if height is None else float(height[row]),
            j4_deg if turned is None else float(turned[row]),
        )
        for row, stop in zip(_rows_of(path.stops), path.stops, strict=True)
    ]


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
    start = states
    changed = np.zeros(states.shape, dtype=np.bool_)
    while True:
        solution = _solved(arm, path, states)
        angles = np.where(solution.solved[:, None], _angles(solution.commands), _angles(path.commands))
        found = np.empty_like(states)
        for rows in stretches(path.line):
            for joint in range(2):
                found[rows, joint] = directions_of(angles[rows, joint], int(start[rows.start, joint]))
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
