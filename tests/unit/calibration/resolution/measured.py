"""Steps that were done, as steps that were measured without a recording: for what comes after the measurement."""

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.moves import moves_of
from catseye.calibration.resolution.noise import StepNoise
from catseye.calibration.resolution.plateaus import Plateaus
from catseye.calibration.resolution.steps import Steps
from catseye.calibration.resolution.units import Unit

DWELL_S = 5.0


def measured_steps(
    command: Floats, position: Floats, u_step: float, unit: Unit = "rad", u_scale: float = 0.0
) -> Steps:
    """Return steps between positions on plateaus.

    Args:
        command: shape (n,).
        position: on the plateaus, shape (n + 1,).
        u_step: standard uncertainty of each step.
    """
    moves = moves_of(100.0 + DWELL_S * np.arange(float(command.size)), command, unit)
    start_s = np.append(moves.time_s, moves.time_s[-1] + DWELL_S) - 2.0
    rests = Plateaus(start_s, 2.0, position, np.zeros(position.size), np.ones(position.size))
    done = np.diff(position)
    judged = np.abs(command) >= 3.0 * u_step
    noise = StepNoise(u_step, u_step, u_step)
    return Steps(moves, done, np.full(command.size, u_step), moves.time_s, judged, rests, noise, u_scale, ())


def decaying_steps(command: Floats, error_percent: Floats, u_step: float = 0.0) -> Steps:
    """Return steps with these errors."""
    done = command * (1.0 + error_percent / 100.0)
    return measured_steps(command, np.concatenate([[0.0], np.cumsum(done)]), u_step)
