"""A base that moves against the instrument while the poses are measured: how much, from the measurements alone."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.budget import Shared
from catseye.calibration.core.model import whitening_at
from catseye.calibration.core.restricted_likelihood import restricted_log_likelihoods
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.identification import Calibration
from catseye.calibration.serial_arm.model import ArmModel
from catseye.calibration.serial_arm.parameters import BaseFrame
from catseye.calibration.serial_arm.tried_sizes import tried_sizes

_SHIFTS = (BaseFrame("x_mm"), BaseFrame("y_mm"), BaseFrame("z_mm"))

_TRIED_MM = (0.01, 0.02, 0.035, 0.05, 0.07, 0.1, 0.14, 0.2, 0.35, 0.5, 1.0)
"""Sizes of the drift between the first and the last pose that are tried."""

_INTERVALS = 12
"""The drift is linear in so many intervals of the measuring order."""

_ORDERS = 999
"""Orders of the poses, drawn at random, that the measuring order is compared with."""

_SEED = 1


@dataclass(frozen=True)
class Drift:
    """How a base moves.

    Attributes:
        size: standard deviation of each coordinate between the first and the last pose of a random walk, in the
            measure of the stated uncertainties. One that takes a base far in small steps all the same way has a
            small one: `farthest_mm` says how far the base went.
        probability: of residuals that follow the measuring order so much when nothing moves.
    """

    size: float
    probability: float


def find_drift(calibration: Calibration) -> Drift | None:
    """Return the likeliest drift of the base; None where none is seen beyond chance, or nothing would show it.

    The likelihood gives the size alone. It takes the stated uncertainties, and what is known beforehand, for right up
    to one common factor; where they are not, or the model lacks something, poses scatter otherwise than stated, and
    that looks like a drift to it. Whether there is one is decided by the order of the poses, which no scatter heeds.

    That takes the measuring order for exchangeable, one of many that might as well have been. Where it has a system
    (sweeps of an axis, a grid) errors that the model lacks follow it too, and still look like a drift.
    """
    model, values = calibration.model, calibration.estimate.values
    shifted = _shifted(model, values)
    if shifted is None:
        return None
    sizes = tried_sizes(calibration, _TRIED_MM)
    likelihoods = restricted_log_likelihoods(
        whitening_at(model, values),
        model.jacobian(values),
        calibration.estimate.residuals_mm,
        _spread(shifted, _steps(model)),
        sizes,
    )
    best = int(np.argmax(likelihoods))
    if best == 0:
        return None
    probability = _by_chance(calibration, shifted)
    return Drift(sizes[best], probability) if probability <= SIGNIFICANCE else None


def _by_chance(calibration: Calibration, shifted: Floats) -> float:
    """Return how likely residuals follow an order of the poses as much as they follow the measuring order.

    How much they do is the slope of the likelihood where a drift begins: the square of their sums with the steps.
    """
    model, found = calibration.model, calibration.estimate
    pulls = whitening_at(model, found.values).forces(found.residuals_mm)
    numbers, where = np.unique(model.pose_of_row, return_inverse=True)
    forces = np.zeros((len(numbers), len(_SHIFTS)))
    np.add.at(forces, where, shifted * pulls[:, None])
    measured = numbers >= 0
    forces, steps = forces[measured], _steps_of_poses(int(measured.sum()))
    orders = np.random.default_rng(_SEED).permuted(np.tile(np.arange(len(forces)), (_ORDERS, 1)), axis=1)
    by_order = np.sum((steps.T @ forces[orders]) ** 2, axis=(1, 2))
    as_measured = np.sum((steps.T @ forces) ** 2)
    return float((1 + np.sum(by_order >= as_measured)) / (1 + _ORDERS))


def drift_errors(model: ArmModel, values: Floats, drift: Drift) -> Shared:
    """Return what rows share under a drift of the base."""
    shifted = _shifted(model, values)
    effects = np.zeros((model.rows, 0)) if shifted is None else _spread(shifted, _steps(model))
    return Shared("drift of the base", drift.size * effects)


def farthest_mm(calibration: Calibration, drift: Drift) -> float:
    """Return how far the base went from where it stood at the first pose, root mean square of its coordinates.

    Args:
        calibration: that knows the drift.
    """
    model, found = calibration.model, calibration.estimate
    effects = drift_errors(model, found.values, drift).effects_mm
    # What is expected of the steps, given the residuals.
    sources = effects.T @ whitening_at(model, found.values).forces(found.residuals_mm)
    steps = drift.size * sources.reshape(len(_SHIFTS), _INTERVALS) / np.sqrt(_INTERVALS)
    return float(np.sqrt(np.mean(np.cumsum(steps, axis=1) ** 2, axis=0)).max())


def _shifted(model: ArmModel, values: Floats) -> Floats | None:
    """Return what a shift of the base by 1 mm does to the rows, a column a coordinate, shape (n, 3).

    None where the base is not in the frame of an instrument.
    """
    shifts = [k for k, one in enumerate(model.chosen) if one.role in _SHIFTS]
    return model.jacobian(values)[:, shifts] if len(shifts) == len(_SHIFTS) else None


def _spread(shifted: Floats, steps: Floats) -> Floats:
    """Return what rows share under a drift of 1 mm, shape (n, 3 intervals)."""
    return np.asarray((shifted[:, :, None] * steps[:, None, :]).reshape(len(shifted), -1))


def _steps(model: ArmModel) -> Floats:
    """Return how far the base has gone at each row in each interval, shape (n, intervals)."""
    numbers, where = np.unique(model.pose_of_row, return_inverse=True)
    measured = numbers >= 0
    of_pose = np.zeros((len(numbers), _INTERVALS))
    of_pose[measured] = _steps_of_poses(int(measured.sum()))
    steps = of_pose[where]
    # The base of the calibration is where it stood on the average.
    at_pose = measured[where]
    steps[at_pose] -= steps[at_pose].mean(axis=0)
    return np.asarray(steps)


def _steps_of_poses(poses: int) -> Floats:
    """Return the same at each pose, in measuring order, less the mean, shape (poses, intervals)."""
    place = np.linspace(0.0, 1.0, poses)
    steps = np.clip(place[:, None] * _INTERVALS - np.arange(_INTERVALS), 0.0, 1.0) / np.sqrt(_INTERVALS)
    return np.asarray(steps - steps.mean(axis=0))
