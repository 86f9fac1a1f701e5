"""Places of the reflectors and the beam's zero direction from J4 angles that hit (Eq. 2, corrected)."""

from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.arguments import require_below, require_finite, require_shape
from catseye.calibration.core.errors import InsufficientPointsError, UnidentifiableError
from catseye.calibration.core.least_squares import minimise
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.core.whitening import Whitening
from catseye.calibration.scara.planar import forward, require_links, wrap_rad
from catseye.calibration.scara.pointing import beam_direction


@dataclass(frozen=True)
class Sightings:
    """Poses at which the beam hits the centre of a reflector.

    Attributes:
        theta1_rad: J1 angles, rad, shape (n,).
        theta2_rad: J2 angles, rad, shape (n,).
        j4_rad: J4 angles of the centre of the return window, rad, shape (n,).
        reflector: index of the reflector, shape (n,).
    """

    theta1_rad: Floats
    theta2_rad: Floats
    j4_rad: Floats
    reflector: Ints

    def __post_init__(self) -> None:
        for name in ("theta2_rad", "j4_rad", "reflector"):
            require_shape(getattr(self, name), self.theta1_rad.shape, name)
        for name in ("theta1_rad", "theta2_rad", "j4_rad"):
            require_finite(getattr(self, name), name)

    def select(self, rows: Bools) -> "Sightings":
        """Return the chosen sightings."""
        return Sightings(
            self.theta1_rad[rows], self.theta2_rad[rows], self.j4_rad[rows], self.reflector[rows]
        )


@dataclass(frozen=True)
class SearchResult:
    """What a search found.

    Attributes:
        reflectors_mm: places, mm, shape (reflectors, 2).
        theta40_rad: direction of the beam at J4 = 0 on the straight arm, rad.
        covariance: of (x1, y1, x2, y2, …, θ40), mm and rad, from the scatter of the sightings.
        residuals_rad: aim that the result predicts minus the aim found, shape (n,).
    """

    reflectors_mm: Floats
    theta40_rad: float
    covariance: Floats
    residuals_rad: Floats

    @property
    def u_reflectors_mm(self) -> Floats:
        """Standard uncertainties of the places, mm, shape (reflectors, 2)."""
        return np.sqrt(np.diag(self.covariance)[:-1]).reshape(-1, 2)

    @property
    def u_theta40_rad(self) -> float:
        """Standard uncertainty of θ40, rad."""
        return float(np.sqrt(self.covariance[-1, -1]))

    @property
    def u_sighting_rad(self) -> float:
        """Standard uncertainty of one sighting, from the scatter of all, rad."""
        dof = self.residuals_rad.size - self.covariance.shape[0]
        return float(np.sqrt(self.residuals_rad @ self.residuals_rad / dof))

    def predicted_rad(self, xy_mm: Floats, reflector: int) -> float:
        """Return the J4 angle plus θ1 and θ2 at which the beam hits a reflector from a position, rad."""
        return float(beam_direction(xy_mm, self.reflectors_mm[reflector])) - self.theta40_rad

    def with_sighting(self, xy_mm: Floats, reflector: int) -> "SearchResult":
        """Return the result with the covariance that one more sighting of the same quality would leave.

        Args:
            xy_mm: where the J4 axis would stand, mm, shape (2,).
            reflector: index of the reflector that would be looked at.
        """
        gradient = self._gradient(xy_mm, reflector)
        seen = self.covariance @ gradient
        variance = self.u_sighting_rad**2 + float(gradient @ seen)
        if variance == 0.0:
            return self
        return replace(self, covariance=self.covariance - np.outer(seen, seen) / variance)

    def u_prediction_rad(self, xy_mm: Floats, reflector: int) -> float:
        """Return the standard uncertainty of one further sighting against its prediction, rad."""
        gradient = self._gradient(xy_mm, reflector)
        return float(np.sqrt(self.u_sighting_rad**2 + gradient @ self.covariance @ gradient))

    def _gradient(self, xy_mm: Floats, reflector: int) -> Floats:
        """Return the derivatives of a predicted angle, shape (unknowns,)."""
        beam = self.reflectors_mm[reflector] - xy_mm
        square = float(beam @ beam)
        gradient = np.zeros(self.covariance.shape[0])
        gradient[2 * reflector : 2 * reflector + 2] = -beam[1] / square, beam[0] / square
        gradient[-1] = -1.0
        return gradient

    def aim_uncertainty_mm(self, xy_mm: Floats, reflector: int) -> Floats:
        """Return the standard uncertainty of the beam's place at a reflector, mm, shape (...).

        Args:
            xy_mm: positions of the J4 axis, mm, shape (..., 2).
            reflector: index of the reflector.
        """
        beam = self.reflectors_mm[reflector] - xy_mm
        length = np.hypot(beam[..., 0], beam[..., 1])
        gradient = np.zeros((*length.shape, self.covariance.shape[0]))
        gradient[..., 2 * reflector] = -beam[..., 1] / length
        gradient[..., 2 * reflector + 1] = beam[..., 0] / length
        gradient[..., -1] = -length
        variance = np.einsum("...i,ij,...j->...", gradient, self.covariance, gradient)
        return np.asarray(np.sqrt(variance), dtype=np.float64)


