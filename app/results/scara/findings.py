"""What is known about an arm: identified models, and what they were checked against."""

from collections.abc import Sequence
from dataclasses import dataclass

from catseye.app.results.model import Section
from catseye.app.results.scara.distance_validation import DistanceValidation
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.truth_tables import TruthTables
from catseye.app.results.scara.validation import PathValidation
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.procedures.scara.bench import ScaraBench


@dataclass(frozen=True)
class Findings:
    """Everything that was computed; what there is none of is left out of a report.

    Attributes:
        results: identified models; of two of one kind the last counts.
        bench: the bench as it was planned with.
        truth: what an emulated bench really is.
        validation: models on an independently measured path.
        lines: of the path's file, one a row; empty for a run.
        distances: models on a path that the interferometer measured.
        diagnosis: what speaks for and against the error map.
        progress: what became of the commands of a measurement; None where there is none.
        found: sections of what a run has found without any identification, each with its verdict.
    """

    results: Sequence[Result] = ()
    bench: ScaraBench | None = None
    truth: TruthTables | None = None
    validation: PathValidation | None = None
    lines: Sequence[int] = ()
    distances: DistanceValidation | None = None
    diagnosis: Diagnosis | None = None
    progress: Section | None = None
    found: Sequence[Section] = ()

    @property
    def conventional(self) -> Result | None:
        """The conventional model."""
        return self._last("conventional")

    @property
    def error_map(self) -> Result | None:
        """The error map."""
        return self._last("error-map")

    @property
    def models(self) -> list[Result]:
        """The conventional model and the error map, as far as they are there."""
        return [result for result in (self.conventional, self.error_map) if result is not None]

    @property
    def best(self) -> Result | None:
        """The error map, or what there is."""
        return self.error_map or self.conventional

    def _last(self, model: str) -> Result | None:
        return next((result for result in reversed(self.results) if result.model == model), None)
