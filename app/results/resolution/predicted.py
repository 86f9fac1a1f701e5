"""Predicted Cartesian resolution as a document: the file with the errors of all steps, and what `--json` writes."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import Field

from catseye.app.files.atomic import write_atomically
from catseye.app.files.csv_text import OwnWord, csv_text
from catseye.app.results.resolution.result import Unit
from catseye.app.results.result_file import read_result_file
from catseye.app.results.uncertainty_part import Finite, ResultColumns, ResultPart

PREDICTED_FORMAT: Final = "catseye-predicted-resolution/1"


class PredictedCurve(ResultColumns):
    """Predicted errors of the steps of one direction.

    Attributes:
        command: sizes of the steps, decreasing, in the direction's unit.
        mean_percent: expected error along the direction, of the step.
        std_percent: standard deviation of a single step about it.
    """

    command: list[Annotated[Finite, Field(gt=0.0)]]
    mean_percent: list[Finite]
    std_percent: list[Finite]


class PredictedLeast(ResultPart):
    """The predicted least increment step of one direction at one place; numbers in its unit.

    Attributes:
        pose: name of the place.
        tcp_mm: of a point of a slice; None of a pose of a file.
        direction: +X … −RZ, with a plain minus sign.
        unit: of the step.
        lis: None where the reason says why it is not known.
        low: lower end of the 95 % interval of what one run of a measurement finds, 0 where runs keep within the
            threshold as far as steps are covered; None where nothing is known.
        high: upper end of it, which may be known without `lis`; None where it is not known.
        reason: why a number is missing; empty when none is.
        curve: None of points of a slice, and of directions without a covered step.
    """

    pose: str
    tcp_mm: list[Finite] | None = None
    direction: str
    unit: Unit
    lis: Annotated[Finite, Field(gt=0.0)] | None
    low: Finite | None
    high: Finite | None
    reason: str
    curve: PredictedCurve | None = None


class PredictedResolution(ResultPart):
    """A whole prediction.

    Attributes:
        format: name and version.
        arm: name of the arm's description.
        tables: name of the file with the look-up tables.
        threshold_percent: largest error of a step that counts as made.
        draws: runs that were simulated.
        seed: of the draws.
        simulated: the tables come from emulated devices.
        software: name and version of the program.
        created: ISO 8601 UTC time.
        least_steps: by place and direction.
    """

    format: Literal["catseye-predicted-resolution/1"] = PREDICTED_FORMAT
    arm: str
    tables: str
    threshold_percent: float
    draws: int
    seed: int
    simulated: bool
    software: str
    created: str
    least_steps: list[PredictedLeast]


def write_predicted(predicted: PredictedResolution, output: Path) -> None:
    """Write a prediction: whole as JSON where the file's name ends in .json, its least steps as CSV otherwise."""
    as_json = output.suffix.lower() == ".json"
    text = predicted.model_dump_json(indent=1) + "\n" if as_json else _csv(predicted.least_steps)
    write_atomically(output, text)


def _csv(rows: Sequence[PredictedLeast]) -> str:
    """Return the predicted CSV; of a slice with the places of its points."""
    places = () if rows[0].tcp_mm is None else ("x_mm", "y_mm", "z_mm")
    cells = (
        [
            row.pose,
            *(f"{value:.6g}" for value in row.tcp_mm or ()),
            OwnWord(row.direction),
            *("" if value is None else f"{value:.6g}" for value in (row.lis, row.low, row.high)),
            row.unit,
            row.reason,
        ]
        for row in rows
    )
    return csv_text(("pose", *places, "direction", "lis", "low", "high", "unit", "reason"), cells)


def read_predicted(path: Path) -> PredictedResolution:
    """Read a prediction.

    Raises:
        UsageError: the file is missing or no prediction; names what is wrong.
    """
    return read_result_file(path, PredictedResolution, "catseye predict-resolution")
