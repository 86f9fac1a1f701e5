"""What a report is made from. Every part beyond the head is optional."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from catseye.app.cell.model import Cell
from catseye.app.results.runs.records import DeviceRecord, EnvironmentSummary, RunRecord
from catseye.app.results.scara.distance_validation import DistanceValidation
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.truth_tables import TruthTables
from catseye.app.results.scara.validation import PathValidation
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.procedures.scara.bench import ScaraBench


@dataclass(frozen=True)
class ReportContent:
    """Everything that a report shows.

    Attributes:
        title: heading.
        created_utc: ISO 8601 UTC time.
        software: name and version of the program.
        simulated: a device was an emulator; the page says so on top.
        cell: the configuration.
        origins: "file" or "default" for each dotted key of the configuration.
        bench: the bench as it was planned with, for the layout.
        results: identified models; of two of one kind the last counts.
        truth: what an emulated bench really is.
        validation: models on an independently measured path.
        lines: of the path's file, one a row; empty for a run.
        distances: models on a path that the interferometer measured.
        diagnosis: what speaks for and against the error map.
        search: what searches found, as the search's last step returns it: `reflectors` (`name`, `x_mm`, `y_mm`,
            `u_x_mm`, `u_y_mm`, `u_aim_mm`), `theta40_deg`, `u_theta40_deg`, `rms_deg`.
        warnings: sentences of the plan: blind commands, planned breaks.
        events: sentences about what happened: beam losses, interruptions.
        devices: who answered.
        environment: the air.
        compensation: sentences about who corrected the lengths for the air.
        runs: runs that it was made from.
        versions: of what the program ran on when it made the page, by name.
        digests: SHA-256 of result files that it was made from, by name.
        unverified: what speaks against runs that were changed after their end; the page says so on top.
    """

    title: str
    created_utc: str
    software: str
    simulated: bool
    cell: Cell | None = None
    origins: Mapping[str, str] = field(default_factory=dict)
    bench: ScaraBench | None = None
    results: Sequence[Result] = ()
    truth: TruthTables | None = None
    validation: PathValidation | None = None
    lines: Sequence[int] = ()
    distances: DistanceValidation | None = None
    diagnosis: Diagnosis | None = None
    search: Sequence[Mapping[str, Any]] = ()
    warnings: Sequence[str] = ()
    events: Sequence[str] = ()
    devices: Sequence[DeviceRecord] = ()
    environment: EnvironmentSummary | None = None
    compensation: Sequence[str] = ()
    runs: Sequence[RunRecord] = ()
    unverified: Sequence[str] = ()
    versions: dict[str, str] = field(default_factory=dict)
    digests: dict[str, str] = field(default_factory=dict)

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
