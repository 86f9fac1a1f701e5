"""What goes wrong on the bench: overspeed, vibration, an unlocked laser, dirt, a slipped joint."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.simulators.counter.line_protocol import CounterSession
from catseye.simulators.errors import BenchError
from catseye.simulators.lasertex.hpi import Hpi
from catseye.simulators.lengths import Lengths
from catseye.simulators.world.air_probe import AirProbe
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.instrument import Instrument
from tests.unit.simulators.benches import QUIET, go, quiet_bench

HALF_WAVE_MM = 316.5e-6

_FLAGS = 3 + 10
"""Place of the flags in an HPI's frame: three bytes of head before; bit 0: laser ready, bit 3: good signal."""


def zeroed() -> tuple[Bench, Instrument]:
    """Return the straight arm that looks at P2, 130 mm away, and an instrument that is zeroed there."""
    bench = quiet_bench()
    instrument = Instrument(bench)
    assert instrument.zero()
    return bench, instrument


def test_an_overspeed_is_latched_by_every_counter_and_costs_fringes() -> None:
    bench, instrument = zeroed()
    assert bench.beam.zero()
    bench.beam.outrun_counters()
    for reading in (bench.beam.read(), instrument.read()):
        assert reading.overspeed
        assert reading.returns
        assert not reading.beam_lost
        fringes = reading.displacement_mm / HALF_WAVE_MM
        assert fringes == pytest.approx(round(fringes), abs=1e-6)
        assert 1 <= abs(round(fringes)) < 100
        assert reading.vacuum_mm == pytest.approx(reading.displacement_mm, abs=1e-9)
    assert instrument.overspeed_count == 1
    assert instrument.zero()
    assert not instrument.read().overspeed
    assert instrument.read().displacement_mm == 0.0


def test_without_a_beam_there_is_no_count_to_lose() -> None:
    bench, instrument = zeroed()
    bench.beam.block(None)
    with pytest.raises(BenchError, match="aim at a reflector"):
        bench.beam.outrun_counters()
    assert not instrument.read().overspeed


def test_readings_scatter_while_the_arm_is_shaken() -> None:
    bench, instrument = zeroed()
    bench.shake(0.020, 3.0)
    bench.advance(1.0)
    values = []
    for _ in range(1000):
        bench.advance(0.001)
        values.append(instrument.read().displacement_mm)
    # A circle of 20 µm seen from its side, after 12 time constants of 0.08 s.
    assert np.std(values) == pytest.approx(0.020 / math.sqrt(2.0), rel=0.02)
    assert max(values) == pytest.approx(0.020, rel=0.01)
    bench.advance(1.0 + 12 * 0.08)
    assert abs(instrument.read().displacement_mm) < 0.020 * math.exp(-11.0)


def test_shaking_continues_through_a_motion() -> None:
    bench, instrument = zeroed()
    bench.shake(0.020, 10.0)
    bench.advance(1.0)
    go(bench, (0.0, 0.0, 0.0, 0.1))
    go(bench, (0.0, 0.0, 0.0, 0.0))
    values = []
    for _ in range(200):
        bench.advance(0.005)
        values.append(instrument.read().displacement_mm)
    assert np.std(values) == pytest.approx(0.020 / math.sqrt(2.0), rel=0.05)


@pytest.mark.parametrize("steps", [1, 37])
def test_shaking_breaks_a_marginal_beam_between_readings(steps: int) -> None:
    # 0.95 mm of a miss and 0.1 mm of shaking are more than the acceptance; 0.04 mm are not.
    for amplitude_mm, breaks in ((0.1, True), (0.04, False)):
        bench = quiet_bench(replace(QUIET, beam_offset_mm=0.95))
        assert bench.beam.zero()
        bench.advance(100.0)
        bench.shake(amplitude_mm, 1.0)
        for _ in range(steps):
            bench.advance(30.0 / steps)
        assert bench.beam.read().returns
        assert bench.beam.read().beam_lost is breaks


def test_an_unlocked_laser_voids_the_count_and_refuses_zero() -> None:
    bench, instrument = zeroed()
    bench.beam.set_laser(ready=False)
    reading = instrument.read()
    assert (reading.returns, reading.laser_ready, reading.beam_lost, reading.counts) == (
        True,
        False,
        True,
        False,
    )
    assert not instrument.zero()
    late = Instrument(bench)
    assert not late.read().laser_ready
    bench.beam.set_laser(ready=True)
    assert instrument.read().laser_ready
    assert instrument.read().beam_lost
    assert abs(instrument.read().displacement_mm) >= 0.99 * HALF_WAVE_MM
    assert instrument.zero()
    assert not instrument.read().beam_lost


