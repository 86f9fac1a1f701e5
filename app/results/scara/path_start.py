"""The first rows of the lines of a Cartesian path, whose states of approach an option says, and no motion."""

import numpy as np

from catseye.app.results.scara.path_csv import ALONG, STANDS_STILL_RAD
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.points import Commands
from catseye.procedures.scara.path_lines import stretches


def against_start(commands: Commands, numbers: Ints | None = None) -> Bools:
    """Return the rows before a joint's first motion where that motion goes against their state, shape (n, 2).

    A line that is entered in its own direction has none.

    Args:
        commands: of a Cartesian path, n rows.
        numbers: number of the line of each row, shape (n,); None for one line.
    """
    waiting = np.zeros((len(commands), 2), dtype=np.bool_)
    for rows in [slice(None)] if numbers is None else stretches(numbers):
        waiting[rows, 0] = _waiting(commands.theta1_rad[rows], commands.direction1[rows])
        waiting[rows, 1] = _waiting(commands.theta2_rad[rows], commands.direction2[rows])
    return waiting


def start_text(commands: Commands, numbers: Ints | None = None) -> str:
    """Return a sentence about a start that goes against the path; empty when none does.

    Args:
        commands: of a Cartesian path, n rows.
        numbers: number of the line of each row, shape (n,); None for one line.
    """
    waiting = against_start(commands, numbers)
    joints = np.logical_or.reduce(waiting, axis=0)
    if not joints.any():
        return ""
    start = np.array([commands.direction1[0], commands.direction2[0]])
    if numbers is not None and np.unique(numbers).size > 1:
        entered = ", ".join(str(number) for number in dict.fromkeys(numbers[waiting.any(axis=1)].tolist()))
        return (
            f"the first row of each line is assumed to be approached in the directions {start[0]},{start[1]} "
            f"(--start-direction), and line {entered} goes on the other way: if the arm comes to each line in its "
            f"own direction, as validation-path drives it, give --start-direction={ALONG}"
        )
    given, along = (
        ",".join(str(state) for state in states) for states in (start, np.where(joints, -start, start))
    )
    names = " and ".join(f"J{joint + 1}" for joint in np.flatnonzero(joints))
    return (
        f"the first row is assumed to be approached in the directions {given} (--start-direction), but the path "
        f"continues with {names} the other way: if the arm comes to it in the direction of the path, give "
        f"--start-direction={along}"
    )


def _waiting(theta_rad: Floats, direction: Ints) -> Bools:
    rows = np.zeros(theta_rad.size, dtype=np.bool_)
    turned = np.flatnonzero(np.diff(direction) != 0)
    if turned.size and np.ptp(theta_rad[: turned[0] + 1]) <= STANDS_STILL_RAD:
        rows[: turned[0] + 1] = True
    return rows
