"""The first rows of a Cartesian path, whose states of approach are said by an option and by no motion."""

import numpy as np

from catseye.app.results.scara.path_csv import STANDS_STILL_RAD
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.points import Commands


def against_start(commands: Commands) -> Bools:
    """Return the rows before a joint's first motion where that motion goes against their state, shape (n, 2).

    A path that is entered in its own direction has none.

    Args:
        commands: of a Cartesian path, n rows.
    """
    return np.column_stack(
        [
            _waiting(commands.theta1_rad, commands.direction1),
            _waiting(commands.theta2_rad, commands.direction2),
        ]
    )


def start_text(commands: Commands) -> str:
    """Return a sentence about a start that goes against the path; empty when none does.

    Args:
        commands: of a Cartesian path, n rows.
    """
    joints = np.logical_or.reduce(against_start(commands), axis=0)
    if not joints.any():
        return ""
    start = np.array([commands.direction1[0], commands.direction2[0]])
    given, along = (
        ",".join(str(state) for state in states) for states in (start, np.where(joints, -start, start))
    )
    names = " and ".join(f"J{joint + 1}" for joint in np.flatnonzero(joints))
    return (
        f"the first row counts as approached with the states {given} (--start-direction), and the path goes on with "
        f"{names} the other way: if the arm comes to it in the direction of the path, give --start-direction={along}"
    )


def _waiting(theta_rad: Floats, direction: Ints) -> Bools:
    rows = np.zeros(theta_rad.size, dtype=np.bool_)
    turned = np.flatnonzero(np.diff(direction) != 0)
    if turned.size and np.ptp(theta_rad[: turned[0] + 1]) <= STANDS_STILL_RAD:
        rows[: turned[0] + 1] = True
    return rows
