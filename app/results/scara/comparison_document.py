"""A comparison of two results as JSON."""

from pathlib import Path

from catseye.app.results.document import Document, Stated
from catseye.app.results.scara.changes import beyond
from catseye.app.results.scara.comparison import MapDifference, ResultComparison
from catseye.app.results.scara.comparison_report import comparison_statement


class DifferencePart(Document):
    """A value of both results.

    Attributes:
        u: combined standard uncertainty of the difference.
        normalised: the difference in units of it.
    """

    name: str
    unit: str
    first: float
    second: float
    difference: float
    u: float
    normalised: float | None


class DirectionPart(Document):
    """The maps of both results from one direction of approach, a value a node."""

    first_mdeg: list[float]
    second_mdeg: list[float]
    difference_mdeg: list[float]
    u_mdeg: list[float]
    normalised: list[Stated]


class MapDifferencePart(Document):
    """The maps of a joint."""

    joint: int
    node_deg: list[float]
    positive: DirectionPart
    negative: DirectionPart


class ChangePart(Document):
    """A change of one link or node alone that the difference would come from.

    Attributes:
        name: of what changes; ± is a node from both sides.
        u: standard uncertainty of the change.
        normalised: the change in units of it.
    """

    name: str
    unit: str
    value: float
    u: float
    normalised: float


class ComparisonDocument(Document):
    """Everything that a comparison of two result files found.

    Attributes:
        changes: of links and nodes, one at a time; what a limit judges.
        limit_u: largest change that is no alarm, in standard uncertainties; None where no limit is given.
        beyond: changes beyond the limit, the largest first.
    """

    first: str
    second: str
    values: list[DifferencePart]
    maps: list[MapDifferencePart]
    reflectors: list[DifferencePart]
    changes: list[ChangePart]
    limit_u: float | None
    beyond: list[ChangePart]
    turn_mdeg: float
    within_2u: int
    compared: int
    remarks: list[str]
    verdict: str


def comparison_document(
    comparison: ResultComparison, first: Path, second: Path, limit_u: float | None = None
) -> ComparisonDocument:
    """Return a comparison as plain values; what is not stated is null.

    Args:
        limit_u: largest change that is no alarm, in standard uncertainties.
    """
    within, count = comparison.within
    return ComparisonDocument(
        first=str(first),
        second=str(second),
        values=[DifferencePart.model_validate(value) for value in comparison.values],
        maps=[_map(joint_map) for joint_map in comparison.maps],
        reflectors=[DifferencePart.model_validate(reflector) for reflector in comparison.reflectors],
        changes=[ChangePart.model_validate(change) for change in comparison.changes],
        limit_u=limit_u,
        beyond=[ChangePart.model_validate(change) for change in beyond(comparison.changes, limit_u)],
        turn_mdeg=comparison.turn_mdeg,
        within_2u=within,
        compared=count,
        remarks=list(comparison.remarks),
        verdict=comparison_statement(comparison).text,
    )


def _map(difference: MapDifference) -> MapDifferencePart:
    positive, negative = (
        DirectionPart(
            first_mdeg=difference.first_mdeg[row].tolist(),
            second_mdeg=difference.second_mdeg[row].tolist(),
            difference_mdeg=difference.difference_mdeg[row].tolist(),
            u_mdeg=difference.u_mdeg[row].tolist(),
            normalised=difference.normalised[row].tolist(),
        )
        for row in (0, 1)
    )
    return MapDifferencePart(
        joint=difference.joint, node_deg=difference.node_deg.tolist(), positive=positive, negative=negative
    )
