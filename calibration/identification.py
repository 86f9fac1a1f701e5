"""From measured distances to the arm's parameters with their uncertainties."""

from dataclasses import dataclass

import numpy as np

from calibration.distance_model import DistanceModel, distance_model
from calibration.errors import InsufficientPointsError
from calibration.fit_statistics import FitStatistics, fit_statistics
from calibration.layout import Layout, ModelName
from calibration.least_squares import minimise
from calibration.observability import require_identifiable
from calibration.points import Points, without_short_segments
from calibration.types import Floats


@dataclass(frozen=True)
class Identification:
    """An identified arm.

    Attributes:
        layout: order of the parameters.
        parameters: estimates, mm and rad, shape (p,).
        covariance: of the estimates in the stated gauge, shape (p, p).
        points: the distances that were used.
        residuals_mm: predicted minus measured, shape (n,).
        fit: quality of the fit.
        rejected: sentences about what was left out.
    """

    layout: Layout
    parameters: Floats
    covariance: Floats
    points: Points
    residuals_mm: Floats
    fit: FitStatistics
    rejected: list[str]

    @property
    def standard_uncertainty(self) -> Floats:
        """Standard uncertainties (k = 1) of the parameters, shape (p,)."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


def identify(
    points: Points,
    model: ModelName,
    nodes1_rad: Floats,
    nodes2_rad: Floats,
    link1_mm: float,
    link2_mm: float,
    reflectors_mm: Floats,
) -> Identification:
    """Identify the arm from distances.

    Args:
        points: measured distances.
        model: "conventional" (L1, L2, θ20) or "error-map" (L1, L2, both maps).
        nodes1_rad: nodes of the J1 map, rad, strictly increasing.
        nodes2_rad: nodes of the J2 map, rad, strictly increasing.
        link1_mm: nominal length of link 1, mm.
        link2_mm: nominal length of link 2, mm.
        reflectors_mm: rough places of points.reflector_names, mm, shape (reflectors, 2).

    Raises:
        MapRangeError: a point lies outside the nodes.
        InsufficientPointsError: fewer points than parameters.
        UnidentifiableError: null directions beyond the gauge; the parameters are named.
        ConvergenceError: the iteration does not settle.
    """
    used, rejected = without_short_segments(points)
    rough = reflectors_mm[[points.reflector_names.index(name) for name in used.reflector_names]]
    empty = np.zeros(0)
    nodes = (nodes1_rad, nodes2_rad) if model == "error-map" else (empty, empty)
    layout = Layout(model, *nodes, used.reflector_names, used.dead_paths)
    _require_points(used, layout)
    distances = distance_model(layout, used)
    return _solve(distances, distances.start(link1_mm, link2_mm, rough), rejected)


def _solve(distances: DistanceModel, start: Floats, rejected: list[str]) -> Identification:
    layout, points = distances.layout, distances.points
    weights = np.ones(len(points)) if points.sigma_mm is None else 1.0 / points.sigma_mm
    basis = layout.gauge_basis()
    solution = minimise(distances.residuals, distances.jacobian, start, basis, weights)
    if not solution.factor.regular.all():
        require_identifiable(layout, solution.jacobian * weights[:, None], basis)
    fit = fit_statistics(points, solution.residuals, solution.jacobian, basis.shape[1], solution.iterations)
    covariance = fit.variance_factor * (basis @ solution.factor.covariance() @ basis.T)
    return Identification(layout, solution.parameters, covariance, points, solution.residuals, fit, rejected)


def _require_points(points: Points, layout: Layout) -> None:
    free = layout.gauge_basis().shape[1]
    if len(points) <= free:
        raise InsufficientPointsError(
            f"{len(points)} usable distances cannot determine {free} parameters of the {layout.model} model: "
            "measure more points, use fewer nodes or choose the conventional model"
        )
