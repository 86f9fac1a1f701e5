"""From measured distances to the arm's parameters with their uncertainties."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from catseye.calibration.core.amplitudes import Compressed, variance_ratios
from catseye.calibration.core.arguments import require_finite, require_shape
from catseye.calibration.core.errors import BudgetError, InsufficientPointsError
from catseye.calibration.core.estimation import Estimate, estimate
from catseye.calibration.core.fit_statistics import FitStatistics
from catseye.calibration.core.gain import Gain
from catseye.calibration.core.rank import require_identifiable
from catseye.calibration.core.source_sums import SourceSums
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.budget_effects import effects, shared_rms_mm, stated_sigma_mm
from catseye.calibration.scara.distance_model import DistanceModel, distance_model
from catseye.calibration.scara.extension import Term
from catseye.calibration.scara.layout import Layout, ModelName
from catseye.calibration.scara.planar import require_links
from catseye.calibration.scara.pointing import beam_turn_rad
from catseye.calibration.scara.points import Points, rows_of_long_segments, without_short_segments

_LEAST_OWN = 1e-5
"""Share of the errors in common that an error of its own is at least, for sums of squares to keep both."""

TakenUp = Mapping[Contributor, Floats]
"""What contributors have moved estimates by: a column a source of unit variance, shape (p, m) each."""


@dataclass(frozen=True)
class IdentifiedArm:
    """What is known of an arm, without the reflectors that it was measured with.

    Attributes:
        layout: order of the parameters, no reflectors and no dead paths.
        parameters: estimates, mm and rad, shape (p,).
        covariance: of the estimates in the gauge of the layout, shape (p, p).
        budget: what else makes a position uncertain; None for what the estimates alone do.
        taken_up: what errors that come again have moved the estimates by.
    """

    layout: Layout
    parameters: Floats
    covariance: Floats
    budget: Budget | None = None
    taken_up: TakenUp = field(default_factory=dict)


@dataclass(frozen=True)
class SummedUp:
    """What follows from more distances than are kept.

    Attributes:
        taken_up: what errors that come again have moved the estimates by.
        sources: what the distances say of the sources of the systematic contributors.
        reversed_mountings: the interferometer was mounted both ways round.
    """

    taken_up: TakenUp
    sources: SourceSums
    reversed_mountings: bool


@dataclass(frozen=True)
class Identification:
    """An arm identified from distances.

    Attributes:
        layout: order of the parameters.
        parameters: estimates, mm and rad, shape (p,).
        covariance: of the estimates in the stated gauge, shape (p, p).
        points: the distances that were used.
        residuals_mm: predicted minus measured, shape (n,).
        fit: quality of the fit.
        rejected: sentences about what was left out.
        budget: the contributors that its uncertainties were propagated from; None for the points' own sigma_mm.
        rows: which of all distances that were given the points are, from 0, shape (n,).
        summed: what follows from all distances, where some of them are kept only; None where the points are all.
    """

    layout: Layout
    parameters: Floats
    covariance: Floats
    points: Points
    residuals_mm: Floats
    fit: FitStatistics
    rejected: list[str]
    budget: Budget | None = None
    rows: Ints | None = None
    summed: SummedUp | None = None

    @property
    def arm(self) -> IdentifiedArm:
        """Links and maps with their covariance, without reflectors and dead paths."""
        size = self.layout.arm_size
        return IdentifiedArm(
            self.layout.of_arm(),
            self.parameters[:size],
            self.covariance[:size, :size],
            self.budget,
            {one: moved[:size] for one, moved in self.taken_up.items()},
        )

    @cached_property
    def taken_up(self) -> TakenUp:
        """What errors that come again have moved the estimates by.

        What the estimates have taken up of an error is none where it comes again.
        """
        if self.budget is None:
            return {}
        if self.summed is not None:
            return self.summed.taken_up
        model = self.model
        moved = Gain.at(model, self.parameters).matrix
        geometry = model.geometry(self.parameters)
        return {one: moved @ effects(one, geometry) for one in self.budget.repeating}

    @cached_property
    def sources(self) -> SourceSums:
        """What all distances say of the sources of the systematic contributors."""
        return SourceSums.of(self.model, self.parameters) if self.summed is None else self.summed.sources

    @property
    def reversed_mountings(self) -> bool:
        """Whether the interferometer was mounted both ways round."""
        return self.points.reversed_mountings if self.summed is None else self.summed.reversed_mountings

    @property
    def model(self) -> DistanceModel:
        """The distances as rows of the model."""
        return distance_model(self.layout, self.points, self.budget)

    @property
    def estimate(self) -> Estimate:
        """The estimate without what it is of."""
        return Estimate(self.parameters, self.covariance, self.residuals_mm, self.fit)

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
    budget: Budget | None = None,
    terms: tuple[Term, ...] = (),
) -> Identification:
    """Identify the arm from distances.

    Args:
        model: "conventional" (L1, L2, θ20) or "error-map" (L1, L2, both maps).
        nodes1_rad: nodes of the J1 map, rad, strictly increasing.
        nodes2_rad: nodes of the J2 map, rad, strictly increasing.
        link1_mm: nominal length of link 1, mm.
        link2_mm: nominal length of link 2, mm.
        reflectors_mm: rough places of points.reflector_names, mm, shape (reflectors, 2).
        budget: contributors. What distances have in common widens the uncertainties beyond points.sigma_mm; where
            the points state none, the white contributors give it. None for what the points state alone.

    Raises:
        MapRangeError: a point lies outside the nodes.
        InsufficientPointsError: fewer points than parameters.
        UnidentifiableError: null directions beyond the gauge; the parameters are named.
        BudgetError: it states shared errors only.
        ConvergenceError: the iteration does not settle.
        ArgumentError: the model is unknown, nodes do not increase, a link is not positive, or a rough place
            is missing.
    """
    require_nominal(link1_mm, link2_mm, reflectors_mm, points.reflector_names)
    used, rejected = without_short_segments(points)
    rough = reflectors_mm[[points.reflector_names.index(name) for name in used.reflector_names]]
    empty = np.zeros(0)
    nodes = (nodes1_rad, nodes2_rad) if model == "error-map" else (empty, empty)
    layout = Layout(model, *nodes, used.reflector_names, used.dead_paths, terms)
    if any(term.source == "theta4" for term in terms):
        used = replace(used, theta4_rad=beam_turn_rad(used, (link1_mm, link2_mm), rough))
    _require_points(used, layout)
    distances = distance_model(layout, used, counted_budget(used, budget))
    start = distances.start(link1_mm, link2_mm, rough)
    require_separable(distances, start)
    require_own_errors(distances, start)
    distances, found = _estimated(distances, start)
    return Identification(
        layout,
        found.values,
        found.covariance,
        distances.points,
        found.residuals_mm,
        found.fit,
        rejected,
        distances.budget,
        np.flatnonzero(rows_of_long_segments(points)),
    )


def counted_budget(points: Points, budget: Budget | None) -> Budget | None:
    """Return what counts of a budget: what differs from reading to reading does not where the points state it."""
    return budget if budget is None or points.sigma_mm is None else Budget(budget.systematic)


def require_separable(distances: DistanceModel, nominal: Floats) -> None:
    """Refuse functions of J4 that other parameters take up for the beams as they were aimed.

    At an estimate they differ a little, as the aim missed by a little: that separates nothing of use.

    Args:
        nominal: parameters that the beams were aimed by, shape (p,).

    Raises:
        UnidentifiableError: names the functions.
    """
    if any(term.source == "theta4" for term in distances.layout.terms):
        require_identifiable(distances.parameters, distances.jacobian(nominal))


def require_own_errors(distances: DistanceModel, start: Floats) -> None:
    """Refuse distances whose own errors are nothing beside those that they share: no digits are left for them.

    Raises:
        BudgetError: names the smallest standard uncertainty.
    """
    sigma = distances.points.sigma_mm
    if sigma is None:
        return
    least, shared_mm = float(sigma.min()), shared_rms_mm(distances.shared(start))
    if least < _LEAST_OWN * shared_mm:
        raise BudgetError(
            f"sigma_mm is as small as {least:g} mm, where the budget says that distances share errors of "
            f"{shared_mm:.2g} mm: nothing can be weighed like that. Is it in m? Else leave the column out, or let "
            "it stand for all errors (budget none)"
        )


def _estimated(distances: DistanceModel, start: Floats) -> tuple[DistanceModel, Estimate]:
    """Estimate, with the weights and the spectra that follow from the budget; they come with the distances."""
    budget = distances.budget
    if budget is not None and distances.points.sigma_mm is None:
        distances = _weighted(distances, start, budget)
        # Weights at the estimate do not depend on how rough the places were.
        start = estimate(distances, start).values
        distances = _weighted(distances, start, budget)
    found = estimate(distances, start)
    if budget is not None and distances.layout.model == "error-map":
        # The conventional model's own misfit would pass for radial error motions.
        learnt = with_spectra(budget, distances, found.values)
        if learnt != budget:
            distances = replace(distances, budget=learnt)
            found = estimate(distances, found.values)
    return distances, found


def with_spectra(
    budget: Budget, distances: DistanceModel, values: Floats, *, for_test: bool = False
) -> Budget:
    """Return a budget with what distances say about the harmonics of its axis-angle contributors.

    Args:
        values: an estimate, shape (p,).
        for_test: take the variances that a test needs, not those of an uncertainty.
    """
    shared = distances.shared(values)
    if all(one.part is None for one in shared):
        return budget
    compressed = Compressed.of(distances, values, shared)
    ratios = variance_ratios(compressed, for_test=for_test)
    asked = () if distances.budget is None else distances.budget.systematic
    spectra = {one: tuple(ratios[compressed.contributor == k].tolist()) for k, one in enumerate(asked)}
    return Budget(
        tuple(replace(one, spectrum=spectra.get(one) or one.spectrum) for one in budget.contributors)
    )


def require_nominal(link1_mm: float, link2_mm: float, reflectors_mm: Floats, names: tuple[str, ...]) -> None:
    """Refuse a nominal arm or rough places that nothing can start from."""
    require_links(link1_mm, link2_mm)
    require_shape(reflectors_mm, (len(names), 2), f"reflectors_mm of {', '.join(names)}")
    require_finite(reflectors_mm, "reflectors_mm")


def _weighted(distances: DistanceModel, start: Floats, budget: Budget) -> DistanceModel:
    """Give the points the standard uncertainty that follows from the white contributors."""
    sigma = stated_sigma_mm(budget, distances.geometry(start))
    return replace(distances, points=replace(distances.points, sigma_mm=sigma))


def _require_points(points: Points, layout: Layout) -> None:
    free = layout.gauge.free
    if len(points) <= free:
        raise InsufficientPointsError(
            f"{len(points)} usable distances cannot determine {free} parameters of the {layout.model} model: "
            "measure more points, use fewer nodes or choose the conventional model"
        )
