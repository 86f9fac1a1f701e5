"""The errors of rows, contributor by contributor: what they do, what rows share, how they are drawn (JCGM 101)."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from catseye.calibration.core.arguments import require_one_of
from catseye.calibration.core.types import Floats, Ints

Distribution = Literal["normal", "uniform", "triangular", "arcsine"]

_DIVISORS: dict[Distribution, float] = {
    "uniform": math.sqrt(3.0),
    "triangular": math.sqrt(6.0),
    "arcsine": math.sqrt(2.0),
}
"""Half width over standard uncertainty."""


@dataclass(frozen=True)
class White:
    """Errors that differ from row to row.

    Attributes:
        sigma_mm: standard uncertainty of each row, shape (n,).
        distribution: of an error; of the angle for a cosine error.
        dof: degrees of freedom of the standard uncertainty.
        tilt_rad: standard uncertainty of the angle of a cosine error; None for any other error.
    """

    name: str
    sigma_mm: Floats
    distribution: Distribution = "normal"
    dof: float = math.inf
    tilt_rad: float | None = None

    def draw(self, rng: np.random.Generator, draws: int) -> Floats:
        """Return errors, mm, shape (draws, n)."""
        errors = standard_draws(self.distribution, rng, (draws, self.sigma_mm.size))
        if self.tilt_rad is None:
            errors *= self.sigma_mm
        else:
            errors *= self.tilt_rad
            np.square(errors, out=errors)
            # 1 − cos δ to the sixth order, ten times as fast as a cosine: what is left out is 4e-8 of it at 17°.
            errors *= 0.5 - errors * (1.0 / 24.0 - errors / 720.0)
            # sigma is L u²/√2, what a cosine error scatters by to first order.
            errors *= self.sigma_mm * (math.sqrt(2.0) / self.tilt_rad**2)
        return _spread_by_dof(errors, self.dof, rng)


@dataclass(frozen=True)
class Shared:
    """Errors that several rows have in common.

    Attributes:
        effects_mm: what independent sources of unit variance do to the rows, shape (n, m).
        dof: degrees of freedom of the standard uncertainty.
        part: number of the part of the error that each source belongs to, shape (m,), where the rows are to say how
            large each part is; None where the error is as large as stated.
        assumed: nobody knows its size beforehand: the rows may find any, and it says nothing of other errors.
    """

    name: str
    effects_mm: Floats
    distribution: Distribution = "normal"
    dof: float = math.inf
    part: Ints | None = None
    assumed: bool = False

    def draw(self, rng: np.random.Generator, draws: int) -> Floats:
        """Return the sources, shape (draws, m)."""
        sources = standard_draws(self.distribution, rng, (draws, self.effects_mm.shape[1]))
        return _spread_by_dof(sources, self.dof, rng)


@dataclass(frozen=True)
class RowErrors:
    """All errors of the rows.

    Attributes:
        white: those that differ from row to row.
        shared: those that several rows have in common.
        factor: what the fit widens all variances by.
        factor_dof: degrees of freedom of that factor; infinite where nothing is widened.
    """

    white: tuple[White, ...]
    shared: tuple[Shared, ...]
    factor: float
    factor_dof: float

    @property
    def contributors(self) -> tuple[White | Shared, ...]:
        """All of them, white ones first."""
        return (*self.white, *self.shared)

    @cached_property
    def _effects_mm(self) -> Floats:
        """Effects of all sources, shape (m, n)."""
        return np.vstack([shared.effects_mm.T for shared in self.shared])

    def draw(self, rng: np.random.Generator, draws: int) -> Floats:
        """Return errors of the rows, mm, shape (draws, n)."""
        first, *others = _merged(self.white)
        errors = first.draw(rng, draws)
        for white in others:
            errors += white.draw(rng, draws)
        if self.shared:
            sources = np.hstack([shared.draw(rng, draws) for shared in self.shared])
            errors += sources @ self._effects_mm
        errors *= math.sqrt(self.factor)
        return _spread_by_dof(errors, self.factor_dof, rng)


def _merged(white: tuple[White, ...]) -> list[White]:
    """Return fewer contributors that draw the same: normal errors, known for certain, add up to normal ones."""
    plain = [
        one for one in white if one.distribution == "normal" and one.tilt_rad is None and math.isinf(one.dof)
    ]
    if len(plain) < 2:
        return list(white)
    sigma = np.sqrt(np.sum([one.sigma_mm**2 for one in plain], axis=0))
    return [White("normal errors", sigma), *(one for one in white if one not in plain)]


def _spread_by_dof(errors: Floats, dof: float, rng: np.random.Generator) -> Floats:
    """Let a standard uncertainty that is itself an estimate differ from draw to draw.

    A normal error whose standard deviation was estimated has a t-distribution; the deviation is common to all of a
    draw's errors, so they share one factor.
    """
    if math.isinf(dof):
        return errors
    factor = np.sqrt(dof / rng.chisquare(dof, errors.shape[0]))
    return np.asarray(errors * factor[:, None], dtype=np.float64)


def stacked(shared: Sequence[Shared], rows: int) -> Floats:
    """Return the effects of all sources side by side, mm, shape (rows, m)."""
    return np.hstack([np.zeros((rows, 0)), *(one.effects_mm for one in shared)])


def harmonics(angle: Floats, orders: int) -> Floats:
    """Return cosine and sine of 1…orders times the angle, in turn, shape (n, 2 · orders)."""
    turns = np.empty((angle.size, orders), dtype=np.complex128)
    turns[:, 0].real, turns[:, 0].imag = np.cos(angle), np.sin(angle)
    for k in range(1, orders):
        np.multiply(turns[:, k - 1], turns[:, 0], out=turns[:, k])
    return turns.view(np.float64)


def per_angle(columns: Floats, angle: Floats, spectrum: Sequence[float]) -> Floats:
    """Give each harmonic of an angle a source of its own for each column.

    Args:
        columns: what a unit error does to each row, shape (n, k).
        angle: that the error repeats with, rad, shape (n,).
        spectrum: share of each harmonic from the first on in the variance.

    Returns:
        Effects, shape (n, k · 2 · orders); `harmonic_of_source` says which harmonic each belongs to.
    """
    sizes = np.repeat(np.sqrt(spectrum), 2)
    spread = columns[:, :, None] * (harmonics(angle, len(spectrum)) * sizes)[:, None, :]
    return np.asarray(spread.reshape(angle.size, -1), dtype=np.float64)


def harmonic_of_source(columns: int, orders: int) -> Ints:
    """Return the place of each source's harmonic in the spectrum, shape (columns · 2 · orders,)."""
    return np.tile(np.repeat(np.arange(orders), 2), columns)


