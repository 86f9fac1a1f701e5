"""Radial error motion of an axis after ISO 230-7, from what indicators read at an artefact that turns with it.

An artefact that is not centred runs on a circle about the axis. The least-squares centre of that circle is taken out;
what is left of the readings is the error motion along each sensitive direction, with the artefact's deviation from
roundness. Over less than a full turn, everything refers to the arc that was measured and to the centre that this arc
shows. Where indicators read in two directions, the circle is common to both. With one direction alone, the whole
first harmonic is taken out: it cannot be told from the eccentricity then.
"""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from catseye.calibration.core.arguments import (
    require_directions,
    require_finite,
    require_not_negative,
    require_shape,
)
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Bools, Floats, Ints

FEWEST_PLACES: Final = 7
"""Angles at which an error motion is read: the circle takes three of them."""

_OUTSIDE: Final = 0.05
"""Share of cases in which a true average value may be outside its interval."""


@dataclass(frozen=True)
class RunOut:
    """Readings at an artefact, shape (n,) each: every place in every cycle from either side, in every direction.

    Attributes:
        angle_rad: of the joint.
        direction_rad: in which an indicator reads, in the frame of what carries the axis; in a reversed mounting
            that in which the indicator stood before.
        reading_um: grows as the artefact comes nearer to the indicator.
        approach: 1 where the joint came upwards, -1 downwards.
        cycle: number of the cycle.
        zero: number of the zero of the indicators: a new one begins where they may have been moved.
        turned: the artefact is turned by half a turn against the joint and the indicator stands on the other side
            (reversal after Donaldson).
    """

    angle_rad: Floats
    direction_rad: Floats
    reading_um: Floats
    approach: Ints
    cycle: Ints
    zero: Ints
    turned: Bools

    def __post_init__(self) -> None:
        """Check shapes and values."""
        require_shape(self.angle_rad, (None,), "angle_rad")
        for name in ("direction_rad", "reading_um", "approach", "cycle", "zero", "turned"):
            require_shape(getattr(self, name), self.angle_rad.shape, name)
        for name in ("angle_rad", "direction_rad", "reading_um"):
            require_finite(getattr(self, name), name)
        require_directions(self.approach, "approach")


@dataclass(frozen=True)
class Gauging:
    """What is known of indicator and artefact.

    Attributes:
        resolution_um: step of a reading.
        u_indicator_um: standard uncertainty of a reading beside its resolution; None where nobody knows.
        form_um: deviation of the artefact from roundness, peak to valley; None where nobody knows. A reversal
            measures it.
    """

    resolution_um: float
    u_indicator_um: float | None = None
    form_um: float | None = None

    def __post_init__(self) -> None:
        """Check the values."""
        for name in ("resolution_um", "u_indicator_um", "form_um"):
            if (value := getattr(self, name)) is not None:
                require_not_negative(value, name)


@dataclass(frozen=True)
class Eccentricity:
    """How the artefact runs about the axis.

    Attributes:
        size_um: distance of its centre from the axis.
        nearest_rad: angle of the joint at which it is nearest to an indicator in direction 0.
        mean_um: what the indicators read in the middle of the circle, in the order of the directions; empty where
            they had several zeros.
    """

    size_um: float
    nearest_rad: float
    mean_um: tuple[float, ...]


@dataclass(frozen=True)
class DirectionValues:
    """Values of ISO 230-7 along one sensitive direction, µm.

    Attributes:
        direction_rad: of them.
        total_um: total error motion value: range of all readings about the least-squares centre.
        average_um: average (synchronous) error motion value: range of the means over the cycles.
        asynchronous_um: asynchronous error motion value: largest range of one place over the cycles.
        reversal_um: largest difference of a place between the two sides from which the joint comes.
    """

    direction_rad: float
    total_um: float
    average_um: float
    asynchronous_um: float
    reversal_um: float


@dataclass(frozen=True)
class ErrorMotion:
    """Radial error motion of an axis over an arc.

    Attributes:
        angle_rad: places, upwards, shape (m,).
        motion_um: mean over the cycles, shape (directions, 2, m): come to downwards, then upwards.
        form_um: deviation of the artefact in each direction, shape (directions, m); None without a reversal.
        values: along each direction.
        eccentricity: in each mounting.
        rms_um: of the mean motion, over the directions, without what scatter adds: what an error budget takes.
        u_rms_um: its standard uncertainty; what nobody knows of indicator and artefact is not in it.
        expanded_average_um: half of an interval about an average value that holds the true one in 95 % of cases or
            more; the same holds. A total value has none: it is the range of what was read, scatter included.
        scatter_um: standard deviation of a reading from cycle to cycle, pooled over all places.
        dof: its degrees of freedom.
    """

    angle_rad: Floats
    motion_um: Floats
    form_um: Floats | None
    values: tuple[DirectionValues, ...]
    eccentricity: tuple[Eccentricity, ...]
    rms_um: float
    u_rms_um: float
    expanded_average_um: float
    scatter_um: float
    dof: int

    @property
    def budget_dof(self) -> float:
        """Degrees of freedom of `rms_um` as a standard uncertainty (GUM G.4.2)."""
        if self.u_rms_um == 0.0:
            return math.inf
        return max(1.0, 0.5 * (self.rms_um / self.u_rms_um) ** 2)


