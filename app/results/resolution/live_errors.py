"""Step errors of a series under way, with the moving mean and scatter that its result will be judged by."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.app.protocol.run_events import LiveStepData
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.resolution.least_step import first_grown, moving_mean, moving_spread, steps_within


@dataclass(frozen=True)
class LiveErrors:
    """What is known of the steps so far, each array of shape (steps,).

    Attributes:
        command: signed size, deg or mm.
        error_percent: of the command.
        below: the command lies below what the instrument resolves.
        mean_percent: 11-point moving mean of the others, NaN where there are none; None where steps do not decrease.
        spread_percent: their standard deviation about it.
        least: smallest step down to which the mean keeps within the band, in their unit; None for none, and where
            steps were not seen.
    """

    command: Floats
    error_percent: Floats
    below: Bools
    mean_percent: Floats | None = None
    spread_percent: Floats | None = None
    least: float | None = None


def live_errors(steps: Sequence[LiveStepData]) -> LiveErrors:
    """Return the errors of the steps that were seen, with their moving mean where they decrease."""
    command = np.array([step.command for step in steps])
    error = np.array([step.error_percent for step in steps])
    below = np.array([step.below for step in steps], dtype=np.bool_)
    if len(steps) < 2 or np.ptp(np.sign(command)) > 0.0 or first_grown(np.abs(command)) is not None:
        return LiveErrors(command, error, below)
    judged = np.where(below, np.nan, error)
    mean = np.where(below, np.nan, moving_mean(judged))
    spread = moving_spread(judged, mean)
    within = int(steps_within(mean, steps[-1].band_percent))
    # Whoever came later, or could not keep up, has not seen every larger step, as the rule demands.
    whole = steps[0].number == 1 and steps[-1].number == len(steps)
    least = float(abs(command[within - 1])) if within and whole else None
    return LiveErrors(command, error, below, mean, spread, least)
