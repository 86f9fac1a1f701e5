"""From millions of distances to an arm, with constant memory: normal equations summed up in passes over blocks."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from catseye.calibration.core.blockwise.descent import Minimum, descend, improved
from catseye.calibration.core.blockwise.normal_sums import NormalSums, source_sums, white_covariance, widened
from catseye.calibration.core.blockwise.residual_sums import ResidualSums
from catseye.calibration.core.errors import CalibrationError, InsufficientPointsError
from catseye.calibration.core.fit_statistics import FitSums, summed_statistics
from catseye.calibration.core.source_sums import owners
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.budget import Budget
from catseye.calibration.scara.error_map import interpolate
from catseye.calibration.scara.errors import MapRangeError
from catseye.calibration.scara.extension import Term
from catseye.calibration.scara.identification import (
    Identification,
    SummedUp,
    TakenUp,
    counted_budget,
    require_nominal,
    require_own_errors,
    require_separable,
    with_spectra,
)
from catseye.calibration.scara.layout import UNSETTLED, Layout, ModelName
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.scans.passes import Passes
from catseye.calibration.scara.scans.source import PointSource
from catseye.calibration.scara.scans.used_rows import FewRows, UsedRows, used_rows

_MOST_PARAMETERS = 4_000
"""The normal matrix holds the square of their number: more need gigabytes and minutes."""

_EXPECTED_PASSES = 2
"""Starting values from few rows are so good that the second pass confirms the first as a rule."""

_SAMPLE = 4000
"""So many residuals are kept one by one."""

_HISTOGRAM_RMS = 5.0
"""The histogram of the residuals covers so many times their rms to either side."""

_FINEST_MM = 1e-9
"""Half the width of the histogram of an exact fit."""


@dataclass(frozen=True)
class ScanIdentification:
    """An arm identified from a scan.

    Attributes:
        identified: the arm with its fit to all distances; its points and residuals are an even sample of them.
        residuals: of all distances, summed up.
    """

    identified: Identification
    residuals: ResidualSums


def identify_scan(
    source: PointSource,
    model: ModelName,
    nodes1_rad: Floats,
    nodes2_rad: Floats,
    link1_mm: float,
    link2_mm: float,
    reflectors_mm: Floats,
    budget: Budget | None = None,
    terms: tuple[Term, ...] = (),
    progress: Callable[[int, int], None] | None = None,
) -> ScanIdentification:
    """Identify the arm from a source that need not fit into memory.

    Solves the same problem as `identification.identify`, by Gauss-Newton steps whose normal equations are summed up
    block by block; the gradient is that of all rows, so squaring costs no digits of the estimate. Rank and covariance
    come from the normal matrix (`catseye.calibration.core.blockwise.normal_sums`). Repeats of poses are not looked
    for: there is no test of the lack of fit.

    Args:
        model: "conventional" (L1, L2, θ20) or "error-map" (L1, L2, both maps).
        nodes1_rad: nodes of the J1 map, rad, strictly increasing.
        nodes2_rad: nodes of the J2 map, rad, strictly increasing.
        link1_mm: nominal length of link 1, mm.
        link2_mm: nominal length of link 2, mm.
        reflectors_mm: rough places of source.reflector_names, mm, shape (reflectors, 2).
        budget: contributors, as identify takes them; none may be common to a pose.
        progress: called with the rows done and the rows expected, all passes together.

    Raises:
        MapRangeError: a point lies outside the nodes.
        InsufficientPointsError: fewer points than parameters.
        UnidentifiableError: null directions beyond the gauge, or directions too weak to be distinguished from them.
        ConvergenceError: the iteration does not settle.
        CalibrationError: a contributor is common to a pose, or there are too many parameters for a normal matrix.
        ArgumentError: as identify.
    """
    require_nominal(link1_mm, link2_mm, reflectors_mm, source.reflector_names)
    empty = np.zeros(0)
    nodes = (nodes1_rad, nodes2_rad) if model == "error-map" else (empty, empty)
    arm = Layout(model, *nodes, (), (), terms)
    used = used_rows(source, lambda block, first: _require_range(nodes, block, first))
    rough = reflectors_mm[used.kept_reflectors]
    layout = replace(arm, reflector_names=used.reflector_names, dead_paths=used.dead_paths)
    _require_size(layout)
    _require_rows(used.rows, layout.gauge.free, model)
    few = used.few(arm)
    counted = counted_budget(few.points, budget)
    passes = Passes(used, layout, (link1_mm, link2_mm), rough, counted, few.places)
    start = passes.start(few.points)
    require_separable(passes.model(few.points, weighted=False), start)
    some = passes.model(few.points.rows(few.even), weighted=False)
    require_own_errors(some, start)
    passes, first = _settled(passes, few.points, start)
    counter = _Counter(used.rows, progress)
    over_all = _OverAll(used, counter, max(_HISTOGRAM_RMS * first.sums.residuals.rms_mm, _FINEST_MM))
    passes, start = _near_all(passes, few, first.parameters, over_all)
    minimum = descend(partial(over_all.sums, passes), start, layout.gauge, UNSETTLED)
    counter.finish()
    return _judged(passes, minimum, few, counter.passes)


@dataclass(frozen=True)
class _OverAll:
    """Sums over all rows."""

    used: UsedRows
    counter: "_Counter"
    half_width_mm: float

    def sums(self, passes: Passes, parameters: Floats) -> NormalSums:
        return passes.sums(parameters, self.counter.counted(self.used.blocks()), self.half_width_mm)


def _near_all(passes: Passes, few: FewRows, some: Floats, over_all: _OverAll) -> tuple[Passes, Floats]:
    """Return passes whose contributors are those of all rows, as identify finds them, and a start.

    Weights, shared errors and what the budget learns are taken where all rows put the arm, not some of them.

    Args:
        some: estimate from some of the rows, shape (p,).
    """
    budget = passes.budget
    if budget is None:
        return passes, some

    def improve(passes: Passes, start: Floats) -> Floats:
        if len(few.points) == over_all.used.rows:
            return start
        return improved(start, over_all.sums(passes, start), passes.layout.gauge)

    start = improve(passes, some)
    passes = replace(passes, estimate=start)
    if passes.layout.model == "error-map":
        asked = passes.model(few.points.rows(few.even))
        passes = replace(passes, budget=with_spectra(budget, asked, start))
        # What the budget learns moves both estimates alike.
        start = start + _settled(passes, few.points, some)[1].parameters - some
        passes = replace(passes, estimate=start)
    start = improve(passes, start)
    return replace(passes, estimate=start), start


@dataclass
class _Counter:
    """Counts rows of all passes for who waits."""

    rows: int
    progress: Callable[[int, int], None] | None
    done: int = 0

    @property
    def passes(self) -> int:
        """Those that are done."""
        return self.done // self.rows

    def counted(self, blocks: Iterable[Points]) -> Iterator[Points]:
        """Hand the blocks of a pass on; each is counted when the next is asked for."""
        expected = max(_EXPECTED_PASSES * self.rows, self.done + self.rows)
        for block in blocks:
            yield block
            self.done += len(block)
            self._report(expected)

    def finish(self) -> None:
        """Report that no further pass is needed, where there were fewer than expected."""
        if self.done < _EXPECTED_PASSES * self.rows:
            self._report(self.done)

    def _report(self, expected: int) -> None:
        if self.progress is not None:
            self.progress(self.done, expected)


def _minimum_of_sample(passes: Passes, few: Points, start: Floats) -> Minimum:
    """Return the solution of an even sample: where the descent over all rows starts."""
    return descend(
        lambda parameters: passes.sums(parameters, [few], 1.0), start, passes.layout.gauge, UNSETTLED
    )


def _settled(passes: Passes, few: Points, start: Floats) -> tuple[Passes, Minimum]:
    """Return passes that take the contributors at the minimum of a sample, and that minimum."""
    first = _minimum_of_sample(passes, few, start)
    for _ in range(0 if passes.budget is None else 2):
        passes = replace(passes, estimate=first.parameters)
        first = _minimum_of_sample(passes, few, first.parameters)
    return passes, first


def _judged(passes: Passes, minimum: Minimum, few: FewRows, iterations: int) -> ScanIdentification:
    """Attach covariance, statistics and a sample of the residuals to a minimum."""
    sums, layout = minimum.sums, passes.layout
    white = white_covariance(sums, layout.parameters(), layout.gauge)
    covariance = widened(white, sums)
    rows = np.arange(0, len(few.points), -(-len(few.points) // _SAMPLE))
    sample = passes.model(few.points.rows(rows))
    owner = owners(sample.shared(passes.known))
    fit = summed_statistics(
        FitSums(
            n_points=sums.residuals.rows,
            free=layout.gauge.free,
            square=sums.cost,
            square_mm2=float(sums.residuals.square_mm2.sum()),
            weight=sums.weight,
            stated=sample.points.sigma_mm is not None,
            iterations=iterations,
        ),
        None,
    )
    identified = Identification(
        layout,
        minimum.parameters,
        fit.unit_weight_variance * covariance,
        sample.points,
        sample.residuals(minimum.parameters),
        fit,
        passes.used.rejected,
        passes.budget,
        few.numbers[rows],
        SummedUp(
            _taken_up(passes, sums.taken_up(covariance), owner),
            source_sums(sums, white, layout.gauge.free, owner),
            # A segment has one mounting, and the few rows have some of each.
            few.points.reversed_mountings,
        ),
    )
    return ScanIdentification(identified, sums.residuals)


def _taken_up(passes: Passes, moved: Floats, owner: Ints) -> TakenUp:
    """Tell the contributors apart in what all sources have moved the estimate by, shape (p, m)."""
    budget = passes.budget or Budget(())
    repeating = budget.repeating
    return {one: moved[:, owner == k] for k, one in enumerate(budget.systematic) if one in repeating}


def _require_range(nodes_rad: tuple[Floats, Floats], block: Points, first: int) -> None:
    angles = (block.commands.theta1_rad, block.commands.theta2_rad)
    for nodes, angle, name in zip(nodes_rad, angles, ("θ1", "θ2"), strict=True):
        if not nodes.size:
            continue
        try:
            interpolate(nodes, angle[[angle.argmin(), angle.argmax()]], name=name)
        except MapRangeError:
            outside = int(np.flatnonzero((angle < nodes[0]) | (angle > nodes[-1]))[0])
            raise MapRangeError(
                f"{name} {np.rad2deg(angle[outside]):.4f}° of distance {first + outside} is outside the nodes "
                f"{np.rad2deg(nodes[0]):g}°…{np.rad2deg(nodes[-1]):g}°; a map is never extrapolated: add nodes that "
                "enclose it or leave the point out"
            ) from None


def _require_size(layout: Layout) -> None:
    if layout.size > _MOST_PARAMETERS:
        raise CalibrationError(
            f"{layout.size} parameters, {len(layout.dead_paths)} of them dead paths, are more than the "
            f"{_MOST_PARAMETERS} that a scan is solved for: a segment lasts as long as the beam is unbroken, so give "
            "all its rows one number; otherwise use fewer nodes, or solve parts of the scan"
        )


def _require_rows(rows: int, free: int, model: ModelName) -> None:
    if rows <= free:
        raise InsufficientPointsError(
            f"{rows} usable distances cannot determine {free} parameters of the {model} model: measure more points, "
            "use fewer nodes or choose the conventional model"
        )
