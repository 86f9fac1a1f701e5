"""Models on the validation path: predicted against independently measured positions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.agreement import Agreement, agreement
from catseye.calibration.scara.comparison import Comparison, compare
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.planar import Hand, forward, inverse, wrap_rad
from catseye.calibration.scara.points import Commands
from catseye.calibration.scara.prediction import Prediction, predict
from catseye.calibration.scara.prediction_errors import position_errors
from catseye.procedures.scara.path_lines import stretches


@dataclass(frozen=True)
class PathMeasurement:
    """A path that an independent instrument has measured.

    Attributes:
        commands: joint commands with directions of approach, n rows.
        command_mm: where the arm shall stand, shape (n, 2); corrected commands would lead the nominal arm elsewhere.
        travel: 1 on the way there, -1 on the way back, shape (n,).
        measured_mm: measured positions in the instrument's frame, shape (n, 2).
        u_mm: standard uncertainty of each measured coordinate, shape (n,), of a single pass even where several are
            averaged; NaN where the instrument states none.
        established: rows whose joints have moved at least the take-up angle since their last reversal, shape (n,);
            before that no direction of approach holds, and no bidirectional map says where the arm stands.
        arrivals: passes that each measured position is the mean of.
        numbers: number of the line that each row belongs to, shape (n,); None for a path that names none.
    """

    commands: Commands
    command_mm: Floats
    travel: Ints
    measured_mm: Floats
    u_mm: Floats
    established: Bools
    arrivals: int = 1
    numbers: Ints | None = None

    @property
    def lines(self) -> list[slice]:
        """The rows of each line, in order."""
        return stretches(
            np.ones(len(self.commands), dtype=np.int64) if self.numbers is None else self.numbers
        )


FEWEST_ROWS = 4
"""Rows that leave something to compare after the alignment."""

TAKE_UP_DEG = 1.0
"""Travel after which a direction of approach holds, where no cell file states it: what a cell file has by default."""


def established_rows(commands: Commands, take_up_rad: float, line: Ints | None = None) -> Bools:
    """Return the rows whose joints have both moved the take-up angle since their last reversal, shape (n,).

    A joint whose state changes against its step, or without one, was brought there by a take-up.

    Args:
        commands: a path in order; the first row of each line was approached with a take-up.
        take_up_rad: travel after which a direction of approach holds, rad.
        line: number of the line of each row, shape (n,); None for one line.
    """
    flags = np.empty(len(commands), dtype=np.bool_)
    for rows in [slice(None)] if line is None else stretches(line):
        first = _travel_since_reversal(commands.theta1_rad[rows], commands.direction1[rows])
        second = _travel_since_reversal(commands.theta2_rad[rows], commands.direction2[rows])
        flags[rows] = np.minimum(first, second) >= take_up_rad
    return flags


def _travel_since_reversal(theta_rad: Floats, direction: Ints) -> Floats:
    """Return how far a joint has moved since its direction changed, rad, infinite before the first change."""
    steps = np.diff(theta_rad, prepend=theta_rad[:1])
    way = np.cumsum(np.abs(steps))
    turned = np.flatnonzero(np.diff(direction) != 0) + 1
    # The row before the change is where the joint stood when it turned.
    at_turn = np.where(steps[turned] * direction[turned] > 0.0, way[turned - 1], -np.inf)
    last = np.append(-np.inf, at_turn)[np.searchsorted(turned, np.arange(theta_rad.size), side="right")]
    return np.asarray(way - last, dtype=np.float64)


@dataclass(frozen=True)
class ModelOnPath:
    """One model on the path.

    Attributes:
        model: "conventional" or "error-map".
        title: what a reader calls it; empty for the model's own name.
        prediction: predicted positions with uncertainties; NaN outside the identified range.
        comparison: against the measurement, over the rows that every model predicts.
        agreement: of what it leaves with the stated uncertainties.
    """

    model: str
    title: str
    prediction: Prediction
    comparison: Comparison
    agreement: Agreement

    @property
    def median_u_um(self) -> float:
        """Median of the 2-D standard uncertainties of what is predicted and compared, µm."""
        return 1e3 * float(np.nanmedian(np.hypot(*self.prediction.u_mm[self.comparison.inside].T)))


@dataclass(frozen=True)
class PathValidation:
    """All models on the path.

    Attributes:
        path: what was measured.
        compared: rows with an established approach that every model predicts, shape (n,).
        models: one entry a model, in the order given; what they predict is compared with the wished positions.
        uncorrected_mm: where the last model puts the arm at the nominal commands of the wished positions, shape
            (n, 2), NaN where it says nothing; None where just these were driven.
    """

    path: PathMeasurement
    compared: Bools
    models: tuple[ModelOnPath, ...]
    uncorrected_mm: Floats | None = None

    @property
    def ratio(self) -> float | None:
        """Error left by the last model over that left by the first (2-D rms), None for a single model."""
        if len(self.models) < 2:
            return None
        return self.models[-1].comparison.rms_2d_um / self.models[0].comparison.rms_2d_um


def validate_on_path(
    path: PathMeasurement,
    arms: Sequence[IdentifiedArm],
    nominal: tuple[float, float],
    titles: Sequence[str] = (),
) -> PathValidation:
    """Compare models with a measured path, all over the same rows.

    Args:
        arms: the models, the reference (conventional) first.
        nominal: nominal links, mm.
        titles: what a reader calls them; without, the models' own names.

    Raises:
        InsufficientPointsError: fewer than four rows inside the identified range.
        UnidentifiableError: the rows lie in one place.
    """
    # Of a corrected command the wished position is what it was made for, not where it leads on the nominal arm.
    predictions = [replace(predict(arm, path.commands, *nominal), command_mm=path.command_mm) for arm in arms]
    compared: Bools = np.logical_and.reduce([path.established, *(one.inside for one in predictions)])
    if int(compared.sum()) < FEWEST_ROWS:
        raise InsufficientPointsError(
            f"{int(compared.sum())} of {compared.size} rows lie inside the identified range with an established "
            f"direction of approach; a rigid alignment has three unknowns, so that it takes {FEWEST_ROWS} or more: "
            "measure a path inside the nodes"
        )
    names = titles or [""] * len(arms)
    models = tuple(
        _on_path(path, arm, name, prediction, compared)
        for arm, name, prediction in zip(arms, names, predictions, strict=True)
    )
    return PathValidation(path, compared, models, _uncorrected(path, arms[-1], nominal))


_CORRECTED_MM = 1e-3
"""Commands whose nominal positions are nearer to the wished ones are not corrected, but rounded."""


def _uncorrected(path: PathMeasurement, arm: IdentifiedArm, nominal: tuple[float, float]) -> Floats | None:
    """Return where the arm would stand without the correction; None for a path that is not corrected."""
    commands = path.commands
    off = forward(commands.theta1_rad, commands.theta2_rad, *nominal) - path.command_mm
    radius = np.hypot(*path.command_mm.T)
    reached = (radius >= abs(nominal[0] - nominal[1])) & (radius <= sum(nominal))
    if float(np.hypot(*off.T).max()) <= _CORRECTED_MM or not reached.all():
        return None
    theta = np.empty(path.command_mm.shape)
    hands: tuple[tuple[Hand, Bools], ...] = (
        ("right", commands.theta2_rad >= 0.0),
        ("left", commands.theta2_rad < 0.0),
    )
    for hand, rows in hands:
        theta[rows] = np.column_stack(inverse(path.command_mm[rows], *nominal, hand))
    theta[:, 0] = commands.theta1_rad + wrap_rad(theta[:, 0] - commands.theta1_rad)
    nominal_commands = Commands(theta[:, 0], theta[:, 1], commands.direction1, commands.direction2)
    return predict(arm, nominal_commands, *nominal).position_mm


def _on_path(
    path: PathMeasurement, arm: IdentifiedArm, title: str, prediction: Prediction, compared: Bools
) -> ModelOnPath:
    comparison = compare(path.command_mm, prediction.position_mm, path.measured_mm, compared)
    errors = position_errors(arm, path.commands.select(compared), path.arrivals)
    judged = agreement(comparison, errors, path.u_mm)
    return ModelOnPath(arm.layout.model, title, prediction, comparison, judged)
