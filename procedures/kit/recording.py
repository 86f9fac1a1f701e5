"""A recording: every reading of the length counter over a time, kept as it comes while the arm moves or rests."""

from dataclasses import dataclass
from typing import ClassVar, Literal, Protocol

from catseye.procedures.kit.records import Record

Method = Literal["streamed", "polled"]
"""Readings came by themselves, or each was asked for."""


@dataclass(frozen=True, kw_only=True)
class Recorded(Record):
    """A recording that came to its end; its readings are in the run's chunks under the same step, attempt and name.

    A reading is kept as the instrument gave it. Corrected for the air it is `scale` times that plus `offset_mm`.

    Attributes:
        name: of the recording, unique in its step.
        method: how the readings came.
        origin_utc: ISO 8601 UTC time of the origin of their times.
        origin_clock_s: bench seconds at the origin, of the process that recorded.
        readings: how many there are.
        chunks: in how many chunks they are.
        crc32: check sum of all chunks in their order.
        duration_s: from the first to the last reading.
        rate_hz: mean rate between them.
        asked_hz: rate that was asked for; None where the instrument sets it.
        jitter_s: standard deviation of the time between two readings.
        longest_gap_s: between two readings.
        late: readings that were asked for and came more than half a period after they were due; 0 of a stream.
        lost: readings that were due and never came; 0 of a stream, which says it by `values_lost` or by a gap.
        beam_lost: 1 when the beam was interrupted at any time since the last zero.
        overspeed: 1 when the length changed faster than the counter counts.
        values_lost: 1 when the instrument says that values did not arrive.
        numbered: 1 when it numbers its values, so that none can be missing unnoticed.
        scale: of a reading, corrected for the air.
        offset_mm: of a reading, corrected for the air.
    """

    table: ClassVar[str] = "recordings"
    name: str
    method: str
    origin_utc: str
    origin_clock_s: float
    readings: int
    chunks: int
    crc32: int
    duration_s: float
    rate_hz: float
    asked_hz: float | None = None
    jitter_s: float
    longest_gap_s: float
    late: int
    lost: int
    beam_lost: int
    overspeed: int
    values_lost: int
    numbered: int | None = None
    scale: float
    offset_mm: float


class Recording(Protocol):
    """A recording under way."""

    @property
    def name(self) -> str:
        """Unique in its step."""
        ...

    @property
    def readings(self) -> int:
        """How many came so far."""
        ...

    @property
    def elapsed_s(self) -> float:
        """Time since its origin, s."""
        ...

    def at(self, clock_s: float) -> float:
        """Return a time of the bench's clock as one of the recording, s since its origin."""
        ...

    def newest(self, count: int) -> list[tuple[float, float]]:
        """Return the newest readings, oldest first, each as time, s, and displacement, mm, as the instrument gave it.

        Args:
            count: at most so many; what has been stored already may be missing.
        """
        ...
