"""Distributions of input quantities: standard uncertainty and draws (GUM, JCGM 101)."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from catseye.calibration.core.types import Floats

Shape = Literal["normal", "uniform", "triangular", "arcsine"]

DIVISORS: dict[Shape, float] = {
    "normal": 1.0,
    "uniform": math.sqrt(3.0),
    "triangular": math.sqrt(6.0),
    "arcsine": math.sqrt(2.0),
}
"""Half width over standard uncertainty; a normal quantity is stated by its standard uncertainty."""

Size = int | tuple[int, ...]


class Distribution(Protocol):
    """What is known of an input quantity."""

    @property
    def mean(self) -> float:
        """Best estimate."""
        ...

    @property
    def u(self) -> float:
        """Standard uncertainty."""
        ...

    def draw(self, rng: np.random.Generator, size: Size) -> Floats:
        """Return independent draws."""
        ...


@dataclass(frozen=True)
class Normal:
    """Gaussian distribution."""

    mean: float
    u: float

    def draw(self, rng: np.random.Generator, size: Size) -> Floats:
        """Return independent draws."""
        return rng.normal(self.mean, self.u, size)


@dataclass(frozen=True)
class StudentT:
    """Scaled and shifted t-distribution: the mean of a few normal readings.

    Attributes:
        mean: average of the readings.
        scale: standard deviation of the average.
        dof: degrees of freedom; with 2 or fewer it has no standard deviation.
    """

    mean: float
    scale: float
    dof: float

    @property
    def u(self) -> float:
        """Standard deviation of the distribution, larger than its scale."""
        return self.scale * math.sqrt(self.dof / (self.dof - 2.0)) if self.dof > 2.0 else math.inf

    def draw(self, rng: np.random.Generator, size: Size) -> Floats:
        """Return independent draws."""
        return self.mean + self.scale * rng.standard_t(self.dof, size)


@dataclass(frozen=True)
class Bounded:
    """Uniform, triangular or arcsine distribution about its middle.

    Attributes:
        mean: middle.
        half_width: from the middle to either limit.
        shape: which of them.
    """

    mean: float
    half_width: float
    shape: Shape = "uniform"

    @property
    def u(self) -> float:
        """Standard uncertainty."""
        return self.half_width / DIVISORS[self.shape]

    def draw(self, rng: np.random.Generator, size: Size) -> Floats:
        """Return independent draws."""
        return self.mean + self.u * standard_draws(self.shape, rng, size)


@dataclass(frozen=True)
class Trapezoid:
    """Sum of two uniform distributions.

    Attributes:
        low: lower limit.
        high: upper limit.
        top: width of the top over the width of the base, 0 (triangle) to 1 (rectangle).
    """

    low: float
    high: float
    top: float

    @property
    def mean(self) -> float:
        """Middle."""
        return 0.5 * (self.low + self.high)

    @property
    def u(self) -> float:
        """Standard uncertainty."""
        return (self.high - self.low) * math.sqrt((1.0 + self.top**2) / 24.0)

    def draw(self, rng: np.random.Generator, size: Size) -> Floats:
        """Return independent draws."""
        first, second = rng.random(size), rng.random(size)
        return self.low + 0.5 * (self.high - self.low) * (
            (1.0 + self.top) * first + (1.0 - self.top) * second
        )


@dataclass(frozen=True)
class CurvilinearTrapezoid:
    """Uniform distribution whose half width is itself known to within a margin only.

    Attributes:
        mean: middle.
        half_width: middle of what the half width may be.
        margin: largest deviation of the half width from that.
    """

    mean: float
    half_width: float
    margin: float

    @property
    def u(self) -> float:
        """Standard uncertainty."""
        return math.sqrt(self.half_width**2 / 3.0 + self.margin**2 / 9.0)

    def draw(self, rng: np.random.Generator, size: Size) -> Floats:
        """Return independent draws."""
        width = rng.uniform(self.half_width - self.margin, self.half_width + self.margin, size)
        return self.mean + width * rng.uniform(-1.0, 1.0, size)


def standard_draws(shape: Shape, rng: np.random.Generator, size: Size) -> Floats:
    """Return independent draws of mean 0 and standard deviation 1."""
    return _STANDARD[shape](rng, size)


def _normal(rng: np.random.Generator, size: Size) -> Floats:
    return rng.standard_normal(size)


def _uniform(rng: np.random.Generator, size: Size) -> Floats:
    return rng.uniform(-DIVISORS["uniform"], DIVISORS["uniform"], size)


def _triangular(rng: np.random.Generator, size: Size) -> Floats:
    return DIVISORS["triangular"] * (rng.random(size) - rng.random(size))


def _arcsine(rng: np.random.Generator, size: Size) -> Floats:
    return np.asarray(DIVISORS["arcsine"] * np.sin(2.0 * np.pi * rng.random(size)), dtype=np.float64)


_STANDARD: dict[Shape, Callable[[np.random.Generator, Size], Floats]] = {
    "normal": _normal,
    "uniform": _uniform,
    "triangular": _triangular,
    "arcsine": _arcsine,
}
