"""A trend as `catseye trend --json` writes it."""

from datetime import datetime
from pathlib import Path

from catseye.app.results.document import Document
from catseye.app.results.trend.course import Trend, Value
from catseye.app.results.trend.report import trend_statement


class ResultEntry(Document):
    """A result.

    Attributes:
        within_2u: how many changes against the baseline lie within two standard uncertainties, of `compared`.
        largest: the largest change in standard uncertainties of the difference; null in the baseline.
        largest_of: the quantity that it is of.
    """

    file: Path
    measured_utc: datetime
    runs: tuple[str, ...]
    within_2u: int
    compared: int
    largest: float | None
    largest_of: str


class ValueEntry(Document):
    """A value in one result.

    Attributes:
        u: standard uncertainty.
        change: against the baseline; null in the baseline itself.
        u_change: standard uncertainty of that: errors of the arm that come again in both are none of it.
        normalised: the change in units of it.
    """

    value: float
    u: float
    change: float | None
    u_change: float | None
    normalised: float | None


class CourseEntry(Document):
    """A quantity over all results; null where a result does not have it."""

    name: str
    unit: str
    judged: bool
    values: tuple[ValueEntry | None, ...]


class TrendDocument(Document):
    """Everything that the results of one arm say over time, oldest first."""

    arm: str
    baseline: Path
    results: tuple[ResultEntry, ...]
    courses: tuple[CourseEntry, ...]
    remarks: tuple[str, ...]
    verdict: str


def trend_document(trend: Trend) -> TrendDocument:
    """Return a trend as plain values."""
    return TrendDocument(
        arm=trend.arm,
        baseline=trend.results[trend.baseline].path,
        results=tuple(_result(trend, number) for number in range(len(trend.results))),
        courses=tuple(
            CourseEntry(
                name=one.name, unit=one.unit, judged=one.judged, values=tuple(map(_value, one.values))
            )
            for one in trend.courses
        ),
        remarks=trend.remarks,
        verdict=trend_statement(trend).text,
    )


def _result(trend: Trend, number: int) -> ResultEntry:
    result, largest = trend.results[number], trend.largest(number)
    return ResultEntry(
        file=result.path,
        measured_utc=result.measured,
        runs=result.runs,
        within_2u=trend.within(number),
        compared=len(trend.changes(number)),
        largest=None if largest is None else largest[1],
        largest_of="" if largest is None else largest[0],
    )


def _value(value: Value | None) -> ValueEntry | None:
    if value is None:
        return None
    change = value.change
    return ValueEntry(
        value=value.value,
        u=value.u,
        change=None if change is None else change.difference,
        u_change=None if change is None else change.u,
        normalised=None if change is None else change.normalised,
    )
