"""Measuring from a procedure: readings, air, zero, and what makes a count invalid."""

from pathlib import Path
from unittest.mock import patch

import pytest

from catseye.app.engine.host import run_procedure
from catseye.app.errors import (
    MeasurementRejectedError,
)
from catseye.app.exitcode import ExitCode
from catseye.app.store.reader import RunReader
from catseye.drivers.roles.interferometer import BeamStatus, LengthReading
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.records import Row
from tests.unit.app.engine.fakes import AWAY, FakeBench, Script, distance
from tests.unit.app.engine.given_parts import Parts


async def test_a_measurement_averages_readings_over_the_dwell(parts: Parts) -> None:
    parts.bench.robot.pose = AWAY
    await parts.ctx.zero(500.0)
    measured = await parts.ctx.measure(0.5, 0.8, 5)
    assert measured.displacement_mm == pytest.approx(3e-3)
    assert measured.spread_mm == pytest.approx(1.5811e-3, rel=1e-4)
    assert measured.duration_s == pytest.approx(0.8)
    assert measured.time_utc == "2026-01-02T03:04:05.500000+00:00"
    assert (measured.readings, measured.reported, measured.beam.signal) == (5, AWAY, 0.8)
    assert measured.beam.count_valid


@pytest.mark.parametrize(
    "beam",
    [
        BeamStatus(False, True, False, True, 0.0),
        BeamStatus(True, True, False, True, 0.8),
        BeamStatus(True, False, True, True, 0.8),
    ],
)
async def test_a_lost_count_stays_invalid_when_the_beam_returns(parts: Parts, beam: BeamStatus) -> None:
    await parts.ctx.zero(500.0)
    parts.bench.counter.beam = beam
    assert not (await parts.ctx.measure(0.5, 0.5, 2)).beam.count_valid


async def test_a_count_not_zeroed_by_this_process_is_invalid(parts: Parts) -> None:
    assert not (await parts.ctx.measure(0.5, 0.5, 2)).beam.count_valid


async def test_the_air_is_sampled_anew_when_it_is_old(parts: Parts) -> None:
    first = await parts.ctx.measure(0.1, 0.1, 1)
    again = await parts.ctx.measure(0.1, 0.1, 1)
    parts.bench.clock.advance(2.1)
    later = await parts.ctx.measure(0.1, 0.1, 1)
    assert [m.air.temperature_c for m in (first, again, later)] == [21.0, 21.0, 22.0]


async def test_software_time_is_what_is_neither_motion_nor_waiting(parts: Parts) -> None:
    async def action() -> Row:
        await parts.ctx.move(AWAY)
        await parts.ctx.measure(0.5, 0.5, 3)
        parts.ctx.record(distance())
        parts.bench.clock.advance(0.007)
        return {}

    await parts.ctx.step("s1", "first", action)
    (time,) = parts.ctx.step_times
    assert [time.motion_s, time.idle_s] == pytest.approx([1.0, 1.0])
    assert time.points == 1
    assert time.software_s == pytest.approx(0.007)


async def test_a_zero_is_stored(parts: Parts) -> None:
    await parts.ctx.zero(500.0)
    assert parts.reader.events()[-1].data == {"number": 1, "dead_path_mm": 500.0}


async def test_a_missing_quantity_warns_once_if_the_instrument_corrects(parts: Parts) -> None:
    parts.bench.air.pressure_hpa = None
    await parts.ctx.measure(0.1, 0.1, 1)
    await parts.ctx.measure(0.1, 0.1, 1)
    (warning,) = [event.data for event in parts.reader.events() if event.kind == "warning"]
    assert "gives no pressure" in str(warning["text"])


async def test_a_count_of_wavelengths_without_the_air_is_refused(tmp_path: Path) -> None:
    bench = FakeBench(tmp_path)
    bench.counter.compensated = "none"
    bench.air.pressure_hpa = None

    async def body(ctx: Context) -> None:
        await ctx.zero(500.0)

    outcome = await run_procedure(
        bench.request(Script(body)), bench.build, bench.clock, bench.publish, bench.install
    )
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.REJECTED)
    assert "no pressure" in outcome.text
    assert "program corrects" in str(RunReader(outcome.path).meta["compensation"])


async def test_a_count_is_invalid_after_zeroing_without_air_fails(tmp_path: Path) -> None:
    bench = FakeBench(tmp_path)
    bench.counter.compensated = "none"
    seen: list[bool] = []

    async def body(ctx: Context) -> None:
        await ctx.zero(500.0)
        seen.append((await ctx.measure(0.1, 0.1, 1)).beam.count_valid)
        bench.air.pressure_hpa = None
        bench.clock.advance(10.0)
        with pytest.raises(MeasurementRejectedError, match="no pressure"):
            await ctx.zero(600.0)
        bench.air.pressure_hpa = 1013.0
        bench.clock.advance(10.0)
        seen.append((await ctx.measure(0.1, 0.1, 1)).beam.count_valid)

    await run_procedure(bench.request(Script(body)), bench.build, bench.clock, bench.publish, bench.install)
    assert seen == [True, False]


async def test_a_reading_that_lost_a_digit_is_left_out(parts: Parts) -> None:
    readings = iter([1.2345] * 6 + [1.234] + [1.2345] * 3)

    async def read() -> LengthReading:
        value_mm = next(readings)
        return LengthReading(value_mm, f"{value_mm} mm", parts.bench.clock.monotonic_s())

    await parts.ctx.zero(500.0)
    with patch.object(parts.bench.counter, "read", read):
        measured = await parts.ctx.measure(0.5, 0.9, 10)
    assert measured.displacement_mm == pytest.approx(1.2345, abs=1e-9)
    assert measured.spread_mm == pytest.approx(0.0, abs=1e-9)
    assert measured.readings == 9
    (warning,) = [event.data for event in parts.reader.events() if event.kind == "warning"]
    assert str(warning["text"]).startswith("1 of 10 readings stands apart from the others: '1.234 mm'")
