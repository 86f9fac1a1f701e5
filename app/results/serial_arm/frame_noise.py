"""What the noise of fixed nests makes of a calibration: it moves the world frame against the arm, for all poses.

No residual shows it. It is in the base, and by that in where the arm is said to put its targets in this frame.
"""

import numpy as np

from catseye.app.results.serial_arm.result import ParameterPart, SerialArmResult
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.geometry import turning_axis
from catseye.calibration.serial_arm.parameters import FRAME_PARTS

_RAD = float(np.deg2rad(1.0))


def with_frame_noise(result: SerialArmResult, frame: Floats) -> SerialArmResult:
    """Return a result whose base is as uncertain as the frame that it is stated in.

    Args:
        frame: covariance of small shifts, mm, and turns, deg, of the frame in itself, about its origin, shape (6, 6).
    """
    parts = [one for one in result.parameters if one.identified]
    rows = {one.name.removeprefix("base."): k for k, one in enumerate(parts) if one.name.startswith("base.")}
    kept = [part for part in FRAME_PARTS if part in rows]
    moved = _base_rates(result)[[FRAME_PARTS.index(part) for part in kept]]
    u = np.array([one.u for one in parts])
    covariance = np.array(result.correlation).reshape(len(u), len(u)) * np.outer(u, u)
    where = [rows[part] for part in kept]
    covariance[np.ix_(where, where)] += moved @ frame @ moved.T
    wider = np.sqrt(np.diag(covariance))
    scale = np.where(wider > 0.0, wider, 1.0)
    correlation = covariance / np.outer(scale, scale)
    np.fill_diagonal(correlation, np.diag(np.array(result.correlation).reshape(len(u), len(u))))
    known = {part.name: float(its_u) for part, its_u in zip(parts, wider, strict=True)}
    return result.model_copy(
        update={
            "parameters": [
                _wider(one, known[one.name]) if one.identified else one for one in result.parameters
            ],
            "correlation": correlation.tolist(),
        }
    )


def _wider(part: ParameterPart, u: float) -> ParameterPart:
    """Return a parameter with a larger uncertainty; an interval widens with it."""
    times = u / part.u if part.u else 1.0
    ends = {
        name: None if end is None else part.value + times * (end - part.value)
        for name, end in (("low", part.low), ("high", part.high))
    }
    return part.model_copy(update={"u": u, **ends})


def _base_rates(result: SerialArmResult) -> Floats:
    """Return how place and angles of the base change with shifts, mm, and turns, deg, of its frame, shape (6, 6)."""
    values = {one.name: one.value for one in result.parameters}
    # A result of another program may have no base of its own.
    base = np.array([values.get(f"base.{part}", 0.0) for part in FRAME_PARTS])
    rates = np.eye(6)
    rates[:3, 3:] = _RAD * np.cross(np.eye(3), base[:3]).T
    axes = np.column_stack([turning_axis(base[3:], part) for part in FRAME_PARTS[3:]])
    rates[3:, 3:] = np.linalg.pinv(axes)
    return rates
