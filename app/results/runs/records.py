"""What runs say about devices, air and themselves."""

from dataclasses import dataclass, field


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