def per_group(columns: Floats, group: Ints, groups: int | None = None) -> Floats:
    """Give each group a source of its own for each column.

    Args:
        columns: what a unit error does to each row, shape (n, k).
        group: number of the group that shares an error, shape (n,).
        groups: how many there are, where rows belong to some of them only.

    Returns:
        Effects, shape (n, k · groups).
    """
    own = np.zeros((columns.shape[0], columns.shape[1], int(group.max()) + 1 if groups is None else groups))
    own[np.arange(group.size), :, group] = columns
    return own.reshape(columns.shape[0], -1)


def standard_draws(
    distribution: Distribution, rng: np.random.Generator, size: int | tuple[int, ...]
) -> Floats:
    """Return independent draws of mean 0 and standard deviation 1."""
    if distribution not in _STANDARD:
        require_one_of(Distribution, distribution, "distribution")
    return _STANDARD[distribution](rng, size)


def _uniform(rng: np.random.Generator, size: int | tuple[int, ...]) -> Floats:
    return rng.uniform(-_DIVISORS["uniform"], _DIVISORS["uniform"], size)


def _triangular(rng: np.random.Generator, size: int | tuple[int, ...]) -> Floats:
    return _DIVISORS["triangular"] * (rng.random(size) - rng.random(size))


def _arcsine(rng: np.random.Generator, size: int | tuple[int, ...]) -> Floats:
    return np.asarray(_DIVISORS["arcsine"] * np.sin(2.0 * np.pi * rng.random(size)), dtype=np.float64)


_STANDARD: dict[Distribution, Callable[[np.random.Generator, int | tuple[int, ...]], Floats]] = {
    "normal": lambda rng, size: rng.standard_normal(size),
    "uniform": _uniform,
    "triangular": _triangular,
    "arcsine": _arcsine,
}