def eccentricity_of(angle_rad: Floats, direction_rad: Floats, reading_um: Floats) -> Eccentricity:
    """Return how an artefact runs, from single readings, shape (n,) each.

    Raises:
        InsufficientPointsError: fewer than three angles.
    """
    directions, own = np.unique(direction_rad, return_inverse=True)
    if np.unique(angle_rad).size < 3:
        raise InsufficientPointsError("an eccentricity takes readings at three angles of the joint or more")
    design = np.hstack([_members(own, directions.size), _circle(angle_rad - direction_rad)])
    solved = np.asarray(np.linalg.lstsq(design, reading_um, rcond=None)[0], dtype=np.float64)
    return _eccentricity(solved)


def error_motion(run_out: RunOut, gauging: Gauging) -> ErrorMotion:
    """Return the radial error motion that readings show.

    Raises:
        InsufficientPointsError: too few places, a single cycle, a place that was not read in every cycle from
            either side, or zeros that leave nothing to compare.
    """
    order, shape = _grid(run_out)
    levelled, zeros = _levelled(run_out, order, shape)
    residual_um, eccentricity = about_centre(levelled)
    # Mounting, direction, approach, place, cycle.
    left = residual_um[order].reshape(shape)
    mean, (mountings, directions, _, _, cycles) = left.mean(axis=-1), shape
    reversal = mountings == 2
    form = 0.5 * (mean[0] + mean[1]) if reversal else np.zeros_like(mean[0])
    motion = 0.5 * (mean[0] - mean[1]) if reversal else mean[0]
    sign = np.array([1.0, -1.0])[:mountings].reshape(-1, 1, 1, 1, 1)
    every = sign * (left - form[None, ..., None])
    dof = left.size - mean.size - (zeros - mountings * directions)
    if dof < 1:
        raise InsufficientPointsError(
            f"{zeros} zeros of the indicators in {left.size} readings: nothing is left to tell scatter by; measure "
            "again with fewer interruptions"
        )
    variance = float(((left - mean[..., None]) ** 2).sum()) / dof
    known = _Known(gauging, variance, 2 * mountings * cycles, reversal=reversal)
    rms_um, u_rms_um = known.rms(motion.mean(axis=1), directions + 2)
    return ErrorMotion(
        angle_rad=np.unique(run_out.angle_rad),
        motion_um=motion,
        form_um=form.mean(axis=1) if reversal else None,
        values=tuple(
            DirectionValues(
                direction_rad=float(direction_rad),
                total_um=float(np.ptp(every[:, number])),
                average_um=float(np.ptp(motion[number])),
                asynchronous_um=float(np.ptp(left[:, number], axis=-1).max()),
                reversal_um=float(np.abs(motion[number, 1] - motion[number, 0]).max()),
            )
            for number, direction_rad in enumerate(np.unique(run_out.direction_rad))
        ),
        eccentricity=eccentricity,
        rms_um=rms_um,
        u_rms_um=u_rms_um,
        expanded_average_um=known.expanded_range(means=motion[0].size, dof=dof),
        scatter_um=math.sqrt(variance),
        dof=dof,
    )


def _grid(run_out: RunOut) -> tuple[Ints, tuple[int, int, int, int, int]]:
    """Return the order of the readings by mounting, direction, approach, place and cycle, and how many of each."""
    keys = (run_out.turned, run_out.direction_rad, run_out.approach, run_out.angle_rad, run_out.cycle)
    mountings, directions, sides, places, cycles = (np.unique(key).size for key in keys)
    if places < FEWEST_PLACES or cycles < 2 or sides != 2:
        raise InsufficientPointsError(
            f"{places} places in {cycles} cycle(s): an error motion takes {FEWEST_PLACES} places or more, each read "
            "from either side in two cycles or more"
        )
    size = mountings * directions * sides * places * cycles
    if run_out.angle_rad.size != size or len(np.unique(np.stack(keys), axis=1).T) != size:
        raise InsufficientPointsError(
            f"{run_out.angle_rad.size} readings instead of {size}: every place has to be read once in every cycle, "
            "from either side and in every direction"
        )
    order: Ints = np.lexsort(keys[::-1])
    return order, (mountings, directions, sides, places, cycles)


