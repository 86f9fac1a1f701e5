"""Errors of distances that do not average out: radial error motions of the axes as functions of their angles.

The axis of a rotary joint displaces while it turns (ISO 230-7). The displacement repeats with the angle, so it is
common to all distances measured at that angle: it biases an identification instead of scattering it.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_count, require_not_negative
from catseye.calibration.core.budget import harmonics
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.points import Points


@dataclass(frozen=True)
class RadialBudget:
    """Radial error motions (Table 2 of the SCARA paper: 5, 5 and 10 µm).

    Attributes:
        j1_mm: rms displacement of the J1 axis in x and in y.
        j2_mm: the same of the J2 axis, in the frame of link 1.
        j4_mm: the same of the J4 axis, in the frame of link 2.
        orders: harmonics 1…orders of the angle share the displacement evenly.
    """

    j1_mm: float
    j2_mm: float
    j4_mm: float
    orders: int = 5

    def __post_init__(self) -> None:
        require_not_negative([self.j1_mm, self.j2_mm, self.j4_mm], "radial error motions")
        require_count(self.orders, "orders")


def radial_effects(points: Points, unit: Floats, budget: RadialBudget) -> Floats:
    """Return the effects of independent unit-variance contributors on the distances.

    Args:
        points: where the arm was sent, n rows.
        unit: unit vectors from the reflector to the arm, shape (n, 2).

    Returns:
        Effects, mm, shape (n, 12 · orders); the covariance that they give the distances is E Eᵀ.
    """
    theta1, theta2 = points.commands.theta1_rad, points.commands.theta2_rad
    world = np.arctan2(-unit[:, 1], -unit[:, 0])
    mount = 0.0 if points.mount_rad is None else points.mount_rad
    parts = (
        (budget.j1_mm, theta1, np.zeros_like(theta1)),
        (budget.j2_mm, theta2, theta1),
        (budget.j4_mm, world - theta1 - theta2 - mount, theta1 + theta2),
    )
    return np.hstack([_joint(unit, rms, angle, frame, budget.orders) for rms, angle, frame in parts])


def axis_frame(unit: Floats, frame: Floats) -> Floats:
    """Return unit vectors in a frame that is turned against the world, shape (n, 2).

    Args:
        unit: unit vectors in the world, shape (n, 2).
        frame: angle of the frame, rad, shape (n,).
    """
    cosine, sine = np.cos(frame), np.sin(frame)
    return np.stack(
        [unit[:, 0] * cosine + unit[:, 1] * sine, unit[:, 1] * cosine - unit[:, 0] * sine], axis=1
    )


def _joint(unit: Floats, rms_mm: float, angle: Floats, frame: Floats, orders: int) -> Floats:
    """Return the effects of one joint; its axis displaces in a frame that is turned against the world."""
    effects = axis_frame(unit, frame)[:, :, None] * harmonics(angle, orders)[:, None, :]
    return np.asarray(rms_mm / np.sqrt(orders) * effects.reshape(angle.size, 4 * orders), dtype=np.float64)
