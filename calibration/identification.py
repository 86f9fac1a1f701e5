"""From measured distances to the arm's parameters with their uncertainties."""

from dataclasses import dataclass

import numpy as np

from calibration.budget import RadialBudget, radial_effects
from calibration.distance_model import DistanceModel, distance_model
from calibration.errors import InsufficientPointsError
from calibration.fit_statistics import FitStatistics, WeightedFit, fit_statistics, point_weights
from calibration.layout import Layout, ModelName
from calibration.least_squares import Solution, minimise
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
    radial: RadialBudget | None = None,
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
        radial: radial error motions, which widen the uncertainties beyond points.sigma_mm; None for none.

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
    start = distances.start(link1_mm, link2_mm, rough)
    basis = layout.gauge_basis()
    solution = minimise(distances.residuals, distances.jacobian, start, basis, point_weights(used))
    if not solution.factor.regular.all():
        require_identifiable(layout, solution.jacobian * point_weights(used)[:, None], basis)
    return _judge(distances, solution, radial, rejected)


def _judge(
    distances: DistanceModel, solution: Solution, radial: RadialBudget | None, rejected: list[str]
) -> Identification:
    """Attach statistics and covariance to a solution."""
    points, layout, weights = distances.points, distances.layout, point_weights(distances.points)
    basis = layout.gauge_basis()
    white = basis @ solution.factor.covariance() @ basis.T
    jacobian = solution.jacobian * weights[:, None]
    effects = _effects(distances, solution, radial) * weights[:, None]
    # How the systematic contributors shift the estimate, and what of them stays in the residuals.
    shifts = white @ (jacobian.T @ effects)
    weighted = WeightedFit(
        points,
        solution.residuals * weights,
        jacobian,
        effects - jacobian @ shifts,
        basis.shape[1],
        solution.iterations,
        bidirectional=layout.model == "error-map",
    )
    fit = fit_statistics(weighted)
    covariance = fit.variance_factor * (white + shifts @ shifts.T)
    return Identification(layout, solution.parameters, covariance, points, solution.residuals, fit, rejected)


def _effects(distances: DistanceModel, solution: Solution, radial: RadialBudget | None) -> Floats:
    if radial is None:
        return np.zeros((len(distances.points), 0))
    return radial_effects(distances.points, distances.beam_unit(solution.parameters), radial)


def _require_points(points: Points, layout: Layout) -> None:
    free = layout.gauge_basis().shape[1]
    if len(points) <= free:
        raise InsufficientPointsError(
            f"{len(points)} usable distances cannot determine {free} parameters of the {layout.model} model: "
            "measure more points, use fewer nodes or choose the conventional model"
        )
