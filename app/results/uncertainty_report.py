"""Where the uncertainties come from: the budget, contributions, correlations, intervals."""

from collections.abc import Sequence

from catseye.app.cell.scara.uncertainty import ContributorEntry
from catseye.app.results.model import (
    Block,
    Cell,
    Column,
    Paragraph,
    Quantity,
    Section,
    Statement,
    Table,
    section,
)
from catseye.app.results.numbers import COUNT, NOTHING, OF_UNIT, fixed, number
from catseye.app.results.uncertainty_part import (
    ContributionTable,
    CoverageInterval,
    MonteCarloPart,
    UncertaintyPart,
)

_LEAST_SHARE = 0.0005
"""Shares below this round to nothing."""

_UNITS = {"mm": "mm", "mdeg": "mdeg", "um": "µm"}


def uncertainty_section(
    part: UncertaintyPart | None, budget: Sequence[ContributorEntry], whose: Sequence[Statement] = ()
) -> Section:
    """Return the budget and what becomes of it in the results.

    Args:
        part: of the result; None leaves it out.
        budget: that the result stands on; empty where it does not say.
        whose: budget it is, and what it leaves open.
    """
    blocks: list[Block | None] = [*whose, _budget(budget) if budget else None]
    if part is not None:
        blocks += [Paragraph(_method(part)), _contributions(part.contributions), _correlations(part)]
        blocks += [*_validation(part.monte_carlo), _intervals(part)]
    return section("uncertainty", "Uncertainty", blocks)


def _budget(entries: Sequence[ContributorEntry]) -> Table:
    return Table(
        "budget",
        "Error budget. A normal contributor is stated by its standard uncertainty, the others by "
        "their half width; what is shared by several distances does not average out.",
        (
            Column("name", "contributor"),
            Column("kind", "kind"),
            Column("value", "value"),
            Column("distribution", "distribution"),
            Column("correlation", "shared by"),
            Column("axis", "axis"),
            Column("measured_by", "measured by"),
        ),
        tuple(
            (
                entry.name,
                entry.kind,
                entry.stated,
                entry.distribution,
                entry.correlation,
                (entry.axis or "").upper() or NOTHING,
                entry.measured_by or NOTHING,
            )
            for entry in entries
        ),
    )


def _method(part: UncertaintyPart) -> str:
    coverage = f"intervals of {100.0 * part.coverage:g} % coverage"
    if part.monte_carlo is None:
        return f"Propagated by the Jacobian (law of propagation of uncertainty); {coverage} from the t-distribution."
    return (
        f"Propagated by {part.monte_carlo.draws} Monte Carlo draws (seed {part.monte_carlo.seed}), every draw "
        f"identified again; shortest {coverage}."
    )


def _contributions(contributions: ContributionTable) -> Table:
    results = contributions.rows
    expanded: tuple[Cell, ...] = ("U", *(Quantity(result.u, fixed(2), standard=True) for result in results))
    shares: list[tuple[Cell, ...]] = [
        (name, *(_share(result.shares[place]) for result in results))
        for place, name in enumerate(contributions.contributors)
    ]
    return Table(
        "contributions",
        "Expanded uncertainty U of each result (k = 2), and below it the share of each contributor in U², %.",
        (
            Column("contributor", "contributor"),
            *(
                Column(result.result, f"{result.result} / {_UNITS[result.unit]}", format=fixed(1))
                for result in results
            ),
        ),
        (expanded, *shares),
    )


def _share(share: float) -> float | None:
    return None if share < _LEAST_SHARE else 100.0 * share


def _correlations(part: UncertaintyPart) -> Table:
    return Table(
        "correlations",
        "Strongest correlations of the arm's parameters.",
        (
            Column("parameters", "parameters"),
            Column("coefficient", "coefficient", format=fixed(3, signed=True)),
        ),
        tuple((" and ".join(pair.parameters), pair.coefficient) for pair in part.correlations),
    )


def _validation(part: MonteCarloPart | None) -> list[Block]:
    if part is None:
        return []
    open_rows = [row for row in part.validation if row.verdict != "validated"]
    confirmed = len(part.validation) - len(open_rows)
    text = (
        f"The draws confirm the Jacobian's intervals of {confirmed} of {len(part.validation)} parameters (JCGM 101: "
        "no end differs by more than δ, half a unit of the one significant digit of u)."
    )
    if not open_rows:
        return [Paragraph(text)]
    table = Table(
        "unconfirmed",
        "Intervals that are not confirmed.",
        (
            Column("parameter", "parameter"),
            Column("difference", "largest difference", format=fixed(3)),
            Column("delta", "δ", format=fixed(3)),
            Column("verdict", "verdict"),
        ),
        tuple(
            (f"{row.parameter} / {_UNITS[row.unit]}", row.difference, row.delta, row.verdict)
            for row in open_rows
        ),
    )
    return [Paragraph(text), table]


def _intervals(part: UncertaintyPart) -> Table:
    values = fixed(4)
    finite = any(interval.degrees_of_freedom is not None for interval in part.intervals)
    degrees = (Column("degrees_of_freedom", "degrees of freedom", format=COUNT),) if finite else ()
    return Table(
        "intervals",
        f"Coverage intervals, {100.0 * part.coverage:g} %.",
        (
            Column("parameter", "parameter"),
            Column("value", "value", format=values),
            Column("u", "U (k=2)", format=values, standard=True),
            Column("low", "from", format=values),
            Column("high", "to", format=values),
            *degrees,
        ),
        tuple(_interval(interval)[: 5 + len(degrees)] for interval in part.intervals),
    )


def _interval(interval: CoverageInterval) -> tuple[Cell, ...]:
    unit = _UNITS[interval.unit]
    values = (
        Quantity(value, OF_UNIT[unit]) for value in (interval.value, interval.u, interval.low, interval.high)
    )
    dof = "∞" if interval.degrees_of_freedom is None else number(interval.degrees_of_freedom, COUNT)
    return (f"{interval.parameter} / {unit}", *values, dof)
