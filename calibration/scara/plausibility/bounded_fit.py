"""An arm fitted to distances with what was known of it before: it settles where the distances leave much open.

What was known enters as if it had been measured: links, deviations and places by their bounds. Bounds are wide, so
distances that belong to another arm still show it; but a node that nothing touches stays where it was, and a frame
needs no gauge. That makes corrections comparable whose tables an identification would refuse.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.least_squares import Solution, factorise, minimise
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening
from catseye.calibration.scara.distance_model import DistanceModel, distance_model
from catseye.calibration.scara.layout import Layout, ModelName
from catseye.calibration.scara.plausibility.bounds import Bounds
from catseye.calibration.scara.plausibility.case import Case, Free
from catseye.calibration.scara.plausibility.findings import DeviationOff, LinkOff, Offset, PlaceOff

_HELD_MM: Final = 1e-3
"""Standard uncertainty of a length that is not to move."""


@dataclass(frozen=True)
class BoundedFit:
    """A case solved.

    Attributes:
        case: what was solved.
        layout: order of the parameters.
        parameters: of the arm, mm and rad, shape (p,).
        scale: what the displacements were multiplied by.
        residuals_mm: predicted minus measured, shape (n,).
        solution: of parameters and scale; its rows are the distances, then what was known before.
    """

    case: Case
    layout: Layout
    parameters: Floats
    scale: float
    residuals_mm: Floats
    solution: Solution

    @property
    def rms_mm(self) -> float:
        """Root mean square of the residuals."""
        return float(np.sqrt(np.mean(self.residuals_mm**2)))

    @cached_property
    def u_scale(self) -> float:
        """Standard uncertainty of the scale for distances as good as the case says."""
        return float(np.sqrt(self.solution.factor.covariance()[-1, -1]))

    @property
    def u_links_mm(self) -> Floats:
        """Standard uncertainties of the links from the distances alone, without what was known before, shape (2,)."""
        distances, basis = distance_model(self.layout, self.case.points), self.layout.gauge_basis()
        slopes = distances.jacobian(self.parameters) * self.case.weights[:, None]
        return np.sqrt(np.diag(factorise(slopes @ basis).covariance_on(basis))[:2])

    @property
    def places_mm(self) -> Floats:
        """Places of the reflectors, shape (reflectors, 2)."""
        return self.parameters[self.layout.reflectors].reshape(-1, 2)

    def strain(self, bounds: Bounds) -> float:
        """Return the largest share of a bound that the arm uses up; above 1 it is beyond one."""
        return max(off.share for off in offsets(self.layout, self.parameters, self.case, bounds))


def fitted(case: Case, bounds: Bounds, start_mm: Floats | None = None) -> BoundedFit | None:
    """Solve a case.

    Args:
        start_mm: places that the iteration starts from, shape (reflectors, 2); None for the rough ones.

    Returns:
        None where the iteration does not settle.
    """
    points = case.points
    model: ModelName = "error-map" if case.nodes_rad[0].size else "conventional"
    layout = Layout(model, *case.nodes_rad, points.reflector_names, points.dead_paths)
    distances = distance_model(layout, points)
    known = np.append(distances.start(*case.links_mm, case.places_mm), 1.0)
    start = known.copy()
    if start_mm is not None:
        start[:-1] = distances.start(*case.links_mm, start_mm)
    rows = _Rows(distances, known)
    try:
        solution = minimise(
            rows.residuals,
            rows.jacobian,
            start,
            np.eye(start.size)[:, : start.size - (case.free != "scale")],
            Whitening.of(np.concatenate([case.weights, 1.0 / _spread(layout, bounds, case.free)])),
        )
    except ConvergenceError:
        return None
    return BoundedFit(
        case,
        layout,
        solution.parameters[:-1],
        float(solution.parameters[-1]),
        solution.residuals[: len(points)],
        solution,
    )


@dataclass(frozen=True)
class _Rows:
    """Residuals of the distances, then of what was known before; the last parameter is the scale."""

    distances: DistanceModel
    known: Floats

    def residuals(self, values: Floats) -> Floats:
        scaled = (values[-1] - 1.0) * self.distances.points.displacement_mm
        return np.concatenate([self.distances.residuals(values[:-1]) - scaled, values - self.known])

    def jacobian(self, values: Floats) -> Floats:
        measured = -self.distances.points.displacement_mm[:, None]
        return np.vstack(
            [np.hstack([self.distances.jacobian(values[:-1]), measured]), np.eye(self.known.size)]
        )


def _spread(layout: Layout, bounds: Bounds, free: Free | None) -> Floats:
    """Return the standard uncertainties of what was known before; infinite for what was not, shape (p + 1,)."""
    spread = np.full(layout.size + 1, np.inf)
    if free != "links":
        spread[:2] = bounds.link_mm
    if free == "scale":
        # Scaled distances are those of a scaled arm: a link has to say how large the arm is.
        spread[0] = _HELD_MM
    spread[layout.map1] = spread[layout.map2] = bounds.deviation_rad
    spread[layout.reflectors] = bounds.place_mm
    return spread


def offsets(layout: Layout, parameters: Floats, case: Case, bounds: Bounds) -> Iterator[Offset]:
    """Return how far an arm is from what was known of it: links, the largest deviation of each joint, places.

    Args:
        layout: order of its parameters.
        parameters: of the arm and its reflectors, shape (p,).
        case: what was known before.
    """
    if case.free != "links":
        yield LinkOff(1, float(parameters[0]), case.links_mm[0], bounds.link_mm)
        yield LinkOff(2, float(parameters[1]), case.links_mm[1], bounds.link_mm)
    first, second = parameters[layout.map1], parameters[layout.map2]
    if first.size:
        yield DeviationOff(1, float(first[np.abs(first).argmax()]), bounds.deviation_rad)
    yield DeviationOff(2, float(second[np.abs(second).argmax()]), bounds.deviation_rad)
    found = parameters[layout.reflectors].reshape(-1, 2).tolist()
    for name, place, rough in zip(layout.reflector_names, found, case.places_mm.tolist(), strict=True):
        yield PlaceOff(name, (place[0], place[1]), (rough[0], rough[1]), bounds.place_mm)
