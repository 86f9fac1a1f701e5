"""Distances that have settled, and what becomes of those that do not."""

from dataclasses import dataclass, field, replace

import pytest

from catseye.drivers.roles.interferometer import BeamStatus
from catseye.procedures.kit.beam.settled import Unsettled, settled_measurement
from catseye.procedures.kit.bench import Timing
from catseye.procedures.kit.context import Measurement
from tests.unit.procedures.benches import IdealContext

TIMING = Timing(settle_time_s=0.5, dwell_time_s=0.25, readings=4, spread_limit_mm=0.005)


@dataclass
class ShakingContext(IdealContext):
    """A bench whose readings scatter, or whose laser is not ready, for some measurements.

    Attributes:
        spreads_mm: of the coming measurements; 0.1 µm when they are used up.
        unready: so many looks see a laser that is not ready.
    """

    spreads_mm: list[float] = field(default_factory=list)
    unready: int = 0

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        measured = await super().measure(settle_time_s, dwell_time_s, readings)
        spread_mm = self.spreads_mm.pop(0) if self.spreads_mm else 1e-4
        ready = self.unready == 0
        return replace(measured, spread_mm=spread_mm, beam=replace(measured.beam, laser_ready=ready))

    async def beam(self) -> BeamStatus:
        self.unready = max(0, self.unready - 1)
        return replace(await super().beam(), laser_ready=self.unready == 0)


@pytest.fixture
async def bench() -> ShakingContext:
    made = ShakingContext(places={"P": (1000.0, 0.0)}, pose=(0.0, 0.0, 0.0, 0.0))
    await made.zero(450.0)
    return made


async def test_readings_that_scatter_are_taken_again_after_longer_settling(bench: ShakingContext) -> None:
    bench.spreads_mm = [0.02, 0.006, 0.004]
    measured = await settled_measurement(bench, TIMING, "P1/0000")
    assert isinstance(measured, Measurement)
    assert (measured.spread_mm, measured.beam.count_valid) == (0.004, True)
    assert [wait[0] for wait in bench.waits] == [0.5, 1.0, 2.0]
    assert [(live.value, live.high, live.accepted) for live in bench.shown] == [
        (20.0, 5.0, False),
        (6.0, 5.0, False),
    ]
    assert bench.prompts == []


@pytest.mark.parametrize(("answer", "spread_mm"), [("take", 0.03), ("skip", None)])
async def test_the_operator_decides_about_a_point_that_never_settles(
    bench: ShakingContext, answer: str, spread_mm: float | None
) -> None:
    bench.spreads_mm = [0.03] * 3
    bench.answers = {"unsettled/P1/0000/1": answer}
    measured = await settled_measurement(bench, TIMING, "P1/0000")
    assert (None if isinstance(measured, Unsettled) else measured.spread_mm) == spread_mm
    (prompt,) = bench.prompts
    assert "30.0 µm" in prompt.text
    # Nobody has to be there, and the run drives on after each of the answers.
    assert (prompt.safe_answer, prompt.motion, prompt.rests_after) == ("skip", True, ())
    assert bench.events == [("unsettled", {"where": "P1/0000", "spread_mm": 0.03, "answer": answer})]


async def test_measuring_again_asks_again_under_another_name(bench: ShakingContext) -> None:
    bench.spreads_mm = [0.03] * 6
    bench.answers = {"unsettled/x/1": "again", "unsettled/x/2": "skip"}
    assert isinstance(await settled_measurement(bench, TIMING, "x"), Unsettled)
    assert bench.measurements == 6


async def test_a_lost_beam_is_no_matter_of_settling(bench: ShakingContext) -> None:
    bench.spreads_mm = [0.03]
    bench.lost = True
    measured = await settled_measurement(bench, TIMING, "x")
    assert isinstance(measured, Measurement)
    assert not measured.beam.count_valid
    assert bench.measurements == 1


async def test_an_unready_laser_suspends_and_invalidates_the_count(bench: ShakingContext) -> None:
    bench.unready = 3
    measured = await settled_measurement(bench, TIMING, "x")
    assert isinstance(measured, Measurement)
    assert (measured.beam.laser_ready, measured.beam.count_valid) == (False, False)
    assert ["laser is not ready" in reason for reason in bench.suspensions] == [True]
    assert bench.unready == 0