def test_a_laser_that_is_ready_already_loses_nothing() -> None:
    bench, instrument = zeroed()
    bench.beam.set_laser(ready=True)
    assert not instrument.read().beam_lost
    assert instrument.read().displacement_mm == 0.0


def test_instruments_knowing_the_laser_state_report_it() -> None:
    bench, instrument = zeroed()
    line = CounterSession(instrument, lambda _text: None)
    hpi = Hpi(instrument, AirProbe(bench), Lengths(compensated=True))

    def reported() -> tuple[int, bool]:
        line.feed(b"S\r")
        answer = line.answer()
        assert isinstance(answer, bytes)
        # Bit 4 of the line counter's status.
        return int(answer, 16), bool(hpi.distance()[_FLAGS] & 0x01)

    assert reported() == (0x10, True)
    bench.beam.set_laser(ready=False)
    assert reported() == (0x01, False)
    bench.beam.set_laser(ready=True)
    assert reported() == (0x11, True)


def test_locking_again_restores_a_cleared_flag() -> None:
    bench, instrument = zeroed()
    hpi = Hpi(instrument, AirProbe(bench), Lengths(compensated=True))
    bench.beam.set_laser(ready=False)
    hpi.zero()
    bench.beam.set_laser(ready=True)
    assert not hpi.distance()[_FLAGS] & 0x08
    hpi.zero()
    assert hpi.distance()[_FLAGS] & 0x08


def test_dirt_weakens_the_signal_and_narrows_what_returns() -> None:
    # exp(-2 m²) · 0.5 = exp(-2) at m = sqrt(1 - ln 2 / 2) = 0.8084 mm.
    for miss_mm, returns in ((0.80, True), (0.82, False)):
        bench = quiet_bench(replace(QUIET, beam_offset_mm=miss_mm))
        assert bench.beam.zero()
        bench.beam.weaken(0.5)
        assert bench.beam.read().returns is returns
        assert bench.beam.read().beam_lost is not returns
    bench, _ = zeroed()
    bench.beam.weaken(0.5)
    assert bench.beam.read().level == pytest.approx(0.5, abs=0.02)
    bench.beam.weaken(0.13)
    assert not bench.beam.read().returns
    bench.beam.weaken(1.0)
    assert bench.beam.read().level == pytest.approx(1.0, abs=0.02)


def test_a_slipping_joint_misses_once_and_the_encoder_shows() -> None:
    bench = quiet_bench()
    bench.slip(1, 0.4)
    go(bench, (10.0, 20.0, 0.0, 30.0))
    assert bench.joints == pytest.approx((10.4, 20.0, 0.0, 30.0))
    assert bench.true_state().joints == pytest.approx(bench.joints)
    go(bench, (10.0, 20.0, 0.0, 30.0))
    assert bench.joints == pytest.approx((10.0, 20.0, 0.0, 30.0))


def test_a_way_slips_at_its_end() -> None:
    bench = quiet_bench()
    bench.slip(4, -0.25)
    bench.follow(np.array([1.0, 2.0]), np.array([[5.0, 0.0, 0.0, 0.0], [10.0, 0.0, 0.0, 0.0]]))
    bench.advance(1.0)
    assert bench.joints == pytest.approx((5.0, 0.0, 0.0, 0.0))
    bench.advance(1.0)
    assert bench.joints == pytest.approx((10.0, 0.0, 0.0, -0.25))


def test_everything_that_goes_on_ends_together() -> None:
    bench, instrument = zeroed()
    bench.beam.block(None)
    bench.beam.weaken(0.2)
    bench.shake(0.05, 1000.0)
    bench.slip(1, 1.0)
    bench.beam.set_laser(ready=False)
    bench.advance(1.0)
    bench.clear_faults()
    bench.advance(2.0)
    assert instrument.zero()
    bench.advance(0.01)
    reading = instrument.read()
    assert reading.counts
    assert reading.level == pytest.approx(1.0, abs=0.02)
    assert reading.displacement_mm == pytest.approx(0.0, abs=1e-9)
    go(bench, (1.0, 0.0, 0.0, 0.0))
    assert bench.joints[0] == pytest.approx(1.0)
