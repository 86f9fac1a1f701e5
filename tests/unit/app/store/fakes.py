"""What the tests of the store share."""

from datetime import UTC, datetime, timedelta

from catseye.procedures.kit.records import Record, Row
from catseye.procedures.scara.records import Distance, Overlap, PathPosition, SeenReflector


class TickingClock:
    """A clock that goes on by a second whenever it is read."""

    def __init__(self) -> None:
        self.ticks = 0

    def monotonic_s(self) -> float:
        return float(self.ticks)

    def now_utc(self) -> datetime:
        self.ticks += 1
        return datetime(2026, 1, 2, tzinfo=UTC) + timedelta(seconds=self.ticks)

    async def sleep(self, duration_s: float) -> None:
        raise AssertionError(f"the store slept for {duration_s} s")


SEARCH_ROW: Row = {"reflector": "P1", "theta1_deg": 1.0, "theta2_deg": 2.0}
PATH_ROW: Row = {
    "x_mm": 1.0,
    "y_mm": 2.0,
    "theta1_deg": 3.0,
    "theta2_deg": 4.0,
    "direction1": 1,
    "direction2": -1,
}  # fmt: skip - one row a line

RECORDS: tuple[type[Record], ...] = (Distance, SeenReflector, PathPosition, Overlap)
"""Types of records for every table of a SCARA."""
