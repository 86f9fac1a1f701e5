"""A serial arm against measured poses, as `validate --json` writes it."""

from typing import Literal

from catseye.app.results.document import Document
from catseye.app.results.said import Said, said
from catseye.app.results.serial_arm.validation import ArmValidation


class ErrorFigures(Document):
    """Sizes of errors; of places the lengths of their three-dimensional errors."""

    mean_mm: float
    std_mm: float
    max_mm: float


class TargetErrors(ErrorFigures):
    """Errors at one target in one state of the arm; the mean has its sign where distances were measured."""

    target: str
    state: str


class ArmValidationDocument(Document):
    """Everything that a validation found.

    Attributes:
        n: measured rows.
        frames_only: the links as drawn, frames fitted; null where the result has none.
        inside_95_percent: share of rows within their 95 % regions, percent; null where nobody says how
            uncertain they are.
        assumed_u_mm: taken for rows that state no uncertainty; null where they do.
        fitted_anchors: of distances, that nobody knew.
        fitted_dead_paths: of known anchors.
        said: in sentences.
    """

    n: int
    measured: Literal["distances", "places"]
    frames_only: ErrorFigures | None
    calibrated: ErrorFigures
    inside_95_percent: float | None
    assumed_u_mm: float | None
    by_target: list[TargetErrors]
    fitted_anchors: list[str]
    fitted_dead_paths: list[str]
    said: tuple[Said, ...]


def arm_validation_document(found: ArmValidation) -> ArmValidationDocument:
    """Return what a validation found as JSON has it."""
    drawn = found.frames_only
    return ArmValidationDocument(
        n=len(found.targets),
        measured="distances" if found.of_distances else "places",
        frames_only=None if drawn is None else ErrorFigures.model_validate(drawn.figures()),
        calibrated=ErrorFigures.model_validate(found.calibrated.figures()),
        inside_95_percent=found.inside_95_percent,
        assumed_u_mm=found.assumed_u_mm,
        by_target=[
            TargetErrors.model_validate({"target": target, "state": state, **figures})
            for target, state, figures in found.by_target()
        ],
        fitted_anchors=list(found.fitted),
        fitted_dead_paths=list(found.dead_paths),
        said=said(found.statements()),
    )
