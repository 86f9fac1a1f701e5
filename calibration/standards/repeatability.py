"""Pose repeatability after ISO 9283 from repeated arrivals, as positions or as distances to reflectors."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import (
    require_finite,
    require_not_negative,
    require_positive,
    require_shape,
)
from catseye.calibration.core.errors import InsufficientPointsError, UnidentifiableError
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.standards.iso9283 import distance_repeatability

_COVERAGE = 0.95

_PARALLEL = 0.15
"""Beams with a worse conditioning do not determine the spread of a position."""

GOOD_CONDITIONING = 0.3
"""Beams with a better conditioning determine it without magnifying the uncertainty of the variances much."""


@dataclass(frozen=True)
class AlongBeam:
    """Repeatability of one pose along one beam.

    Attributes:
        arrivals: how many.
        dof: degrees of freedom: arrivals less one for each segment, whose dead path is its own.
        mean_mm: mean displacement in the segment with the most arrivals.
        segment: that segment.
        s_um: standard deviation S, pooled over the segments, µm.
        s_low_um: lower end of the 95 % interval of S.
        s_high_um: upper end.
        range_um: largest difference within a segment, µm.
        drift_um: change over all cycles that a straight line sees, µm; None with fewer than 2 degrees of freedom.
        drift_probability: of a change this large by chance; None where drift_um is.
    """

    arrivals: int
    dof: int
    mean_mm: float
    segment: int
    s_um: float
    s_low_um: float
    s_high_um: float
    range_um: float
    drift_um: float | None
    drift_probability: float | None

    @property
    def rp_um(self) -> float:
        """Half width ±3 S of the repeatability along the beam (as RD in ISO 9283), µm."""
        return distance_repeatability(self.s_um)

    @property
    def drifts(self) -> bool:
        """The change over the cycles is more than chance."""
        return self.drift_probability is not None and self.drift_probability < SIGNIFICANCE


@dataclass(frozen=True)
class InPlane:
    """Spread of a position, from the variances along beams that were measured one after another.

    Attributes:
        covariance_um2: of x and y, µm², shape (2, 2).
        rp_um: l̄ + 3 S_l of a normal distribution with this covariance, µm.
        u_rp_um: its standard uncertainty from the degrees of freedom, µm; the assumption is not part of it.
        assumption: what had to be assumed; empty with three beams or more.
    """

    covariance_um2: Floats
    rp_um: float
    u_rp_um: float
    assumption: str


def along_beam(displacement_mm: Floats, segment: Ints, cycle: Ints) -> AlongBeam:
    """Return the repeatability of one pose along one beam.

    Args:
        displacement_mm: distances, mm, shape (n,); those of one segment share a dead path.
        segment: segment of each, shape (n,).
        cycle: cycle of each, shape (n,).

    Raises:
        InsufficientPointsError: no segment has two arrivals.
        ArgumentError: the columns do not fit together, or a distance is not finite.
    """
    require_finite(displacement_mm, "displacement_mm")
    require_shape(segment, displacement_mm.shape, "segment")
    require_shape(cycle, displacement_mm.shape, "cycle")
    names, first, group = np.unique(segment, return_index=True, return_inverse=True)
    counts = np.bincount(group)
    dof = displacement_mm.size - names.size
    if dof < 1:
        raise InsufficientPointsError(
            f"{displacement_mm.size} arrivals in {names.size} segments have no spread: the beam has to last from "
            "one cycle to the next; look for what breaks it"
        )
    # Counted from the first arrival, equal readings have exactly their own mean.
    from_first_mm = displacement_mm - displacement_mm[first][group]
    means = np.bincount(group, from_first_mm) / counts
    from_mean_um = 1e3 * (from_first_mm - means[group])
    s_um = math.sqrt(float(from_mean_um @ from_mean_um) / dof)
    low, high = interval_of_s(dof)
    largest = int(np.argmax(counts))
    drift, probability = _drift(from_mean_um, group, counts, cycle.astype(np.float64), dof)
    return AlongBeam(
        arrivals=int(displacement_mm.size),
        dof=dof,
        mean_mm=float(displacement_mm[first[largest]] + means[largest]),
        segment=int(names[largest]),
        s_um=s_um,
        s_low_um=low * s_um,
        s_high_um=high * s_um,
        range_um=max(float(np.ptp(from_mean_um[group == i])) for i in range(names.size)),
        drift_um=drift,
        drift_probability=probability,
    )


def interval_of_s(dof: int) -> tuple[float, float]:
    """Return the ends of the interval of a standard deviation as multiples of its estimate (chi-square)."""
    require_positive(dof, "dof")
    # Whoever only lists procedures imports this module too.
    from scipy import special

    tail = 0.5 * (1.0 - _COVERAGE)
    return (
        math.sqrt(dof / float(special.chdtri(dof, tail))),
        math.sqrt(dof / float(special.chdtri(dof, 1.0 - tail))),
    )


def _drift(
    from_mean_um: Floats, group: Ints, counts: Ints, cycle: Floats, dof: int
) -> tuple[float | None, float | None]:
    """Return the change over all cycles and its probability by chance; every segment has a level of its own."""
    from scipy import special

    within = cycle - (np.bincount(group, cycle) / counts)[group]
    square = float(within @ within)
    if dof < 2 or square <= 0.0:
        return None, None
    slope = float(within @ from_mean_um) / square
    left = from_mean_um - slope * within
    u_slope = math.sqrt(float(left @ left) / (dof - 1) / square)
    change = slope * float(np.ptp(cycle))
    if u_slope <= 1e-12 * abs(slope):
        return change, 0.0 if slope else 1.0
    return change, float(2.0 * special.stdtr(dof - 1, -abs(slope / u_slope)))


def in_plane(direction_rad: Floats, s_um: Floats, dof: Ints) -> InPlane:
    """Return the spread of a position from its standard deviations along beams.

    The beams are measured one after another, so only variances along them are known, no covariances between them.
    The variance along a beam at the angle φ is a + b cos 2φ + c sin 2φ: three beams determine a, b and c. With two,
    the roundest spread that fits is taken: smallest b² + c². Where none fits, as the scatter of the variances makes
    it with every sixth pose of a round arm, the spread is taken as round if the variances do not contradict that
    (Bartlett's test).

    Args:
        direction_rad: angles of the beams, rad, shape (k,), k >= 2.
        s_um: standard deviations along them, µm, shape (k,).
        dof: their degrees of freedom, shape (k,).

    Raises:
        InsufficientPointsError: fewer than two beams.
        UnidentifiableError: the beams are (nearly) parallel, or no spread has these variances, a round one neither.
        ArgumentError: the columns do not fit together, or a standard deviation is negative or no number.
    """
    require_finite(direction_rad, "direction_rad")
    for name, column in (("s_um", s_um), ("dof", dof)):
        require_shape(column, direction_rad.shape, name)
        require_not_negative(column, name)
    if direction_rad.size < 2:
        raise InsufficientPointsError(
            "one beam says nothing across itself: measure with two reflectors or more"
        )
    smallest = conditioning(direction_rad)
    if smallest < _PARALLEL:
        raise UnidentifiableError(
            "the beams are too nearly parallel to determine the spread of a position: choose poses from which the "
            "reflectors stand in clearly different directions",
            [["covariance of x and y"]],
        )
    design, variance = _design(direction_rad), s_um**2
    a, b, c = _elements(design, variance, dof)
    if a < math.hypot(b, c) or (a == math.hypot(b, c) and a > 0.0):
        return _round(s_um, dof)
    assumption = (
        "two beams determine two of the three elements of the covariance; of all spreads that fit, this is the "
        "roundest"
    )
    return InPlane(
        covariance_um2=np.array([[a + b, c], [c, a - b]]),
        rp_um=_normal_rp(a, math.hypot(b, c)),
        u_rp_um=_u_rp(design, variance, dof),
        assumption=assumption if direction_rad.size == 2 else "",
    )


def _round(s_um: Floats, dof: Ints) -> InPlane:
    """Return the round spread of variances that differ by chance.

    Raises:
        UnidentifiableError: they differ by more.
    """
    variance, probability = s_um**2, equal_variances(s_um, dof)
    if probability < SIGNIFICANCE:
        listed = ", ".join(f"{s:.1f}" for s in s_um)
        raise UnidentifiableError(
            f"no spread of a position has the standard deviations {listed} µm along these beams; they differ by more "
            "than their directions explain: look at their drift, or measure more cycles",
            [["covariance of x and y"]],
        )
    pooled = float(variance @ dof) / float(dof.sum())
    rp_um = _normal_rp(pooled, 0.0)
    return InPlane(
        covariance_um2=pooled * np.eye(2),
        rp_um=rp_um,
        u_rp_um=rp_um / math.sqrt(2.0 * float(dof.sum())),
        assumption=(
            "no spread has just these standard deviations along the beams; they differ no more than those of a round "
            f"spread do by chance (p = {probability:.2f}), which is taken"
        ),
    )


def equal_variances(s_um: Floats, dof: Ints) -> float:
    """Return how probable it is that standard deviations of one size differ as much by chance (Bartlett's test).

    Source: Bartlett, Proc. R. Soc. A 160 (1937) 268.

    Args:
        s_um: standard deviations, shape (k,), k >= 2.
        dof: their degrees of freedom, shape (k,).
    """
    # Whoever only lists procedures imports this module too.
    from scipy import special

    if not np.all(s_um > 0.0):
        return 1.0 if not np.any(s_um > 0.0) else 0.0
    variance, freedom = s_um**2, dof.astype(np.float64)
    all_of_them = float(freedom.sum())
    pooled = float(variance @ freedom) / all_of_them
    statistic = all_of_them * math.log(pooled) - float(freedom @ np.log(variance))
    correction = 1.0 + (float((1.0 / freedom).sum()) - 1.0 / all_of_them) / (3.0 * (s_um.size - 1))
    return float(special.chdtrc(s_um.size - 1, max(0.0, statistic) / correction))


def conditioning(direction_rad: Floats) -> float:
    """Return how well variances along beams determine a covariance: 0 if parallel, 1.2 for three beams 60° apart.

    Args:
        direction_rad: angles of the beams, rad, shape (k,), k >= 2.
    """
    return float(np.linalg.svd(_design(direction_rad), compute_uv=False)[-1])


def _design(direction_rad: Floats) -> Floats:
    return np.column_stack(
        [np.ones(direction_rad.size), np.cos(2.0 * direction_rad), np.sin(2.0 * direction_rad)]
    )


def _elements(design: Floats, variance: Floats, dof: Ints) -> tuple[float, float, float]:
    return _roundest(design, variance) if variance.size == 2 else _fitted(design, variance, dof)


def _u_rp(design: Floats, variance: Floats, dof: Ints) -> float:
    """Return what the uncertainties of the variances, each its own share sqrt(2 / dof), make of RP."""
    square = 0.0
    for k in range(variance.size):
        change = np.zeros(variance.size)
        change[k] = 1e-4 * variance[k]
        ends = [_elements(design, variance + sign * change, dof) for sign in (1.0, -1.0)]
        high, low = (_normal_rp(a, min(a, math.hypot(b, c))) for a, b, c in ends)
        square += ((high - low) / 2e-4) ** 2 * 2.0 / float(dof[k])
    return math.sqrt(square)


def _roundest(design: Floats, variance: Floats) -> tuple[float, float, float]:
    """Return a, b, c that give both variances with the smallest b² + c²."""
    step = design[0, 1:] - design[1, 1:]
    b, c = step * float(variance[0] - variance[1]) / float(step @ step)
    a = float(variance[0]) - float(design[0, 1] * b + design[0, 2] * c)
    return a, float(b), float(c)


def _fitted(design: Floats, variance: Floats, dof: Ints) -> tuple[float, float, float]:
    """Return a, b, c by least squares, weighted with the degrees of freedom.

    A weight of the variances themselves would favour those that happen to be small.
    """
    weight = np.sqrt(dof)
    a, b, c = np.linalg.lstsq(design * weight[:, None], variance * weight, rcond=None)[0]
    return float(a), float(b), float(c)


def _normal_rp(mean_variance: float, difference: float) -> float:
    """Return E l + 3 sd l of the distance l from the mean, for principal variances mean ± difference."""
    from scipy import special

    largest, smallest = mean_variance + difference, mean_variance - difference
    if largest <= 0.0:
        return 0.0
    mean = math.sqrt(2.0 * largest / math.pi) * float(special.ellipe(1.0 - smallest / largest))
    return mean + 3.0 * math.sqrt(max(2.0 * mean_variance - mean**2, 0.0))
