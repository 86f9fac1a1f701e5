"""Where an identified arm really goes on a path."""

from dataclasses import dataclass

import numpy as np

from catseye.app.errors import MeasurementRejectedError
from catseye.app.results.numbers import counted
from catseye.app.results.scara.identified_arm import arm_of, arm_remarks, nominal_of
from catseye.app.results.scara.path_csv import CommandPath
from catseye.app.results.scara.path_range import lines_text, outside_text
from catseye.app.results.scara.path_start import start_text
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.validation import TAKE_UP_DEG, established_rows
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.prediction import Prediction, predict


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

    Args:
        path: commands.
        name: of the path's file.

    Raises:
        MeasurementRejectedError: no row lies inside the identified range.
    """
    arm, (nominal, _) = arm_of(result), nominal_of(result)
    outside = outside_text(arm, path.commands, _lines(path))
    prediction = predict(arm, path.commands, *nominal)
    if not prediction.inside.any():
        raise MeasurementRejectedError(
            f"{name}: {outside}. Nothing is left to predict, and nothing was written"
        )
    warnings = (*arm_remarks(result), outside, _just_reversed(arm, path), _start(arm, path))
    return PredictedPath(arm.layout.model, prediction, tuple(text for text in warnings if text))


def _lines(path: CommandPath) -> list[int]:
    return [row.line for row in path.rows]


def _just_reversed(arm: IdentifiedArm, path: CommandPath) -> str:
    """Return a sentence about rows on neither flank of the backlash; empty for a model that knows no directions."""
    if arm.layout.model == "conventional":
        return ""
    loose = ~established_rows(path.commands, float(np.deg2rad(TAKE_UP_DEG)))
    if not loose.any():
        return ""
    return (
        f"in {counted(int(loose.sum()), 'row')} a joint has moved less than {TAKE_UP_DEG:g}° since it reversed "
        f"({lines_text(_lines(path), loose)}): their errors hold once the backlash is taken up"
    )


def _start(arm: IdentifiedArm, path: CommandPath) -> str:
    """Return a sentence about a first row that the path leaves against its state; joint commands state theirs."""
    return "" if arm.layout.model == "conventional" or not path.cartesian else start_text(path.commands)
