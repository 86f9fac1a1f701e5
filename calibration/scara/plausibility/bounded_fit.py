"""An arm fitted to distances with what was known of it before: it settles where the distances leave much open.

What was known enters as if it had been measured: links, deviations and places by their bounds. Bounds are wide, so
distances that belong to another arm still show it; but a node that nothing touches stays where it was, and a frame
needs no gauge. That makes corrections comparable whose tables an identification would refuse.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Literal

import numpy as np

from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.least_squares import Solution, minimise
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.distance_model import DistanceModel, distance_model
from catseye.calibration.scara.layout import Layout, ModelName
from catseye.calibration.scara.plausibility.bounds import Bounds
from catseye.calibration.scara.plausibility.findings import DeviationOff, LinkOff, Offset, PlaceOff
from catseye.calibration.scara.points import Points

Free = Literal["scale", "links"]
"""What nothing was known of: the scale of the displacements, the lengths of the links."""

_SIGMA_MM: Final = 0.02
"""Standard uncertainty of distances that state none; only its ratio to the bounds counts."""

_FEW_NODES: Final = 6
"""Nodes of a map where the problem states none."""

_DISTRUSTED_MM: Final = 100.0
"""Standard uncertainty of distances that are not to move an arm far."""

_HELD_MM: Final = 1e-3
"""Standard uncertainty of a length that is not to move."""

_SEED: Final = 1

_EXACT: Final = 1e-9


@dataclass(frozen=True)
class Case:
    """Distances, and what was known of the arm and the reflectors before.

    Attributes:
        points: n distances.
        nodes_rad: nodes of both maps; empty for a mere offset of J2.
        links_mm: nominal lengths.
        places_mm: rough places of points.reflector_names, mm, shape (reflectors, 2).
        free: what nothing was known of.
        rows: which of all distances they are, from 0, shape (n,); None for all of them.
    """

    points: Points
    nodes_rad: tuple[Floats, Floats]
    links_mm: tuple[float, float]
    places_mm: Floats
    free: Free | None = None
    rows: Ints | None = None

    def number(self, row: int) -> int:
        """Return which of all distances a row is, from 0."""
        return row if self.rows is None else int(self.rows[row])

    @property
    def weights(self) -> Floats:
        """Reciprocal standard uncertainties, 1/mm, shape (n,)."""
        return (
            np.full(len(self.points), 1.0 / _SIGMA_MM)
            if self.points.sigma_mm is None
            else self.points.weights
        )

    @property
    def without_maps(self) -> "Case":
        """The same with links, an offset of J2 and reflectors only: few unknowns, soon solved."""
        return replace(self, nodes_rad=(np.zeros(0), np.zeros(0)))

    @property
    def distrusted(self) -> "Case":
        """The same with distances so uncertain that the arm stays near what was known of it."""
        sigma = np.full(len(self.points), _DISTRUSTED_MM)
        return replace(self, points=replace(self.points, sigma_mm=sigma))

    def thinned(self, most: int) -> "Case":
        """Return the case of some of the distances, in measuring order."""
        size = len(self.points)
        if size <= most:
            return self
        # At random: every k-th row may be one and the same node of a grid.
        rows = np.sort(np.random.default_rng(_SEED).choice(size, most, replace=False))
        kept = self.points.rows(rows)
        paths, number = np.unique(kept.dead_path, return_inverse=True)
        kept = replace(
            kept,
            dead_path=number.astype(np.int64),
            dead_paths=tuple(kept.dead_paths[path] for path in paths),
        )
        return replace(self, points=kept, rows=rows if self.rows is None else self.rows[rows])

    def of_points(self, points: Points) -> "Case":
        """Return the case of other distances, with nodes that enclose their commands."""
        commands = points.commands
        nodes = (
            enclosing(self.nodes_rad[0], commands.theta1_rad),
            enclosing(self.nodes_rad[1], commands.theta2_rad),
        )
        return replace(self, points=points, nodes_rad=nodes)


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
    def places_mm(self) -> Floats:
        """Places of the reflectors, shape (reflectors, 2)."""
        return self.parameters[self.layout.reflectors].reshape(-1, 2)

    def strain(self, bounds: Bounds) -> float:
        """Return the largest share of a bound that the arm uses up; above 1 it is beyond one."""
        return max(off.share for off in offsets(self.layout, self.parameters, self.case, bounds))


def enclosing(nodes_rad: Floats, angles_rad: Floats) -> Floats:
    """Return nodes that enclose angles: as they are, mirrored, or as many spread evenly; none remain none."""
    if not nodes_rad.size:
        return nodes_rad
    low, high = float(angles_rad.min()), float(angles_rad.max())
    for nodes in (nodes_rad, -nodes_rad[::-1]):
        if nodes[0] - _EXACT <= low and high <= nodes[-1] + _EXACT:
            return nodes
    return np.linspace(low, high + (0.0 if high > low else _EXACT), max(nodes_rad.size, 2))


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
            np.concatenate([case.weights, 1.0 / _spread(layout, bounds, case.free)]),
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
