"""Result JSON of a serial arm, version 1: parameters with uncertainties, and what they were identified from.

Values are absolute, not deviations; correlations are in the order of the identified parameters.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from catseye.app.cell.arm import ArmDescription
from catseye.app.cell.tool import ToolDescription
from catseye.app.files.atomic import write_atomically
from catseye.app.results.model import Origin
from catseye.app.results.origin import origin_now
from catseye.app.results.provenance import Provenance
from catseye.app.results.result_file import format_of, read_result_file
from catseye.app.results.serial_arm.damage import DAMAGED, require_near, require_unit
from catseye.app.results.uncertainty_part import Finite, ResultPart, Uncertainty
from catseye.calibration.serial_arm.identification import ModelName
from catseye.calibration.serial_arm.joint_source import JointSource

SERIAL_ARM_FORMAT: Final = "catseye-serial-arm/1"

_ROUNDED: Final = 0.01
"""Coefficients may have been rounded by whoever wrote them down: their matrix may be indefinite by so much."""


class ParameterPart(ResultPart):
    """One number of the model.

    Attributes:
        name: of the part and of the number: `base.x_mm`, `A2.alpha_deg`, `nest1.x_mm`.
        value: absolute.
        u: standard uncertainty; 0 of a parameter that was not identified.
        unit: of both.
        nominal: value beforehand; None where there is none.
        identified: from the measurements; otherwise it keeps its nominal value.
        of_distances: an anchor's coordinate or a dead path: nothing of the arm.
        low: lower end of the 95 % interval of a Monte Carlo; None without one.
        high: upper end.
    """

    name: str
    value: Finite
    u: Uncertainty
    unit: str
    nominal: Finite | None
    identified: bool
    of_distances: bool = False
    low: Finite | None = None
    high: Finite | None = None


class FitPart(ResultPart):
    """Quality of the fit.

    Attributes:
        n_rows: coordinates and distances.
        n_parameters: identified ones.
        rms_mm: of the residuals.
        chi2_reduced: for the stated uncertainties; None where none are stated.
        chi2_probability: of so much or more.
        lack_of_fit: the rows contradict the model beyond what is stated.
    """

    n_rows: int
    n_parameters: int
    rms_mm: Uncertainty
    chi2_reduced: Finite | None = None
    chi2_probability: Finite | None = None
    lack_of_fit: bool = False


class HeldOutPart(ResultPart):
    """Errors of poses that calibrations without them predict, mm."""

    mean_mm: Uncertainty
    max_mm: Uncertainty


class CandidatePart(ResultPart):
    """A model that was tried.

    Attributes:
        mean_mm: mean error of poses left out, the same ones of all models; None where it was not compared.
        reason: why it was not, or which poses it does not predict.
        effective_parameters: what the rows pay for; less than its parameters where something is known beforehand.
        behind_mm: mean over the poses by which it misses them more than the model that misses them least.
        u_behind_mm: standard error of that.
    """

    model: str
    mean_mm: Uncertainty | None
    reason: str = ""
    effective_parameters: Uncertainty | None = None
    behind_mm: Finite | None = None
    u_behind_mm: Uncertainty | None = None


class RejectedPart(ResultPart):
    """A pose that contradicts the others: rms by which they miss it, and the probability of so much by chance."""

    pose: str
    error_mm: Uncertainty
    probability: Uncertainty


class DrawsPart(ResultPart):
    """The Monte Carlo that uncertainties and correlations come from, and how many draws the damped solver took."""

    draws: int
    seed: int
    damped_solutions: int


class AnchorPart(ResultPart):
    """The fixed end of distances, in the frame of the instrument, mm; identified ones are parameters, too."""

    name: str
    place_mm: tuple[Finite, Finite, Finite]


class ErrorsPart(ResultPart):
    """3-D errors of points at the poses that were used, mm: links as drawn with frames fitted, and poses left out.

    Attributes:
        place_mm: measured, in the frame of the instrument.
    """

    pose: list[str]
    target: list[str]
    place_mm: list[tuple[Finite, Finite, Finite]]
    frames_mm: list[Finite]
    left_out_mm: list[Finite | None]

    @model_validator(mode="after")
    def _of_one_length(self) -> Self:
        columns = (self.pose, self.target, self.place_mm, self.frames_mm, self.left_out_mm)
        if len({len(column) for column in columns}) > 1:
            raise ValueError(f"errors have not one value a point: {DAMAGED}")
        return self


class MassPart(ResultPart):
    """Errors at random poses when the masses are wrong by a share, each up or down, and their centres too; mm."""

    share: Uncertainty
    draws: int
    mean_mm: Uncertainty
    max_mm: Uncertainty


class ImplausiblePart(ResultPart):
    """What the gate found, and why the result is kept all the same."""

    accepted: str
    findings: list[str]


class FramesPart(ResultPart):
    """Base and targets alone, the links as drawn: the errors that they leave on the same poses, mm."""

    mean_mm: Uncertainty
    std_mm: Uncertainty
    max_mm: Uncertainty
    parameters: list[ParameterPart]

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        _require_each_once(self.parameters)
        return self


class SerialArmResult(ResultPart):
    """A whole result file.

    Attributes:
        arm: name of the description, or its path.
        model: from frames to maps.
        null_directions: parameters that say the same to such measurements; the last of each is held.
        correlation: of the identified parameters, row by row.
        joints: what the poses were taken to be.
        base_drift_mm: how far the base went from where it stood at the first pose, root mean square of its
            coordinates; None where no drift was seen.
        pose_scatter_mm: standard deviation of each coordinate by which poses are off as a whole, where several
            targets of a pose show it.
        left_mm: standard deviation of each coordinate by which the model misses single poses, beyond what the
            uncertainties of parameters and rows explain; None where the rows do not contradict them.
        description: the nominal arm.
        tool: its tool; None where targets had unknown places.
        monte_carlo: None where uncertainties follow from the Jacobian.
        loss: of the rows; a robust one leaves no pose out.
        anchors: of distances.
        errors: of single points, for histograms; None in results of earlier versions.
        masses: simulated identification with wrong masses; None where nothing depends on them.
        implausible: None where the gate found nothing.
        remarks: sentences about the measurements that nothing was refused for.
    """

    format: Literal["catseye-serial-arm/1"] = SERIAL_ARM_FORMAT
    arm: str
    model: ModelName
    parameters: list[ParameterPart]
    null_directions: list[Annotated[list[str], Field(min_length=1)]]
    correlation: list[list[Finite]]
    fit: FitPart
    cross_validation: HeldOutPart
    rejected: list[RejectedPart]
    provenance: Provenance | None = None
    joints: JointSource = "commanded"
    base_drift_mm: Uncertainty | None = None
    pose_scatter_mm: Uncertainty | None = None
    left_mm: Uncertainty | None = None
    candidates: list[CandidatePart] = Field(default_factory=list)
    frames: FramesPart | None = None
    description: ArmDescription | None = None
    tool: ToolDescription | None = None
    monte_carlo: DrawsPart | None = None
    loss: Literal["squares", "huber", "soft-l1"] = "squares"
    anchors: list[AnchorPart] = Field(default_factory=list)
    errors: ErrorsPart | None = None
    masses: MassPart | None = None
    implausible: ImplausiblePart | None = None
    remarks: list[str] = Field(default_factory=list)

    @field_validator("provenance", mode="before")
    @classmethod
    def _stated(cls, value: object) -> object:
        """Take an empty provenance, as the format allows, for none."""
        return value or None

    @model_validator(mode="after")
    def _whole(self) -> Self:
        _require_each_once(self.parameters)
        for part in (*self.parameters, *([] if self.frames is None else self.frames.parameters)):
            require_unit(part.name, part.unit)
            if self.implausible is None and part.nominal is not None:
                require_near(part.name, part.value, part.nominal, part.u)
        _require_each_once(self.anchors)
        _require_correlation(self.correlation, sum(one.identified for one in self.parameters))
        return self

    @property
    def origin(self) -> Origin:
        """Where a report that is made of it now comes from."""
        return origin_now() if self.provenance is None else self.provenance.origin


def _require_each_once(parts: Sequence[ParameterPart | AnchorPart]) -> None:
    names = [one.name for one in parts]
    if twice := [name for name in names if names.count(name) > 1]:
        raise ValueError(f"{twice[0]} stands twice: {DAMAGED}")


def _require_correlation(rows: Sequence[Sequence[float]], identified: int) -> None:
    """Refuse what is no matrix of the correlations of the identified parameters."""
    if [len(row) for row in rows] != identified * [identified]:
        raise ValueError(
            f"correlation is not the matrix of {identified} identified parameters, {identified} rows of as many: "
            f"{DAMAGED}"
        )
    matrix = np.array(rows, dtype=np.float64).reshape(identified, identified)
    off = (np.abs(matrix) > 1.0 + _ROUNDED) | (np.abs(matrix - matrix.T) > _ROUNDED)
    off |= np.eye(identified, dtype=np.bool_) & (np.abs(matrix - 1.0) > _ROUNDED)
    if off.any():
        i, j = np.argwhere(off)[0]
        raise ValueError(
            f"correlation has {matrix[i, j]:g} in row {i + 1}, column {j + 1}: coefficients lie between -1 and 1, "
            f"are 1 on the diagonal and alike on both sides of it: {DAMAGED}"
        )
    if identified and np.linalg.eigvalsh(matrix)[0] < -_ROUNDED:
        raise ValueError(f"correlation has coefficients that no errors can have together: {DAMAGED}")


def serial_arm_text(result: SerialArmResult) -> str:
    """Return the text of a result file."""
    return json.dumps(result.model_dump(mode="json", by_alias=True), ensure_ascii=False, indent=1) + "\n"


def write_serial_arm(result: SerialArmResult, path: Path) -> None:
    """Write a result file, whole or not at all."""
    write_atomically(path, serial_arm_text(result))


def is_of_serial_arm(path: Path) -> bool:
    """Return whether a result file is of a serial arm.

    Raises:
        UsageError: the file is missing or cannot be read.
    """
    return format_of(path) == SERIAL_ARM_FORMAT


def read_serial_arm(path: Path) -> SerialArmResult:
    """Read a result file.

    Raises:
        UsageError: the file is missing or no result; names what is wrong.
    """
    return read_result_file(path, SerialArmResult, "catseye calibrate")
