"""What a prediction of Cartesian resolution says: as a report, and as JSON."""

from collections.abc import Sequence

from catseye.app.results.model import Column, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import counted
from catseye.app.results.origin import origin_now
from catseye.app.results.resolution.cartesian_comparison import Compared, comparison_blocks
from catseye.app.results.resolution.naming import STEP
from catseye.app.results.resolution.predicted import PredictedLeast, PredictedResolution


def prediction_report(predicted: PredictedResolution, compared: Sequence[Compared] | None) -> Report:
    """Return what is predicted, with how much is left open, and how it compares with measured steps."""
    rows = predicted.least_steps
    return Report(
        "Predicted Cartesian resolution",
        origin_now(simulated=predicted.simulated),
        (
            section("verdict", "Verdict", prediction_said(predicted), brief=True),
            section("steps", "Least increment steps", [_table(rows)], brief=True),
            section(
                "comparison",
                "Predicted and measured",
                [] if compared is None else comparison_blocks(compared),
                brief=True,
            ),
        ),
    )


def prediction_said(predicted: PredictedResolution) -> list[Statement]:
    """Return how many directions are predicted, and why the first of the others is not."""
    rows = predicted.least_steps
    open_rows = [row for row in rows if row.lis is None]
    at_most = sum(row.high is not None for row in open_rows)
    statements = [
        Statement(
            Sign.NEUTRAL,
            f"{predicted.arm}: {len(rows) - len(open_rows)} of {counted(len(rows), 'direction')} predicted with "
            f"{predicted.tables}.",
        )
    ]
    if open_rows:
        first = open_rows[0]
        statements.append(
            Statement(
                Sign.ATTENTION,
                f"{counted(len(open_rows), 'direction')} without a least step, {at_most} with an upper end of it; "
                f"first {first.direction} at pose {first.pose}: {first.reason}. The file gives the reason of each.",
            )
        )
    return statements


_MOST_ROWS = 60
"""A table of a slice stands in the file, not on the terminal."""


def _table(rows: Sequence[PredictedLeast]) -> Table | None:
    if len(rows) > _MOST_ROWS:
        return None
    columns = (
        Column("pose", "pose"),
        Column("direction", "direction"),
        Column("lis", "least step", format=STEP),
        Column("low", "low", format=STEP),
        Column("high", "high", format=STEP),
        Column("unit", "unit"),
    )
    cells = tuple((row.pose, row.direction, row.lis, row.low, row.high, row.unit) for row in rows)
    return Table("least_steps", "Predicted least increment steps with their 95 % intervals", columns, cells)
