"""What `catseye demo --json` writes: the files of a whole job, and its figures."""

from typing import Any

from catseye.app.results.document import Document
from catseye.app.results.scara.result import Fit


class IdentifiedValue(Document):
    """A parameter as it was identified, beside its true value."""

    name: str
    unit: str
    truth: float
    identified: float
    u: float


class ModelLeaves(Document):
    """What a model leaves on the validation path."""

    e_yy_rms_um: float
    e_xy_rms_um: float
    rms_2d_um: float
    max_um: float


class JobValidation(Document):
    """All models on the validation path; rows that were compared and left out."""

    models: dict[str, ModelLeaves]
    ratio: float | None
    compared: int
    left_out: int


class JobDocument(Document):
    """A job on an emulated bench.

    Attributes:
        runs: folders by procedure.
        run: folder of the measurement.
        report: its page.
        truth: file with the true arm.
        results: files by model.
        rms_normalised_error: of the identified values; about 1 when the uncertainties are honest.
    """

    runs: dict[str, str]
    run: str
    report: str
    truth: str
    results: dict[str, str]
    identified: list[IdentifiedValue]
    rms_normalised_error: float
    fit: Fit
    validation: JobValidation

    def json_object(self) -> dict[str, Any]:
        """Return it as JSON has it; what the fit does not state is left out."""
        return {**super().json_object(), "fit": self.fit.model_dump(mode="json", exclude_none=True)}
