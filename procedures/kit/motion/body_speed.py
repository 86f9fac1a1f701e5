"""How fast anything on the arm can be: bounds from the farthest body of each joint and the joints' full speeds."""

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.kinematics.bodies import outermost_levers
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.bench import Bench


def top_speed_mm_s(bench: Bench, percent: float) -> float:
    """Return what no point of the arm can exceed, all joints at their full speed in the same direction, mm/s.

    Args:
        bench: bodies, and fastest axes at 100 % override as the cell file states them.
        percent: speed override.
    """
    return float(_full_speeds(bench) @ _levers(bench)) * percent / 100.0


def fastest_mm_s(bench: Bench, start: Pose, end: Pose, percent: float) -> float:
    """Return what no point of the arm exceeds during a motion, mm/s.

    All joints begin and end together, so the one that needs longest sets the pace of the others. Every joint is
    taken to turn the farthest body with the longest lever that there is, all in the same direction.

    Args:
        percent: speed override.
    """
    travel = np.abs(np.subtract(end, start))
    duration_s = float((travel / _full_speeds(bench)).max()) * 100.0 / percent
    return float(travel @ _levers(bench)) / duration_s if duration_s else 0.0


def _full_speeds(bench: Bench) -> NDArray[np.float64]:
    return np.array([axis.speed for axis in bench.arm.axes])


def _levers(bench: Bench) -> NDArray[np.float64]:
    return outermost_levers(bench.workspace.chain, bench.workspace.bodies)
