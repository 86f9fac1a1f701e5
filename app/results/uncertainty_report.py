"""Section about where the uncertainties come from: the budget, contributions, correlations, intervals."""

from catseye.app.cell.model import Cell
from catseye.app.cell.uncertainty import ContributorEntry
from catseye.app.files.result_json import Result
from catseye.app.files.uncertainty_part import (
    ContributionTable,
    CoverageInterval,
    MonteCarloPart,
    UncertaintyPart,
)
from catseye.app.render.markup import Html, join, paragraphs, section, table
from catseye.app.results.numbers import NOTHING, fixd, signd

_LEAST_SHARE = 0.0005
"""Shares below this round to nothing."""

_DECIMALS = {"mm": 4, "mdeg": 2, "um": 2}
_UNITS = {"mm": "mm", "mdeg": "mdeg", "um": "µm"}


def uncertainty_section(result: Result | None, cell: Cell | None) -> Html:
    """Return the budget and what becomes of it in the results.

    Args:
        result: the result that the page is about; None leaves its parts out.
        cell: the configuration with the budget; None where only a result file is known.
    """
    part = None if result is None else result.uncertainty
    if part is None and cell is None:
        return Html()
    blocks = [] if cell is None else [_budget(cell.uncertainty.contributor)]
    if part is not None:
        blocks += [paragraphs(_method(part)), _contributions(part.contributions), _correlations(part)]
        blocks += [_validation(part.monte_carlo), _intervals(part)]
    return section("uncertainty", "Uncertainty", *blocks)


def _budget(entries: list[ContributorEntry]) -> Html:
    rows = [
        [
            one.name,
            one.kind,
            one.stated,
            one.distribution,
            one.correlation,
            (one.axis or "").upper() or NOTHING,
        ]
        for one in entries
    ]
    head = ["contributor", "kind", "value", "distribution", "shared by", "axis"]
    caption = (
        "Error budget of the cell file. A normal contributor is stated by its standard uncertainty, the others by "
        "their half width; what is shared by several distances does not average out."
    )
    return table(caption, head, rows, text_columns=6)


def _method(part: UncertaintyPart) -> str:
    coverage = f"intervals of {100.0 * part.coverage:g} % coverage"
    if part.monte_carlo is None:
        return f"Propagated by the Jacobian (law of propagation of uncertainty); {coverage} from the t-distribution."
    return (
        f"Propagated by {part.monte_carlo.draws} Monte Carlo draws (seed {part.monte_carlo.seed}), every draw "
        f"identified anew; shortest {coverage}."
    )


def _contributions(found: ContributionTable) -> Html:
    head = ["result", "u", *found.contributors]
    rows = [
        [f"{row.result} / {_UNITS[row.unit]}", fixd(row.u, 2), *(_share(share) for share in row.shares)]
        for row in found.rows
    ]
    return table("Share of each contributor in the variance of each result, %.", head, rows)


def _share(share: float) -> str:
    return NOTHING if share < _LEAST_SHARE else fixd(100.0 * share, 1)


def _correlations(part: UncertaintyPart) -> Html:
    rows = [[" and ".join(pair.parameters), signd(pair.coefficient, 3)] for pair in part.correlations]
    return table("Strongest correlations of the arm's parameters.", ["parameters", "coefficient"], rows)


def _validation(part: MonteCarloPart | None) -> Html:
    if part is None:
        return Html()
    rows = [
        [
            f"{row.parameter} / {_UNITS[row.unit]}",
            fixd(row.difference, 3),
            fixd(row.delta, 3),
            row.verdict,
        ]
        for row in part.validation
        if row.verdict != "validated"
    ]
    confirmed = len(part.validation) - len(rows)
    told = (
        f"The draws confirm the Jacobian's intervals of {confirmed} of {len(part.validation)} parameters (JCGM 101: "
        "no end differs by more than δ, half a unit of the one significant digit of u)."
    )
    if not rows:
        return paragraphs(told)
    head = ["parameter", "largest difference", "δ", "verdict"]
    return join([paragraphs(told), table("Intervals that are not confirmed.", head, rows)])


def _intervals(part: UncertaintyPart) -> Html:
    caption = f"Coverage intervals, {100.0 * part.coverage:g} %."
    rows = [_interval(one) for one in part.intervals]
    return table(caption, ["parameter", "value", "u", "from", "to", "degrees of freedom"], rows)


def _interval(one: CoverageInterval) -> list[str]:
    decimals = _DECIMALS[one.unit]
    values = (one.value, one.u, one.low, one.high)
    dof = "∞" if one.degrees_of_freedom is None else fixd(one.degrees_of_freedom, 0)
    return [f"{one.parameter} / {_UNITS[one.unit]}", *(fixd(value, decimals) for value in values), dof]
