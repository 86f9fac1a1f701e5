"""How well a step is known: from the standstill before the first move, or from the plateaus where there is none."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.flags import Flag
from catseye.calibration.resolution.lowess import half_window, velocity
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.recording import Recording
from catseye.calibration.resolution.speed import speed_of
from catseye.calibration.resolution.standstill import SHORTEST_S, Standstill, standstill
from catseye.calibration.resolution.units import shown

LONGEST_S = 60.0
"""How much of the recording before the first move counts as its standstill."""

_MOTION = 10.0
"""Velocities this many times the usual one are motion, not noise."""

_AFTER_MOTION_S = 1.0
_NORMAL_MAD = 1.4826


@dataclass(frozen=True)
class StepNoise:
    """Noise of what steps are made of, in units of the position.

    Attributes:
        step: standard uncertainty of a step: of the difference of two plateaus' means.
        half_plateau: of the difference of the means of a plateau's halves.
        velocity: standard deviation of the smoothed velocity, units a second.
        drift_per_s: what is subtracted: the standstill's drift where it is significant, else 0; that of the plateaus
            where they contradict it.
        u_drift_per_s: standard uncertainty of the drift that is left; 0 where nothing is known of it.
        drift_change_per_s: how far the drift of the test differs from that of the standstill by the plateaus; 0 where
            they show no difference.
        flags: what was subtracted, or why nothing is known.
    """

    step: float
    half_plateau: float
    velocity: float
    drift_per_s: float = 0.0
    u_drift_per_s: float = 0.0
    drift_change_per_s: float = 0.0
    flags: tuple[Flag, ...] = ()


def standstill_before(recording: Recording, moves: Moves, guard_s: float) -> Standstill | None:
    """Return the standstill at the end of what was recorded before the first move; None if it is under 10 s.

    Args:
        guard_s: time before the first move that does not count, s.
    """
    end_s = float(moves.time_s[0]) - guard_s
    before = recording.clipped(end_s - LONGEST_S, end_s)
    if before.position.size < SHORTEST_S * recording.rate_hz:
        return None
    # The guard on either side is what the smoothing takes from the ends.
    around = recording.clipped(end_s - LONGEST_S - guard_s, end_s + guard_s)
    speed = np.abs(speed_of(around))
    moving = np.flatnonzero(speed > _MOTION * _NORMAL_MAD * np.nanmedian(speed))
    if moving.size:
        after_s = around.start_s + float(moving[-1]) / recording.rate_hz + _AFTER_MOTION_S
        before = before.clipped(after_s, end_s)
    if before.position.size < SHORTEST_S * recording.rate_hz:
        return None
    return standstill(before)


def noise_of_standstill(
    still: Standstill, recording: Recording, plateau_s: float, apart_s: float
) -> StepNoise:
    """Return the noise of steps from the standstill.

    Args:
        plateau_s: time that the mean of a plateau is taken over, s.
        apart_s: from one plateau to the next, s.
    """
    step, half = still.u_of_step(plateau_s, apart_s), still.u_of_step(0.5 * plateau_s, 0.5 * plateau_s)
    reach = half_window(still.rate_hz)
    speed = float(velocity(still.noise, still.rate_hz)[reach:-reach].std())
    if not still.significant:
        return StepNoise(step, half, speed, u_drift_per_s=still.u_drift_per_s)
    # What is less than u of a step belongs to every good recording.
    flags: tuple[Flag, ...] = ()
    if abs(still.drift_per_s) * apart_s > step:
        flags = (_drift_flag(still, recording, apart_s),)
    return StepNoise(step, half, speed, still.drift_per_s, still.u_drift_per_s, flags=flags)


def _drift_flag(still: Standstill, recording: Recording, apart_s: float) -> Flag:
    each = shown(still.drift_per_s * apart_s, recording.unit)
    text = (
        f"the position drifts by {each} from one plateau to the next while the arm stands still (p = "
        f"{still.probability:.1g}): the drift is subtracted from every step"
    )
    return Flag("drift", text)


def noise_of_plateaus(halves: Floats, speeds: Floats) -> StepNoise:
    """Return the noise of steps from the plateaus alone, as if it were white between them.

    Args:
        halves: differences of the means of each plateau's halves, NaN where one is not known, shape (n,).
        speeds: smoothed velocities on the plateaus, NaN likewise, shape (m,).
    """
    # A joint that has not come to rest makes a few differences large; they say nothing about the noise.
    half = _NORMAL_MAD * float(np.nanmedian(np.abs(halves)))
    speed = _NORMAL_MAD * float(np.nanmedian(np.abs(speeds)))
    text = (
        "the recording shows no 10 s of rest before the first move: noise comes from the plateaus, and neither drift "
        "nor slow noise is known; record 60 s of standstill first"
    )
    return StepNoise(half / math.sqrt(2.0), half, speed, flags=(Flag("no-standstill", text),))
