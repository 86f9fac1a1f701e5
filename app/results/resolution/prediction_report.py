"""What a prediction of Cartesian resolution says: as a report, and as JSON."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from catseye.app.cell.arm import ArmDescription
from catseye.app.results.document import Document
from catseye.app.results.model import Block, Column, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import NOTHING, SHARE_EXPECTED, Format, counted, number
from catseye.app.results.origin import origin_now
from catseye.app.results.resolution.cartesian_comparison import Compared
from catseye.app.results.resolution.cartesian_prediction import PredictedDirection
from catseye.calibration.resolution.predictor import unit_of


class LeastStepPart(Document):
    """One direction at one place; numbers in its unit."""

    pose: str
    tcp_mm: list[float] | None
    direction: str
    unit: str
    lis: float | None
    low: float | None
    high: float | None
    reason: str


class ComparedPart(Document):
    """A measured least step beside the predicted one; null where nothing is predicted."""

    pose: str
    direction: str
    predicted: float | None
    measured: float
    inside: bool | None


class PredictionDocument(Document):
    """Everything that is predicted."""

    least_steps: list[LeastStepPart]
    compared: list[ComparedPart] | None


def prediction_document(
    rows: Sequence[PredictedDirection], compared: Sequence[Compared] | None
) -> PredictionDocument:
    """Return what is predicted, as JSON has it, and how it compares with measured steps."""
    return PredictionDocument(
        compared=None
        if compared is None
        else [
            ComparedPart(
                pose=one.predicted.place.name,
                direction=one.predicted.direction,
                predicted=one.predicted.least.lis,
                measured=one.measured.value,
                inside=one.inside,
            )
            for one in compared
        ],
        least_steps=[
            LeastStepPart(
                pose=row.place.name,
                tcp_mm=None if row.place.tcp_mm is None else row.place.tcp_mm.tolist(),
                direction=row.direction,
                unit=unit_of(row.direction),
                lis=row.least.lis,
                low=row.least.low,
                high=row.least.high,
                reason=row.least.reason,
            )
            for row in rows
        ],
    )


_SIZE: Final = Format("significant", 2)


def prediction_report(
    arm: ArmDescription,
    rows: Sequence[PredictedDirection],
    tables: Path,
    compared: Sequence[Compared] | None,
) -> Report:
    """Return what is predicted, with how much is left open, and how it compares with measured steps."""
    open_rows = [row for row in rows if row.least.lis is None]
    statements = [
        Statement(
            Sign.NEUTRAL,
            f"{arm.name}: {len(rows) - len(open_rows)} of {counted(len(rows), 'direction')} predicted with {tables}.",
        )
    ]
    if open_rows:
        first = open_rows[0]
        statements.append(
            Statement(
                Sign.ATTENTION,
                f"{counted(len(open_rows), 'direction')} without a number, first {first.direction} at pose "
                f"{first.place.name}: {first.least.reason}. The file gives the reason of each.",
            )
        )
    return Report(
        "Predicted Cartesian resolution",
        origin_now(),
        (
            section("verdict", "Verdict", statements, brief=True),
            section("steps", "Least increment steps", [_table(rows)], brief=True),
            section("comparison", "Predicted and measured", _comparison(compared), brief=True),
        ),
    )


_MOST_ROWS = 60
"""A table of a slice stands in the file, not on the terminal."""


def _table(rows: Sequence[PredictedDirection]) -> Table | None:
    if len(rows) > _MOST_ROWS:
        return None
    columns = (
        Column("pose", "pose"),
        Column("direction", "direction"),
        Column("lis", "least step", format=_SIZE),
        Column("low", "low", format=_SIZE),
        Column("high", "high", format=_SIZE),
        Column("unit", "unit"),
    )
    cells = tuple(
        (row.place.name, row.direction, row.least.lis, row.least.low, row.least.high, unit_of(row.direction))
        for row in rows
    )
    return Table("least_steps", "Predicted least increment steps with their 95 % intervals", columns, cells)


def _comparison(compared: Sequence[Compared] | None) -> list[Block]:
    """Return measured steps beside predicted ones (Table 6 of the paper)."""
    if compared is None:
        return []
    judged = [one for one in compared if one.inside is not None]
    inside = sum(bool(one.inside) for one in judged)
    statement = Statement(
        Sign.GOOD if judged and inside >= SHARE_EXPECTED * len(judged) else Sign.ATTENTION,
        f"{inside} of {counted(len(judged), 'measured least step')} within the predicted 95 % interval.",
    )
    columns = (
        Column("pose", "pose"),
        Column("direction", "direction"),
        Column("predicted", "predicted"),
        Column("measured", "measured"),
        Column("inside", "within"),
    )
    cells = tuple(
        (
            one.predicted.place.name,
            one.predicted.direction,
            interval_text(one.predicted.least.lis, one.predicted.least.low, one.predicted.least.high),
            interval_text(one.measured.value, one.measured.low, one.measured.high),
            {True: "yes", False: "no", None: NOTHING}[one.inside],
        )
        for one in compared
    )
    return [
        statement,
        Table("comparison", "Least increment steps in mm with their 95 % intervals", columns, cells),
    ]


def interval_text(value: float | None, low: float | None, high: float | None) -> str:
    """Return a least step with its interval, a dash for what is not known."""
    if value is None:
        return NOTHING
    return f"{number(value, _SIZE)} ({number(low, _SIZE)} … {number(high, _SIZE)})"