def about_centre(run_out: RunOut) -> tuple[Floats, tuple[Eccentricity, ...]]:
    """Return the readings about the least-squares centre, µm, and the circle of each mounting.

    Each zero counts by the mean of what was read with it: that of `error_motion`, which compares equal places, is
    better as soon as there are cycles.
    """
    turned = run_out.turned.astype(np.float64)
    phase = _circle(run_out.angle_rad - run_out.direction_rad - np.pi * turned)
    zeros = _zeros(run_out)
    mountings = (phase * (turned == each)[:, None] for each in np.unique(turned))
    design = np.hstack([zeros, *mountings])
    solved = np.linalg.lstsq(design, run_out.reading_um, rcond=None)[0]
    circles = solved[zeros.shape[1] :].reshape(-1, 2)
    return run_out.reading_um - design @ solved, tuple(map(_eccentricity, circles))


def _zeros(run_out: RunOut) -> Floats:
    """Return which readings share a zero, shape (n, zeros): each indicator has its own."""
    keys = np.stack([run_out.turned, run_out.direction_rad, run_out.zero])
    found, own = np.unique(keys, axis=1, return_inverse=True)
    return _members(own.ravel(), found.shape[1])


def _levelled(run_out: RunOut, order: Ints, shape: tuple[int, int, int, int, int]) -> tuple[RunOut, int]:
    """Return the readings as if all cycles had one zero, and how many zeros there were.

    Zeros are compared at equal places, so that a new one in the middle of a cycle takes nothing of the motion along.
    """
    zeros = _zeros(run_out)
    apart = zeros[order].reshape(*shape, -1)
    apart = (apart - apart.mean(axis=-2, keepdims=True)).reshape(order.size, -1)
    reading = run_out.reading_um[order].reshape(shape)
    reading = (reading - reading.mean(axis=-1, keepdims=True)).ravel()
    shift = np.linalg.lstsq(apart, reading, rcond=None)[0]
    level = run_out.reading_um - zeros @ shift
    return replace(run_out, reading_um=level, zero=np.zeros_like(run_out.zero)), zeros.shape[1]


def _members(own: Ints, count: int) -> Floats:
    return np.asarray(own[:, None] == np.arange(count), dtype=np.float64)


def _circle(angle_rad: Floats) -> Floats:
    return np.stack([np.cos(angle_rad), -np.sin(angle_rad)], axis=1)


def _eccentricity(solved: Floats) -> Eccentricity:
    *mean, x, y = solved.tolist()
    return Eccentricity(math.hypot(x, y), -math.atan2(y, x), tuple(mean))


@dataclass(frozen=True)
class _Known:
    """What is known of the mean motion at a place.

    Attributes:
        scatter_um2: variance of a reading.
        readings: that it is the mean of.
        reversal: the artefact's form is taken out.
    """

    gauging: Gauging
    scatter_um2: float
    readings: int
    reversal: bool

    def random_um2(self, readings: float) -> float:
        """Return the variance of what differs from place to place in the mean of so many readings.

        That is scatter, and rounding where there is too little of it: readings that scatter by more than a step are
        rounded differently each time, and the scatter holds it then.
        """
        rounding_um2 = max(0.0, self.gauging.resolution_um**2 / 12.0 - self.scatter_um2)
        return self.scatter_um2 / readings + rounding_um2

    @property
    def _form_um(self) -> float:
        """Half of the artefact's deviation, as far as it is in the motion."""
        return 0.0 if self.reversal else 0.5 * (self.gauging.form_um or 0.0)

    @property
    def _indicator_um(self) -> float:
        return self.gauging.u_indicator_um or 0.0

    def rms(self, motion_um: Floats, fitted: int) -> tuple[float, float]:
        """Return the rms of a motion without what is random, and its standard uncertainty, µm.

        Args:
            motion_um: of any shape.
            fitted: parameters of zero and circle, which took their part of what is random.
        """
        count, random = motion_um.size, self.random_um2(self.readings)
        square = max(0.0, float(np.mean(motion_um**2)) - random * (1.0 - fitted / count))
        u_square = math.sqrt((2.0 * random**2 + 4.0 * square * random) / count)
        rms = math.sqrt(square)
        # The interval of two u is that of the square, which stays sound where there is next to nothing.
        low, high = (math.sqrt(max(0.0, square + side * 2.0 * u_square)) for side in (-1.0, 1.0))
        u_random = 0.5 * max(rms - low, high - rms)
        return rms, math.hypot(u_random, self._indicator_um, self._form_um / math.sqrt(3.0))

    def expanded_range(self, means: int, dof: int) -> float:
        """Return how far the range of the means from one side may be from the true one, µm: U of 95 % or more.

        Noise makes a range larger, by no more than its own range: the largest difference of two of its values, of
        which each pair is given its part of the 5 % (Bonferroni).

        Args:
            means: places from either side.
            dof: of the scatter.
        """
        from scipy import special

        pairs = 0.5 * means * (means - 1)
        each_um2 = self.random_um2(self.readings / 2)
        random_um = float(special.stdtrit(dof, 1.0 - 0.5 * _OUTSIDE / pairs)) * math.sqrt(2.0 * each_um2)
        form_um = 2.0 * self._form_um / math.sqrt(3.0)
        return math.hypot(random_um, 2.0 * math.sqrt(2.0) * self._indicator_um, 2.0 * form_um)
