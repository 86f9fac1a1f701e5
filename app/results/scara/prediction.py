"""Where an identified arm really goes on a path: positions, report, predicted CSV (version 1)."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from catseye.app.errors import MeasurementRejectedError
from catseye.app.files.atomic import write_atomically
from catseye.app.files.csv_text import csv_text
from catseye.app.results.document import Document
from catseye.app.results.model import Report, Sign, Statement, section
from catseye.app.results.numbers import counted, fixed
from catseye.app.results.origin import origin_now
from catseye.app.results.scara.identified_arm import arm_of, arm_remarks, nominal_of
from catseye.app.results.scara.path_csv import CommandPath
from catseye.app.results.scara.path_range import lines_text, outside_text
from catseye.app.results.scara.path_start import start_text
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.validation import TAKE_UP_DEG, established_rows
from catseye.app.results.summary import Line, summary_table
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.prediction import Prediction, predict

ADDED = ("x_pred_mm", "y_pred_mm", "ex_um", "ey_um", "u_ex_um", "u_ey_um")

_DECIMALS = (6, 6, 3, 3, 3, 3)
"""A nanometre throughout."""

_UM = fixed(1)


class PredictionDocument(Document):
    """Where the arm goes on a path; sizes are two-dimensional.

    Attributes:
        output: the predicted CSV.
        model: of the result.
        rows: of the path.
        predicted: rows within the identified range.
        rms_um: of the arm's errors.
        max_um: of the arm's errors.
        median_u_um: of the standard uncertainties of predictions.
        max_u_um: of the same.
        median_u_parts_um: what each contributor alone makes of the median.
        warnings: what to know about the result.
    """

    output: str
    model: str
    rows: int
    predicted: int
    rms_um: float
    max_um: float
    median_u_um: float
    max_u_um: float
    median_u_parts_um: dict[str, float]
    warnings: list[str]


@dataclass(frozen=True)
class PredictedPath:
    """A path with what the arm makes of it.

    Attributes:
        model: "conventional" or "error-map".
        prediction: positions with uncertainties; NaN outside the identified range.
        warnings: what a user of the predictions has to know.
    """

    model: str
    prediction: Prediction
    warnings: tuple[str, ...]

    def parts_um(self) -> dict[str, float]:
        """Return the median of what each contributor alone makes of the 2-D uncertainty, µm."""
        return {
            name: 1e3 * float(np.sqrt(np.median(variance[self.prediction.inside])))
            for name, variance in self.prediction.parts_mm2.items()
        }

    def document(self, output: Path) -> "PredictionDocument":
        """Return the JSON output."""
        return PredictionDocument.model_validate(
            {
                "output": str(output),
                "model": self.model,
                **self.figures(),
                "median_u_parts_um": self.parts_um(),
                "warnings": list(self.warnings),
            }
        )

    def figures(self) -> dict[str, float]:
        """Return counts of rows and 2-D sizes of errors and uncertainties, µm, by the names of the JSON output."""
        inside = self.prediction.inside
        error_um = 1e3 * np.hypot(*self.prediction.error_mm[inside].T)
        u_um = 1e3 * np.hypot(*self.prediction.u_mm[inside].T)
        return {
            "rows": int(inside.size),
            "predicted": int(inside.sum()),
            "rms_um": float(np.sqrt(np.mean(error_um**2))),
            "max_um": float(error_um.max()),
            "median_u_um": float(np.median(u_um)),
            "max_u_um": float(u_um.max()),
        }


def predict_path(result: Result, path: CommandPath, name: str) -> PredictedPath:
    """Predict a path.

    Raises:
        MeasurementRejectedError: no row lies inside the identified range.
    """
    arm, (nominal, _) = arm_of(result), nominal_of(result)
    outside = outside_text(arm, path.commands, path.places)
    prediction = predict(arm, path.commands, *nominal)
    if not prediction.inside.any():
        raise MeasurementRejectedError(
            f"{name}: {outside}. Nothing is left to predict, and nothing was written"
        )
    warnings = (*arm_remarks(result), outside, _just_reversed(arm, path), _start(arm, path))
    return PredictedPath(arm.layout.model, prediction, tuple(text for text in warnings if text))


def _just_reversed(arm: IdentifiedArm, path: CommandPath) -> str:
    """Return a sentence about rows on neither flank of the backlash; empty for a model that knows no directions."""
    if arm.layout.model == "conventional":
        return ""
    loose = ~established_rows(path.commands, float(np.deg2rad(TAKE_UP_DEG)), path.line)
    if not loose.any():
        return ""
    return (
        f"in {counted(int(loose.sum()), 'row')} a joint has moved less than {TAKE_UP_DEG:g}° since it reversed "
        f"({lines_text(path.places, loose)}): their predictions are valid once the backlash is taken up"
    )


def _start(arm: IdentifiedArm, path: CommandPath) -> str:
    """Return a sentence about a first row that the path leaves against its state; joint commands state theirs."""
    return (
        ""
        if arm.layout.model == "conventional" or not path.cartesian
        else start_text(path.commands, path.numbers)
    )


def write_predicted_csv(path: CommandPath, prediction: Prediction, output: Path) -> None:
    """Write the path's own columns as they were, and the prediction; cells of rows without one are empty."""
    numbers = np.hstack([prediction.position_mm, 1e3 * prediction.error_mm, 1e3 * prediction.u_mm])
    rows = ([*row.cells.values(), *_cells(own)] for row, own in zip(path.rows, numbers, strict=True))
    write_atomically(output, csv_text([*path.rows[0].cells, *ADDED], rows))


def _cells(numbers: Floats) -> list[str]:
    # Adding 0.0 turns a rounded −0 into 0.
    return [
        f"{round(float(value), decimals) + 0.0:.{decimals}f}" if np.isfinite(value) else ""
        for value, decimals in zip(numbers, _DECIMALS, strict=True)
    ]


def prediction_report(path: PredictedPath) -> Report:
    """Return warnings and a summary of a prediction."""
    figures = path.figures()
    lines = (
        Line("rows predicted", "", f"{figures['predicted']} of {figures['rows']}"),
        Line("error of the arm, 2-D rms", "µm", figures["rms_um"], _UM),
        Line("error of the arm, largest", "µm", figures["max_um"], _UM),
        Line("its U (k = 2), 2-D median", "µm", figures["median_u_um"], _UM, standard=True),
        Line("its U (k = 2), 2-D largest", "µm", figures["max_u_um"], _UM, standard=True),
        *(
            Line(f"median from {name}", "µm", part_um, _UM, standard=True)
            for name, part_um in path.parts_um().items()
        ),
    )
    warnings = [Statement(Sign.ATTENTION, f"{text}.") for text in path.warnings]
    table = summary_table("predicted minus command", lines)
    return Report(
        "Prediction",
        origin_now(),
        (
            section("verdict", "Verdict", warnings, brief=True),
            section("summary", "Summary", [table], brief=True),
        ),
    )
