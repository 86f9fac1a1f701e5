"""The errors of an identification's distances, contributor by contributor: what they do and how they are drawn."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.distributions import Shape, standard_draws
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import (
    Budget,
    Contributor,
    Geometry,
    combined_white_mm,
    effects,
    geometry_of,
    white_mm,
)
from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.identification import Identification


@dataclass(frozen=True)
class White:
    """Errors that differ from reading to reading.

    Attributes:
        name: of the contributor.
        sigma_mm: standard uncertainty of each distance, shape (n,).
        shape: distribution of an error; of the beam's angle for a cosine error.
        dof: degrees of freedom of the standard uncertainty.
        tilt_rad: standard uncertainty of the beam's angle; None where the errors are no cosine errors.
    """

    name: str
    sigma_mm: Floats
    shape: Shape = "normal"
    dof: float = math.inf
    tilt_rad: float | None = None

    def draw(self, rng: np.random.Generator, draws: int) -> Floats:
        """Return errors, mm, shape (draws, n)."""
        errors = standard_draws(self.shape, rng, (draws, self.sigma_mm.size))
        if self.tilt_rad is None:
            errors *= self.sigma_mm
        else:
            errors *= self.tilt_rad
            np.cos(errors, out=errors)
            np.subtract(1.0, errors, out=errors)
            # sigma is L u²/√2, what a cosine error scatters by to first order.
            errors *= self.sigma_mm * (math.sqrt(2.0) / self.tilt_rad**2)
        return _spread_by_dof(errors, self.dof, rng)


@dataclass(frozen=True)
class Shared:
    """Errors that several distances have in common.

    Attributes:
        name: of the contributor.
        effects_mm: what independent sources of unit variance do to the distances, shape (n, m).
        shape: distribution of a source.
        dof: degrees of freedom of the standard uncertainty.
    """

    name: str
    effects_mm: Floats
    shape: Shape = "normal"
    dof: float = math.inf

    def draw(self, rng: np.random.Generator, draws: int) -> Floats:
        """Return the sources, shape (draws, m)."""
        sources = standard_draws(self.shape, rng, (draws, self.effects_mm.shape[1]))
        return _spread_by_dof(sources, self.dof, rng)


@dataclass(frozen=True)
class DistanceErrors:
    """All errors of the distances.

    Attributes:
        white: those that differ from reading to reading.
        shared: those that several distances have in common.
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

    def draw(self, rng: np.random.Generator, draws: int) -> Floats:
        """Return errors of the distances, mm, shape (draws, n)."""
        first, *others = _merged(self.white)
        errors = first.draw(rng, draws)
        for white in others:
            errors += white.draw(rng, draws)
        if self.shared:
            sources = np.hstack([shared.draw(rng, draws) for shared in self.shared])
            errors += sources @ np.hstack([shared.effects_mm for shared in self.shared]).T
        errors *= math.sqrt(self.factor)
        return _spread_by_dof(errors, self.factor_dof, rng)


def distance_errors(identified: Identification) -> DistanceErrors:
    """Return the errors that an identification's uncertainties come from."""
    points, fit, budget = identified.points, identified.fit, identified.budget or Budget(())
    geometry = geometry_of(distance_model(identified.layout, points), identified.parameters)
    if points.sigma_mm is None:
        white: tuple[White, ...] = (White("scatter of the fit", np.ones(len(points))),)
    elif not budget.white:
        white = (White("sigma_mm of the points", points.sigma_mm),)
    else:
        # The weights were made at the starting values; what they are is what the contributors share.
        share = points.sigma_mm / combined_white_mm(budget, geometry)
        white = tuple(_white(one, geometry, share) for one in budget.white)
    return DistanceErrors(
        white,
        tuple(
            Shared(one.name, effects(one, geometry), one.distribution, one.dof) for one in budget.systematic
        ),
        fit.variance_factor,
        fit.dof if points.sigma_mm is None or fit.variance_factor != 1.0 else math.inf,
    )


def _white(one: Contributor, geometry: Geometry, share: Floats) -> White:
    tilt = one.u if one.kind == "direction" and one.u > 0.0 else None
    return White(one.name, share * white_mm(one, geometry), one.distribution, one.dof, tilt)


def _merged(white: tuple[White, ...]) -> list[White]:
    """Return fewer contributors that draw the same: normal errors, known for certain, add up to normal ones."""
    plain = [one for one in white if one.shape == "normal" and one.tilt_rad is None and math.isinf(one.dof)]
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
