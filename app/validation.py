"""Models on the validation path: predicted against independently measured positions."""

from dataclasses import dataclass

import numpy as np

from calibration.comparison import Comparison, compare
from calibration.identification import Identification
from calibration.points import Commands
from calibration.prediction import Prediction, predict
from calibration.types import Bools, Floats, Ints


@dataclass(frozen=True)
class PathMeasurement:
    """A path that an independent instrument has measured.

    Attributes:
        commands: joint commands with directions of approach, n rows.
        command_mm: command positions, shape (n, 2).
        travel: 1 on the way there, -1 on the way back, shape (n,).
        measured_mm: measured positions in the instrument's frame, shape (n, 2).
        u_mm: standard uncertainty of each measured coordinate, shape (n,).
    """

    commands: Commands
    command_mm: Floats
    travel: Ints
    measured_mm: Floats
    u_mm: Floats


@dataclass(frozen=True)
class ModelOnPath:
    """One model on the path.

    Attributes:
        model: "conventional" or "error-map".
        prediction: predicted positions with uncertainties; NaN outside the identified range.
        comparison: against the measurement, over the rows that every model predicts.
    """

    model: str
    prediction: Prediction
    comparison: Comparison


@dataclass(frozen=True)
class PathValidation:
    """All models on the path.

    Attributes:
        path: what was measured.
        compared: rows that every model predicts, shape (n,).
        models: one entry a model, in the order given.
    """

    path: PathMeasurement
    compared: Bools
    models: tuple[ModelOnPath, ...]

    @property
    def ratio(self) -> float | None:
        """Error left by the last model over that left by the first (2-D rms), None for a single model."""
        if len(self.models) < 2:
            return None
        return self.models[-1].comparison.rms_2d_um / self.models[0].comparison.rms_2d_um


def validate_on_path(
    path: PathMeasurement, identified: list[Identification], nominal: tuple[float, float]
) -> PathValidation:
    """Compare models with a measured path, all over the same rows.

    Args:
        path: what was measured.
        identified: the models, the reference (conventional) first.
        nominal: nominal links, mm.

    Raises:
        InsufficientPointsError: fewer than two rows inside the identified range.
    """
    predictions = [predict(one, path.commands, *nominal) for one in identified]
    compared: Bools = np.logical_and.reduce([prediction.inside for prediction in predictions])
    models = tuple(
        ModelOnPath(
            one.layout.model,
            prediction,
            compare(path.command_mm, prediction.position_mm, path.measured_mm, compared),
        )
        for one, prediction in zip(identified, predictions, strict=True)
    )
    return PathValidation(path, compared, models)
