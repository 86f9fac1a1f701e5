"""A validation as numbers, for machines."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from pydantic import RootModel

from catseye.app.results.document import Document, Stated
from catseye.app.results.figure_document import FigureParts
from catseye.app.results.figures import Figure
from catseye.app.results.numbers import MDEG_PER_RAD
from catseye.app.results.said import Said, said
from catseye.app.results.scara.path_view import model_title, path_axis, there
from catseye.app.results.scara.validation import ModelOnPath
from catseye.app.results.scara.validation_text import agreement_statement, agreement_text, path_statement

if TYPE_CHECKING:
    # The report comes with it: who only reads a validation starts without.
    from catseye.app.results.scara.validation_of_files import FileValidation


class Fitted(Document):
    """A parameter of an alignment, with its standard uncertainty."""

    value: float
    u: float


class AlignmentPart(Document):
    """How the measurement is laid onto the predictions of a model."""

    rotation_mdeg: Fitted
    shift_x_mm: Fitted
    shift_y_mm: Fitted


class ModelOnPathPart(Document):
    """What a model leaves on the path.

    Attributes:
        max_line: line of the measured file where it leaves most.
        ratio: of its 2-D rms to that of the first model.
        expected_parts_um: what each contributor alone makes of the expected 2-D rms.
        share_explained: of the mean square that the stated uncertainties explain.
        within_2u: share of the rows.
    """

    model: str
    title: str
    alignment: AlignmentPart
    rms_x_um: float
    rms_y_um: float
    rms_um: float
    max_um: float
    max_line: int
    ratio: float
    median_u_um: float
    expected_um: float
    expected_parts_um: dict[str, float]
    share_explained: Stated
    within_2u: Stated
    probability: float


class JointQuantityPart(Document):
    """A quantity after ISO 230-2 of a map of the result."""

    joint: int
    symbol: str
    name: str
    value_mdeg: float
    u_mdeg: float
    excess_mdeg: float


class RepeatedPosePart(Document):
    """A pose that was attained several times, after ISO 9283."""

    theta1_deg: float
    theta2_deg: float
    direction1: int
    direction2: int
    n: int
    ap_um: float
    rp_um: float
    ap_to_model_um: Stated


class DeviationPart(Document):
    """A deviation along the path: as it was measured, and as each model predicts it."""

    symbol: str
    what: str
    measured_um: list[float]
    predicted_um: list[list[float]]


class PathPart(Document):
    """The compared rows along the path.

    The measurement is aligned to the last model; the predictions of another one are in that frame too, so that
    measured minus predicted is what this model leaves after its own alignment.

    Attributes:
        axis: label of the axis along the path.
        line: of each row, in the measured file.
        way_there: the row belongs to the way there, and not back.
        path_line: number of the line of the path; None where it names none.
        models: titles, as in `predicted_um` of the deviations.
    """

    axis: str
    axis_mm: list[float]
    line: list[int]
    way_there: list[bool]
    path_line: list[int] | None = None
    models: list[str]
    deviations: list[DeviationPart]


class ValidationDocument(Document):
    """Everything that a validation found.

    Attributes:
        left_out: sentences about rows that are not compared.
        limit_um: 2-D rms that may be left.
        verdict: a sentence for each model.
        said: what both models leave, and whether that agrees with the uncertainties.
    """

    rows: int
    compared: int
    left_out: list[str]
    warnings: list[str]
    models: list[ModelOnPathPart]
    ratio: float | None
    limit_um: float | None
    within_limit: bool | None
    iso230_2: list[JointQuantityPart]
    iso9283: list[RepeatedPosePart]
    path: PathPart
    verdict: list[str]
    said: tuple[Said, ...] = ()
    figures: FigureParts


class ModelOnDistancesPart(Document):
    """What a model leaves on distances along the path.

    Attributes:
        probability: of deviations this large by the stated uncertainties; None where no scatter is stated.
    """

    model: str
    rms_um: float
    max_um: float
    median_u_um: float
    probability: float | None


class DistanceValidationDocument(Document):
    """Everything that a validation on distances found.

    Attributes:
        left_out: sentences about segments that are not compared.
        ratio: rms left by the last model over that left by the first.
        limit_um: rms that may be left.
        said: what both models leave.
    """

    rows: int
    compared: int
    left_out: list[str]
    models: list[ModelOnDistancesPart]
    ratio: float | None
    limit_um: float | None
    within_limit: bool | None
    said: tuple[Said, ...] = ()


class AnyValidationDocument(RootModel[ValidationDocument | DistanceValidationDocument]):
    """What `validate` of a SCARA writes: on positions, or on distances."""


def validation_document(
    file: "FileValidation", limit_um: float | None, figures: Sequence[Figure]
) -> ValidationDocument:
    """Return what a validation found as plain values.

    Args:
        limit_um: 2-D rms that may be left.
    """
    validation = file.validation
    left_um = validation.models[-1].comparison.rms_2d_um
    return ValidationDocument(
        rows=int(validation.compared.size),
        compared=int(validation.compared.sum()),
        left_out=file.left_out,
        warnings=file.remarks,
        models=[_model(model, file) for model in validation.models],
        ratio=validation.ratio,
        limit_um=limit_um,
        within_limit=None if limit_um is None else left_um <= limit_um,
        iso230_2=[
            JointQuantityPart(
                joint=joint_map.joint,
                symbol=quantity.symbol,
                name=quantity.name,
                value_mdeg=quantity.value,
                u_mdeg=quantity.u,
                excess_mdeg=quantity.excess,
            )
            for joint_map in file.maps
            for quantity in joint_map.quantities()
        ],
        iso9283=_repeats(file),
        path=_path(file),
        verdict=[agreement_text(model) for model in validation.models],
        said=said([path_statement(validation), agreement_statement(validation.models[-1])]),
        figures=tuple(figures),
    )


def _model(model: ModelOnPath, validation: "FileValidation") -> ModelOnPathPart:
    comparison, judged = model.comparison, model.agreement
    first_um = validation.validation.models[0].comparison.rms_2d_um
    rms_x, rms_y = comparison.rms_um
    return ModelOnPathPart(
        model=model.model,
        title=model_title(model),
        alignment=_alignment(model),
        rms_x_um=rms_x,
        rms_y_um=rms_y,
        rms_um=comparison.rms_2d_um,
        max_um=comparison.max_um,
        max_line=validation.lines[comparison.worst],
        ratio=comparison.rms_2d_um / first_um if first_um > 0.0 else 1.0,
        median_u_um=model.median_u_um,
        expected_um=judged.expected_um,
        expected_parts_um=dict(judged.parts_um),
        share_explained=judged.share,
        within_2u=judged.within,
        probability=judged.probability,
    )


def _alignment(model: ModelOnPath) -> AlignmentPart:
    transform, judged = model.comparison.transform, model.agreement
    x, y = (
        Fitted(value=float(value), u=float(u))
        for value, u in zip(transform.shift_mm, judged.u_shift_mm, strict=True)
    )
    rotation = Fitted(value=MDEG_PER_RAD * transform.rotation_rad, u=MDEG_PER_RAD * judged.u_rotation_rad)
    return AlignmentPart(rotation_mdeg=rotation, shift_x_mm=x, shift_y_mm=y)


def _path(file: "FileValidation") -> PathPart:
    validation = file.validation
    axis, rows = path_axis(validation.path), validation.compared
    measured_mm = validation.models[-1].comparison.measured_error_mm[rows]
    left_mm = [model.comparison.difference_mm[rows] for model in validation.models]
    return PathPart(
        axis=axis.label,
        axis_mm=axis.values_mm[rows].tolist(),
        line=[line for line, compared in zip(file.lines, rows.tolist(), strict=True) if compared],
        way_there=there(validation.path)[rows].tolist(),
        path_line=None if validation.path.numbers is None else validation.path.numbers[rows].tolist(),
        models=[model_title(model) for model in validation.models],
        deviations=[
            DeviationPart(
                symbol=symbol.replace("{", "").replace("}", ""),
                what=what,
                measured_um=(1e3 * measured_mm[:, component]).tolist(),
                predicted_um=[
                    (1e3 * (measured_mm[:, component] - left[:, component])).tolist() for left in left_mm
                ],
            )
            for symbol, what, component in axis.deviations
        ],
    )


def _repeats(validation: "FileValidation") -> list[RepeatedPosePart]:
    path, repeats = validation.validation.path, validation.repeats
    return [
        RepeatedPosePart(
            theta1_deg=float(np.rad2deg(path.commands.theta1_rad[row])),
            theta2_deg=float(np.rad2deg(path.commands.theta2_rad[row])),
            direction1=int(path.commands.direction1[row]),
            direction2=int(path.commands.direction2[row]),
            n=pose.n,
            ap_um=1e3 * pose.accuracy,
            rp_um=1e3 * pose.repeatability,
            ap_to_model_um=1e3 * float(off),
        )
        for row, pose, off in zip(repeats.rows, repeats.poses, repeats.model_mm, strict=True)
    ]
