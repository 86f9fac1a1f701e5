"""What the plateaus of a test say of its drift: whether that of a minute of standstill holds for all of it.

The slope on a plateau is that of the drift and of the joint, which creeps on for seconds the way that it moved.
So plateaus alone do not tell how large a steady drift is, but they contradict one that the joint would have to creep
backwards for, and they show one that comes and goes.
"""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from catseye.calibration.core.residuals import NORMAL_MAD
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.flags import Flag
from catseye.calibration.resolution.least_step import WINDOW
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.noise import StepNoise
from catseye.calibration.resolution.plateaus import Plateaus
from catseye.calibration.resolution.units import shown

_FEWEST_BLOCKS: Final = 6
"""Of as many plateaus as a moving mean takes: creep that grows and shrinks takes three of them."""

_CREEP_TERMS: Final = 3
_CHANGED: Final = 1e-3
"""Probability below which the drift counts as changing: noise in air is not white, so that means differ a little."""

_OUTLIER: Final = 4.0
"""Standard deviations at which a slope is cut off: a joint that moves on a plateau is no drift."""


@dataclass(frozen=True)
class PlateauDrift:
    """Slopes on the plateaus behind the moves of one direction.

    Attributes:
        forward_per_s: their mean in the direction of the moves, creep included, units a second.
        u_per_s: its standard uncertainty.
        wander_per_s: standard deviation of the drift over the test, from the means of as many plateaus as a moving
            mean takes, without what noise and creep do to them.
        probability: of means so different without any change of the drift.
    """

    forward_per_s: float
    u_per_s: float
    wander_per_s: float
    probability: float

    @property
    def changes(self) -> bool:
        """The drift comes and goes."""
        return self.probability < _CHANGED


def drift_of_plateaus(rests: Plateaus, moves: Moves) -> PlateauDrift | None:
    """Return what plateaus say of the drift; None where they are too few, or the moves change their direction."""
    # Whoever only lists procedures imports this module too.
    from scipy import special

    slope = moves.directions * rests.half_difference[1:] / (0.5 * rests.length_s)
    known = np.isfinite(slope)
    count = int(np.count_nonzero(known)) // WINDOW
    if count < _FEWEST_BLOCKS or np.unique(moves.directions).size > 1:
        return None
    slope, left = _without_creep(slope[known], rests.middle_s[1:][known])
    blocks = np.array_split(left, count)
    dof = count - _CREEP_TERMS, left.size - count
    between = sum(block.size * float(block.mean()) ** 2 for block in blocks) / dof[0]
    within = sum(float(np.sum((block - block.mean()) ** 2)) for block in blocks) / dof[1]
    wander = math.sqrt(max(0.0, between - within) * count / left.size)
    u = math.sqrt(within / left.size)
    probability = float(special.fdtrc(*dof, between / max(within, 1e-300)))
    return PlateauDrift(float(slope.mean()), u, wander, probability)


def with_plateau_drift(noise: StepNoise, rests: Plateaus, moves: Moves) -> StepNoise:
    """Return noise whose drift the plateaus do not contradict, and whose u knows how it comes and goes.

    Args:
        noise: with the drift of the standstill.
    """
    found = drift_of_plateaus(rests, moves)
    if found is None:
        return noise
    direction = float(moves.directions[0])
    apart = found.forward_per_s - direction * noise.drift_per_s
    limit, wander = _limit(math.hypot(found.u_per_s, noise.u_drift_per_s)), 0.0
    if found.changes:
        # The standstill shows the drift of one minute, a step feels that of another.
        wander = math.sqrt(2.0) * found.wander_per_s
    drift, u, change = noise.drift_per_s, math.hypot(noise.u_drift_per_s, wander), found.wander_per_s
    flags = noise.flags
    if apart < -limit:
        drift, u = direction * found.forward_per_s, math.hypot(found.u_per_s, found.wander_per_s)
        change = max(change, -apart)
        flags = (*(flag for flag in flags if flag.kind != "drift"), *_drift_flags(drift, noise, moves))
    elif apart > limit:
        # It may be creep: nothing confirms that the drift of a minute lasts, and nothing speaks against it.
        u = math.hypot(u, drift)
    if not (found.changes or apart < -limit):
        change = 0.0
    return replace(noise, drift_per_s=drift, u_drift_per_s=u, drift_change_per_s=change, flags=flags)


def _drift_flags(drift_per_s: float, noise: StepNoise, moves: Moves) -> tuple[Flag, ...]:
    each = drift_per_s * moves.dwell_s
    if abs(each) <= noise.step:
        return ()
    text = (
        f"the plateaus drift by {shown(each, moves.unit)} from one to the next, which contradicts the standstill: "
        "their drift is subtracted from every step"
    )
    return (Flag("drift", text),)


def _limit(u: float) -> float:
    # Whoever only lists procedures imports this module too.
    from scipy import special

    return -float(special.ndtri(0.5 * SIGNIFICANCE)) * u


def _without_creep(slope: Floats, time_s: Floats) -> tuple[Floats, Floats]:
    """Return slopes whose outliers are cut off, and what slowly changing creep leaves of them, shape (n,) each."""
    place = (time_s - time_s.mean()) / np.ptp(time_s)
    powers = np.vander(place, _CREEP_TERMS)
    off = slope - np.median(slope)
    most = _OUTLIER * float(np.median(np.abs(off))) / NORMAL_MAD
    cut = np.median(slope) + np.clip(off, -most, most)
    return cut, cut - powers @ np.linalg.lstsq(powers, cut, rcond=None)[0]
