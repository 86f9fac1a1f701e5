"""What a report is made from. Every part beyond the head is optional."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from catseye.app.analysis.distance_validation import DistanceValidation
from catseye.app.analysis.validation import PathValidation
from catseye.app.cell.model import Cell
from catseye.app.files.result_json import Result
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.procedures.kit.bench import Bench

MODEL_TITLES = {"conventional": "conventional model", "error-map": "error map"}
"""What a reader calls the models."""


@dataclass(frozen=True)
class TruthMap:
    """The true bidirectional map of one joint; its nodes may be finer than those of a result.

    Attributes:
        node_deg: command angles, strictly increasing.
        positive_mdeg: deviation when approached upwards.
        negative_mdeg: deviation when approached downwards.
    """

    node_deg: Sequence[float]
    positive_mdeg: Sequence[float]
    negative_mdeg: Sequence[float]

    def at(self, node_deg: Sequence[float], direction: int) -> Floats:
        """Return the deviation at command angles, mdeg; NaN beyond the nodes. The direction is 1 or -1."""
        table = self.positive_mdeg if direction > 0 else self.negative_mdeg
        return np.interp(node_deg, self.node_deg, table, left=np.nan, right=np.nan)


@dataclass(frozen=True)
class TruthTables:
    """What an emulated bench really is, in the gauge of the error map.

    Attributes:
        link1_mm: length of link 1.
        link2_mm: length of link 2.
        theta1_map: map of J1.
        theta2_map: map of J2.
        reflectors_mm: x and y by name.
    """

    link1_mm: float
    link2_mm: float
    theta1_map: TruthMap
    theta2_map: TruthMap
    reflectors_mm: Mapping[str, tuple[float, float]]


@dataclass(frozen=True)
class DeviceRecord:
    """Who answered.

    Attributes:
        name: what it is on the bench: robot, interferometer, environment.
        model: as it calls itself.
        firmware: version.
        serial: serial number.
        endpoint: where it was connected.
        simulated: it is an emulator.
    """

    name: str
    model: str
    firmware: str
    serial: str
    endpoint: str
    simulated: bool


@dataclass(frozen=True)
class Spread:
    """Smallest, mean and largest value of a quantity."""

    lowest: float
    mean: float
    highest: float


@dataclass(frozen=True)
class EnvironmentSummary:
    """The air over the run; None where it was not measured."""

    temperature_c: Spread | None = None
    pressure_hpa: Spread | None = None
    humidity_percent: Spread | None = None


@dataclass(frozen=True)
class RunRecord:
    """One run that the report draws on.

    Attributes:
        name: name of the run.
        procedure: what was run.
        status: how it ended.
        started_utc: ISO 8601 UTC time.
        duration_s: from start to end, None when it is not known.
        points: measured distances or positions, None when it measures none.
        software: name and version of the program that measured.
        versions: of what it ran on, by name.
        operator: who started it.
        files: SHA-256 of its sealed files, by name; empty when it is not sealed.
    """

    name: str
    procedure: str
    status: str
    started_utc: str
    duration_s: float | None = None
    points: int | None = None
    software: str = ""
    versions: dict[str, str] = field(default_factory=dict)
    operator: str = ""
    files: dict[str, str] = field(default_factory=dict)


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
    bench: Bench | None = None
    results: Sequence[Result] = ()
    truth: TruthTables | None = None
    validation: PathValidation | None = None
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
    def best(self) -> Result | None:
        """The error map, or what there is."""
        return self.error_map or self.conventional

    def _last(self, model: str) -> Result | None:
        return next((result for result in reversed(self.results) if result.model == model), None)
