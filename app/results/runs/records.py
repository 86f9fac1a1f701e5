"""What runs say about devices, air and themselves."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from catseye.app.cell.model import Cell


@dataclass(frozen=True)
class DeviceRecord:
    """Device that answered.

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
    """One run that a report draws on.

    Attributes:
        name: name of the run.
        procedure: what was run.
        status: how it ended.
        started_utc: ISO 8601 UTC time.
        duration_s: from start to end, None when it is not known.
        points: measured distances or positions, None when it measures none.
        healed: how often links were healed.
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
    healed: int = 0
    software: str = ""
    versions: dict[str, str] = field(default_factory=dict)
    operator: str = ""
    files: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Measurement:
    """How it was measured, as the runs say it; empty for a result file.

    Attributes:
        runs: that a report draws on.
        cell: the configuration.
        origins: "file" or "default" for each dotted key of the configuration.
        searches: what reflector searches found, as their last step returns it; see `search_section`.
        warnings: of the plan: blind commands, planned breaks; and what could not be done.
        incidents: what disturbed it, in the words of the timeline.
        devices: who answered.
        environment: the air.
        compensation: sentences about what corrected the lengths for the air.
    """

    runs: Sequence[RunRecord] = ()
    cell: Cell | None = None
    origins: Mapping[str, str] = field(default_factory=dict)
    searches: Sequence[Mapping[str, Any]] = ()
    warnings: Sequence[str] = ()
    incidents: Sequence[str] = ()
    devices: Sequence[DeviceRecord] = ()
    environment: EnvironmentSummary | None = None
    compensation: Sequence[str] = ()


@dataclass(frozen=True)
class Sources:
    """What a report was made with and from.

    Attributes:
        versions: of what the program ran on, by name.
        digests: SHA-256 of result files, by name.
    """

    versions: Mapping[str, str] = field(default_factory=dict)
    digests: Mapping[str, str] = field(default_factory=dict)
