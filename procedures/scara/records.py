"""What the procedures of a SCARA keep. Directions are states of approach, 1 or -1."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from catseye.procedures.kit.expanded import EXPANDED
from catseye.procedures.kit.records import Observation, Record, Row


@dataclass(frozen=True, kw_only=True)
class Distance(Record):
    """A distance to a reflector, relative to the zero of its segment."""

    table: ClassVar[str] = "points"
    is_point: ClassVar[bool] = True
    target_column: ClassVar[str] = "reflector"
    segment_column: ClassVar[str] = "segment"
    reflector: str
    segment: int
    theta1_deg: float
    theta2_deg: float
    j3_mm: float
    j4_deg: float
    reported1_deg: float
    reported2_deg: float
    reported3_mm: float
    reported4_deg: float
    direction1: int
    direction2: int
    displacement_mm: float
    spread_mm: float
    readings: int
    signal: float
    time_utc: str
    duration_s: float
    temperature_c: float | None = None
    pressure_hpa: float | None = None
    humidity_percent: float | None = None
    raw_displacement_mm: float | None = None
    refractive_index: float | None = None
    zero_refractive_index: float | None = None
    dead_path_mm: float | None = None
    formula: str | None = None
    mount_deg: float | None = None


@dataclass(frozen=True, kw_only=True)
class SeenReflector(Record):
    """The middle of the window of J4 in which a reflector returns the beam, and its edges."""

    table: ClassVar[str] = "search"
    reflector: str
    theta1_deg: float
    theta2_deg: float
    j4_deg: float | None = None
    lower_deg: float | None = None
    upper_deg: float | None = None
    signal: float | None = None


@dataclass(frozen=True, kw_only=True)
class PathPosition(Record):
    """A command of a path, and where an independent instrument saw the arm, in its own frame."""

    table: ClassVar[str] = "path"
    x_mm: float
    y_mm: float
    theta1_deg: float
    theta2_deg: float
    direction1: int
    direction2: int
    x_meas_mm: float | None = None
    y_meas_mm: float | None = None
    u_mm: float | None = None
    line: int | None = None


@dataclass(frozen=True, kw_only=True)
class RunOutReading(Record):
    """What an indicator read at an artefact that turns with a joint, and where that was come from.

    Attributes:
        joint: that turned.
        mounting: "direct", or "turned" by half a turn with the indicator on the other side.
        direction: in which the indicator reads, "x" or "y" of what carries the joint.
        approach: 1 where the joint came upwards, -1 downwards.
        zero: number of the zero of the indicators: a new one begins where they may have been moved.
        reading_um: more where the artefact is nearer.
    """

    table: ClassVar[str] = "run_out"
    is_point: ClassVar[bool] = True
    point_name: ClassVar[str] = "reading"
    target_column: ClassVar[str] = "joint"
    joint: str
    mounting: str
    direction: str
    approach: int
    cycle: int
    angle_deg: float
    reported_deg: float
    zero: int
    reading_um: float
    clock_s: float


@dataclass(frozen=True, kw_only=True)
class Overlap(Observation):
    """A point that was measured again in a new segment, which ties it to an earlier one; `extra` is the distance."""

    kind: ClassVar[str] = "overlap"
    change: ClassVar[tuple[str, float]] = ("difference_mm", 1e3)
    point: int
    previous_segment: int
    previous_displacement_mm: float
    previous_j4_deg: float
    difference_mm: float
    across_mm: float

    @classmethod
    def describe(cls, row: Row) -> str:
        """Return a stored one as a sentence."""
        return (
            f"{row.get('reflector')}: segment {row.get('segment')} tied to segment {row.get('previous_segment')} at "
            f"point {_point(row)}, measured again"
        )


@dataclass(frozen=True, kw_only=True)
class ClosureVisit(Observation):
    """A visit to the reference pose; `extra` is the distance there."""

    kind: ClassVar[str] = "closure"
    change: ClassVar[tuple[str, float]] = ("drift_um", 1.0)
    number: int
    point: int
    reference_displacement_mm: float
    overlaps: int
    drift_um: float

    @classmethod
    def describe(cls, row: Row) -> str:
        """Return a stored one as a sentence."""
        return (
            f"{row.get('reflector')}: closure visit {row.get('number')}, drift {_number(row, 'drift_um'):+.1f} µm "
            f"since point {_point(row)}"
        )


@dataclass(frozen=True, kw_only=True)
class Drift(Observation):
    """A distance at the reference pose of a warm-up."""

    kind: ClassVar[str] = "drift"
    reflector: str
    segment: int
    visit: int
    theta1_deg: float
    theta2_deg: float
    displacement_mm: float
    spread_mm: float
    temperature_c: float | None
    time_utc: str
    clock_s: float

    @classmethod
    def describe(cls, row: Row) -> str:
        """Return a stored one as a sentence."""
        return (
            f"{row.get('reflector')}: visit {row.get('visit')}, displacement "
            f"{_number(row, 'displacement_mm'):.4f} mm, air {_number(row, 'temperature_c'):.2f} °C"
        )


@dataclass(frozen=True, kw_only=True)
class Repeat(Observation):
    """A pose attained in a cycle."""

    kind: ClassVar[str] = "repeat"
    reflector: str
    segment: int
    cycle: int
    pose: int
    theta1_deg: float
    theta2_deg: float
    direction1: int
    direction2: int
    displacement_mm: float
    spread_mm: float
    signal: float
    temperature_c: float | None
    time_utc: str

    @classmethod
    def describe(cls, row: Row) -> str:
        """Return a stored one as a sentence."""
        return (
            f"{row.get('reflector')}: cycle {row.get('cycle')}, pose {row.get('pose')}, displacement "
            f"{_number(row, 'displacement_mm'):.4f} mm"
        )


@dataclass(frozen=True, kw_only=True)
class AlignmentRound(Observation):
    """How far the beam was off in a round, after an instruction was carried out."""

    kind: ClassVar[str] = "alignment"
    quantity: str
    value: float
    u: float
    unit: str
    round: int
    instruction: str

    @classmethod
    def describe(cls, row: Row) -> str:
        """Return a stored one as a sentence."""
        after = f" after: {row['instruction']}" if row.get("instruction") else ""
        return (
            f"alignment, round {row.get('round')}: {row.get('quantity')} {_number(row, 'value'):+.3g} ± "
            f"{EXPANDED * _number(row, 'u'):.2g} {row.get('unit', '')} (k = 2){after}"
        )

    @classmethod
    def summary(cls, rows: Sequence[Row]) -> list[str]:
        """Return each quantity before and after."""
        texts = []
        for quantity in dict.fromkeys(str(row.get("quantity")) for row in rows):
            own = [row for row in rows if str(row.get("quantity")) == quantity]
            unit = own[0].get("unit", "")
            texts.append(
                f"{quantity}: {_number(own[0], 'value'):+.3g} {unit} before, "
                f"{_number(own[-1], 'value'):+.3g} {unit} after {len(own)} round(s)"
            )
        return texts


@dataclass(frozen=True, kw_only=True)
class ScrewTurn(Observation):
    """A screw that an operator has turned; clockwise is positive."""

    kind: ClassVar[str] = "screw"
    screw: str
    turns: float
    round: int
    text: str

    @classmethod
    def describe(cls, row: Row) -> str:
        """Return a stored one as a sentence."""
        return str(row.get("text") or "")

    @classmethod
    def summary(cls, rows: Sequence[Row]) -> list[str]:
        """Return nothing: the rounds of the alignment say what came of it."""
        del rows
        return []


def _number(row: Row, key: str) -> float:
    value = row.get(key)
    return float(value) if isinstance(value, int | float) else float("nan")


def _point(row: Row) -> int:
    point = row.get("point")
    return (int(point) if isinstance(point, int | float) else 0) + 1