def locate_reflectors(
    sightings: Sightings, link1_mm: float, link2_mm: float, rough_mm: Floats, theta40_rad: float = 0.0
) -> SearchResult:
    """Solve Eq. 2 for all reflectors and one θ40 together.

    Args:
        sightings: at least three poses a reflector, better more, spread over the workspace.
        link1_mm: nominal length of link 1, mm.
        link2_mm: nominal length of link 2, mm.
        rough_mm: rough places, mm, shape (reflectors, 2).
        theta40_rad: rough zero direction, rad.

    Raises:
        InsufficientPointsError: fewer sightings than unknowns, or a reflector with fewer than two.
        UnidentifiableError: the poses do not separate the places from θ40.
        ConvergenceError: the iteration does not settle.
        ArgumentError: a link is not positive, or a sighting is of a reflector without a rough place.
    """
    require_links(link1_mm, link2_mm)
    require_shape(rough_mm, (None, 2), "rough_mm")
    require_finite(rough_mm, "rough_mm")
    count = rough_mm.shape[0]
    require_below(sightings.reflector, count, "reflector")
    _require_sightings(sightings, count)
    xy_mm = forward(sightings.theta1_rad, sightings.theta2_rad, link1_mm, link2_mm)
    found = sightings.theta1_rad + sightings.theta2_rad + sightings.j4_rad
    rows = np.arange(sightings.j4_rad.size)

    def residuals(parameters: Floats) -> Floats:
        places = parameters[:-1].reshape(-1, 2)[sightings.reflector]
        return wrap_rad(beam_direction(xy_mm, places) - parameters[-1] - found)

    def jacobian(parameters: Floats) -> Floats:
        beam = parameters[:-1].reshape(-1, 2)[sightings.reflector] - xy_mm
        square = np.sum(beam**2, axis=1)
        matrix = np.zeros((rows.size, 2 * count + 1))
        matrix[rows, 2 * sightings.reflector] = -beam[:, 1] / square
        matrix[rows, 2 * sightings.reflector + 1] = beam[:, 0] / square
        matrix[:, -1] = -1.0
        return matrix

    start = np.append(np.ravel(rough_mm), theta40_rad)
    solution = minimise(residuals, jacobian, start, np.eye(start.size), Whitening.of(np.ones(rows.size)))
    if not solution.factor.regular.all():
        raise UnidentifiableError(
            "the search poses do not separate the reflector's place from the beam's zero direction: "
            "search at poses spread over the workspace",
            [["reflectors", "θ40"]],
        )
    dof = rows.size - start.size
    variance = float(solution.residuals @ solution.residuals) / dof
    return SearchResult(
        reflectors_mm=solution.parameters[:-1].reshape(-1, 2),
        theta40_rad=float(wrap_rad(solution.parameters[-1:])[0]),
        covariance=variance * solution.factor.covariance(),
        residuals_rad=solution.residuals,
    )


def _require_sightings(sightings: Sightings, count: int) -> None:
    hits = np.bincount(sightings.reflector, minlength=count)
    if hits.min() < 2 or hits.sum() <= 2 * count + 1:
        raise InsufficientPointsError(
            f"{int(hits.sum())} sightings of {count} reflector(s) cannot determine {2 * count + 1} unknowns: "
            "each reflector needs two or more and all together more than the unknowns; search at more poses"
        )
