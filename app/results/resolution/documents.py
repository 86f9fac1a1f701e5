"""What `resolution` and `predict-resolution` say with `--json`; the files that they write have the rest."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from catseye.app.results.document import Document
from catseye.app.results.resolution.cartesian_comparison import Compared, direction_word
from catseye.app.results.resolution.predicted import PredictedResolution
from catseye.app.results.resolution.result import ResolutionResult


class ResolutionDocument(ResolutionResult):
    """The result that is written to a file, without its recordings."""

    result: str


class ComparedStep(Document):
    """A predicted step beside one that was measured; null where there is none.

    Attributes:
        inside: the prediction's interval holds the measured one.
    """

    pose: str
    direction: str
    predicted: float | None
    measured: float | None
    inside: bool | None


class StepPrediction(PredictedResolution):
    """The prediction that is written to a file, without the errors of single steps.

    Attributes:
        compared: with measured steps; null where none were given.
    """

    output: str
    compared: list[ComparedStep] | None


def resolution_summary(result: ResolutionResult) -> dict[str, Any]:
    """Return a result as the file has it, without its recordings."""
    return result.model_dump(mode="json", by_alias=True, exclude={"tests": {"__all__": {"staircase"}}})


def resolution_document(result: ResolutionResult, output: Path) -> dict[str, Any]:
    """Return what is said of a result that is written to a file."""
    return {"result": str(output), **resolution_summary(result)}


def prediction_document(
    predicted: PredictedResolution, compared: Sequence[Compared] | None, output: Path
) -> dict[str, Any]:
    """Return what is predicted, and how it compares with measured steps."""
    rows = None if compared is None else [_compared(one).json_object() for one in compared]
    summary = predicted.model_dump(mode="json", exclude={"least_steps": {"__all__": {"curve"}}})
    return {"output": str(output), **summary, "compared": rows}


def _compared(one: Compared) -> ComparedStep:
    return ComparedStep(
        pose=one.test.pose or "",
        direction=direction_word(one.test),
        predicted=None if one.predicted is None else one.predicted.lis,
        measured=None if one.test.lis is None else one.test.lis.value,
        inside=one.inside,
    )
