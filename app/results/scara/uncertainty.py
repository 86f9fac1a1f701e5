"""Uncertainties of an identification for its result: intervals, contributions, correlations, validation."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from catseye.app.cluster.share import Share, map_quick
from catseye.app.errors import UsageError
from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import EXPANDED, MDEG_PER_RAD
from catseye.app.results.scara.result import term_unit
from catseye.app.results.uncertainty_part import (
    ContributionRow,
    ContributionTable,
    ContributionUnit,
    CorrelationPair,
    CoverageInterval,
    Method,
    MonteCarloPart,
    ParameterUnit,
    UncertaintyPart,
    ValidationRow,
)
from catseye.calibration.core.contributions import Contributions
from catseye.calibration.core.coverage import (
    Interval,
    correlation,
    coverage_factor,
    fewest_draws,
    shortest_interval,
    validate,
)
from catseye.calibration.core.draws import CHUNK, joined, solve_chunk
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.uncertainty import chunks, contributions, with_draws

COVERAGE = 0.95
"""Probability that an interval of the result holds its parameter."""

_PAIRS = 10
"""Strongest correlations that are named."""

_UM = 1e3

_Scale = tuple[ParameterUnit, float]
_Share = tuple[str, Floats, ContributionUnit, float]


@dataclass(frozen=True)
class Propagated:
    """An identification with what is to be said about its uncertainties."""

    identified: Identification
    part: UncertaintyPart


def by_jacobian(identified: Identification, found: Contributions | None = None) -> Propagated:
    """Return the uncertainties that the law of propagation gives; intervals from the t-distribution.

    Args:
        found: contributions to its covariance; None for those of least squares.
    """
    found = contributions(identified) if found is None else found
    return Propagated(identified, _part("jacobian", identified, found, _calculated(identified, found)))


def by_monte_carlo(
    identified: Identification,
    draws: int,
    seed: int,
    share: Share,
    done: Callable[[int], None] | None = None,
) -> Propagated:
    """Return the uncertainties that draws give; shortest intervals, and the Jacobian's ones tested by them.

    Args:
        done: is called with the number of finished draws, each time it grows.

    Raises:
        UsageError: too few draws for intervals.
        CalibrationError: a distribution has no standard deviation, or nothing is uncertain.
    """
    require_draws(draws)
    work = chunks(identified, draws, seed)
    advanced = None if done is None else (lambda count: done(min(draws, count * CHUNK)))
    solved = joined(map_quick(share, solve_chunk, work, advanced))
    found = contributions(identified)
    shortest = [shortest_interval(column, COVERAGE) for column in solved.parameters.T]
    drawn = with_draws(identified, solved.parameters)
    part = _part("monte-carlo", drawn, found, shortest)
    carried = MonteCarloPart(
        draws=draws,
        seed=seed,
        damped_solutions=solved.fallbacks,
        validation=_validation(identified, _calculated(identified, found), solved.parameters),
    )
    return Propagated(drawn, part.model_copy(update={"monte_carlo": carried}))


def require_draws(draws: int) -> None:
    """Refuse draws that cannot carry an interval.

    Raises:
        UsageError: too few; names how many are needed.
    """
    fewest = fewest_draws(COVERAGE)
    if draws < fewest:
        raise UsageError(
            f"{draws} draws are too few: an interval of {100.0 * COVERAGE:.0f} % coverage stands on the draws beyond "
            f"its limits, and JCGM 101 asks for 100/(1 − p) = {fewest} draws at least; 10000 take some seconds: "
            "--draws 10000"
        )


def uncertainty_statements(part: UncertaintyPart) -> list[Statement]:
    """Return whether the draws confirm the uncertainties of a result, and what the links' come from."""
    texts = []
    if part.monte_carlo is not None:
        texts.append(_validated(part.monte_carlo))
        if part.monte_carlo.damped_solutions:
            texts.append(
                f"{part.monte_carlo.damped_solutions} of {part.monte_carlo.draws} draws were so far off that the "
                "damped solver had to solve them"
            )
    links = [row for row in part.contributions.rows if row.result in {"L1", "L2"}]
    texts += [
        f"{row.result}: U = {EXPANDED * row.u:.2f} µm (k = 2), most of it from "
        f"{_largest(row, part.contributions.contributors)}"
        for row in links
    ]
    return [Statement(Sign.NEUTRAL, f"{text}.") for text in texts]


def _validated(part: MonteCarloPart) -> str:
    count = {
        kind: sum(row.verdict == kind for row in part.validation)
        for kind in ("validated", "not validated", "too few draws")
    }
    text = (
        f"Monte Carlo, {part.draws} draws: the Jacobian's 95 % intervals are confirmed for "
        f"{count['validated']} of {len(part.validation)} parameters (JCGM 101, one significant digit of u)"
    )
    if count["not validated"]:
        refuted = [row.parameter for row in part.validation if row.verdict == "not validated"]
        text += f"; refuted for {', '.join(refuted[:8])}{' …' if len(refuted) > 8 else ''}: use those of the draws"
    if count["too few draws"]:
        text += f"; {count['too few draws']} stay open with so few draws"
    return text


def _largest(row: ContributionRow, names: Sequence[str]) -> str:
    order = np.argsort(row.shares)[::-1][:2]
    return ", ".join(f"{names[i]} ({100.0 * row.shares[i]:.0f} % of the variance)" for i in order)


def _part(
    method: Method, identified: Identification, contributions: Contributions, intervals: Sequence[Interval]
) -> UncertaintyPart:
    layout, scales = identified.layout, _scales(identified.layout)
    dof = contributions.effective_dof(contributions.variances)
    rows = zip(
        layout.names(),
        scales,
        identified.parameters,
        identified.standard_uncertainty,
        intervals,
        dof,
        strict=True,
    )
    return UncertaintyPart(
        method=method,
        coverage=COVERAGE,
        intervals=[
            CoverageInterval(
                parameter=name,
                unit=unit,
                value=factor * value,
                u=factor * u,
                low=factor * limits.low,
                high=factor * limits.high,
                degrees_of_freedom=one_dof if math.isfinite(one_dof) else None,
            )
            for name, (unit, factor), value, u, limits, one_dof in rows
        ],
        contributions=contribution_table(identified, contributions),
        correlations=_strongest(identified),
    )


def _scales(layout: Layout) -> list[_Scale]:
    """Return unit and factor of each parameter."""
    angles = layout.extension.start - 2
    mm: _Scale = ("mm", 1.0)
    mdeg: _Scale = ("mdeg", MDEG_PER_RAD)
    terms: list[_Scale] = [("mdeg" if term.angular else "um", term_unit(term)) for term in layout.terms]
    rest = layout.size - layout.arm_size
    return [mm] * 2 + [mdeg] * angles + terms + [mm] * rest


def _calculated(identified: Identification, contributions: Contributions) -> list[Interval]:
    """Return the intervals of the law of propagation."""
    dof = contributions.effective_dof(contributions.variances)
    expanded = coverage_factor(COVERAGE, dof) * identified.standard_uncertainty
    return [
        Interval(float(value - half), float(value + half))
        for value, half in zip(identified.parameters, expanded, strict=True)
    ]


def _validation(
    identified: Identification, calculated: Sequence[Interval], drawn: Floats
) -> list[ValidationRow]:
    rows = []
    for name, (unit, factor), interval, column in zip(
        identified.layout.names(), _scales(identified.layout), calculated, drawn.T, strict=True
    ):
        # Significant digits are those of the unit that the parameter is stated in.
        scaled = Interval(factor * interval.low, factor * interval.high)
        values = factor * column
        one = validate(scaled, values, COVERAGE, float(np.std(values, ddof=1)))
        rows.append(
            ValidationRow(
                parameter=name,
                unit=unit,
                difference=one.difference,
                delta=one.tolerance,
                sampling=one.sampling,
                verdict=one.verdict,
            )
        )
    return rows


def contribution_table(identified: Identification, contributions: Contributions) -> ContributionTable:
    """Return how much each contributor makes of links, offset, maps and the worst reflector."""
    rows = [_row(*result) for result in _results(identified.layout, contributions.variances)]
    return ContributionTable(contributors=list(contributions.names), rows=rows)


def _results(layout: Layout, variances: Floats) -> list[_Share]:
    """Return name, variances by contributor, unit and factor of each result."""
    names, totals = layout.names(), variances.sum(axis=0)
    found: list[_Share] = [("L1", variances[:, 0], "um", _UM), ("L2", variances[:, 1], "um", _UM)]
    if layout.model == "conventional":
        found.append(("θ20", variances[:, 2], "mdeg", MDEG_PER_RAD))
    else:
        for title, part in (("map of J1", layout.map1), ("map of J2", layout.map2)):
            worst = part.start + int(np.argmax(totals[part]))
            found.append((f"{title}, worst: {names[worst]}", variances[:, worst], "mdeg", MDEG_PER_RAD))
            found.append((f"{title}, rms of nodes", variances[:, part].mean(axis=1), "mdeg", MDEG_PER_RAD))
    places = variances[:, layout.reflectors].reshape(len(variances), -1, 2).sum(axis=2)
    if places.size:
        worst = int(np.argmax(places.sum(axis=0)))
        found.append((f"reflector {layout.reflector_names[worst]} (worst)", places[:, worst], "um", _UM))
    return found


def _row(name: str, variances: Floats, unit: ContributionUnit, factor: float) -> ContributionRow:
    total = float(variances.sum())
    return ContributionRow(
        result=name,
        unit=unit,
        u=factor * math.sqrt(total),
        u_parts=(factor * np.sqrt(variances)).tolist(),
        shares=(variances / total if total > 0.0 else np.zeros(variances.size)).tolist(),
    )


def _strongest(identified: Identification) -> list[CorrelationPair]:
    arm, names = identified.arm, identified.layout.names()
    matrix = np.triu(correlation(arm.covariance), 1)
    order = np.argsort(np.abs(matrix), axis=None)[::-1][:_PAIRS]
    pairs = [(int(i), int(j)) for i, j in zip(*np.unravel_index(order, matrix.shape), strict=True)]
    return [
        CorrelationPair(parameters=(names[i], names[j]), coefficient=float(matrix[i, j]))
        for i, j in pairs
        if matrix[i, j] != 0.0
    ]
