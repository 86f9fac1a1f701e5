"""What holds for every interferometer: a returning beam never revives an old count, a new link neither."""

import re
from collections.abc import Callable
from itertools import count
from typing import Any

import pytest

from catseye.app.testing.memory import pipe
from catseye.drivers.attocube.ids import AttocubeIds, IdsSettings
from catseye.drivers.counter.counter import LineCounter
from catseye.drivers.counter.profile import load_profile
from catseye.drivers.heidenhain.nd import HeidenhainNd, NdSettings
from catseye.drivers.lasertex.hpi import HpiSettings, LasertexHpi
from catseye.drivers.umd.display import UmdDisplay, UmdSettings
from catseye.simulators.config import Option
from catseye.simulators.errors import EmulatorError
from catseye.simulators.world.instrument import Instrument
from tests.unit.drivers.interferometers.pairs import Make, Pair, new_session, paired, quiet_world
from tests.unit.drivers.peers import StepClock
from tests.unit.drivers.virtual_time import run
from tests.unit.simulators.benches import aimed, driven_mm, go

DRIVERS: dict[str, Make] = {
    "line-counter": lambda transport, clock: LineCounter(
        transport, clock, load_profile("default"), quiet_s=0.001
    ),
    "lasertex-hpi": lambda transport, clock: LasertexHpi(transport, clock, HpiSettings(timeout_s=0.5)),
    "heidenhain-nd": lambda transport, clock: HeidenhainNd(transport, clock, NdSettings(quiet_s=0.001)),
    "attocube-ids": lambda transport, clock: AttocubeIds(transport, clock, IdsSettings(quiet_s=0.001)),
    "umd": lambda transport, clock: UmdDisplay(transport, clock, UmdSettings(timeout_s=0.5)),
}

OPTIONS: dict[str, dict[str, Option]] = {"attocube-ids": {"start_time_s": 0}}

MISHAPS: dict[str, Callable[[bytes], bytes]] = {
    "lost": lambda _data: b"",
    "doubled": lambda data: data + data,
    "garbled": lambda data: bytes([data[0] ^ 0x80]) + data[1:],
}

ANSWERS = 14
"""More than any of these drivers takes for a zero after a lost beam."""

every_interferometer = pytest.mark.parametrize("protocol", sorted(DRIVERS))


async def seen(pair: Pair) -> Any:
    await pair.driver.read()
    return await pair.driver.status()


@every_interferometer
async def test_a_returning_beam_does_not_revive_the_count(protocol: str) -> None:
    async with paired(protocol, DRIVERS[protocol], OPTIONS.get(protocol)) as pair:
        assert await pair.driver.zero() == 1
        status = await seen(pair)
        assert (status.beam_ok, status.beam_lost, status.overspeed) == (True, False, False)
        assert status.zero_id == 1
        assert 0.0 < status.signal <= 1.0
        pair.bench.beam.block(None)
        assert not (await seen(pair)).beam_ok
        pair.bench.beam.unblock()
        status = await seen(pair)
        assert (status.beam_ok, status.beam_lost) == (True, True)
        assert await pair.driver.zero() == 2
        status = await seen(pair)
        assert (status.beam_ok, status.beam_lost) == (True, False)


@every_interferometer
async def test_zero_and_way(protocol: str) -> None:
    async with paired(protocol, DRIVERS[protocol], OPTIONS.get(protocol)) as pair:
        await pair.driver.zero()
        assert abs((await pair.driver.read()).displacement_mm) < 1e-3
        way_mm = driven_mm(pair.bench, aimed(20.01, 30.01))
        reading = await pair.driver.read()
        assert reading.displacement_mm == pytest.approx(way_mm, rel=1e-3, abs=1.1e-3)
        assert reading.zero_id == 1
        assert not (await pair.driver.status()).beam_lost


def spoilt(place: int, mishap: str) -> Callable[[bytes], bytes]:
    """Return what spoils one answer of all that follow."""
    places = count()
    return lambda data: MISHAPS[mishap](data) if next(places) == place else data


@every_interferometer
async def test_the_number_times_its_step_is_the_displacement(protocol: str) -> None:
    async with paired(protocol, DRIVERS[protocol], OPTIONS.get(protocol)) as pair:
        reading = await pair.driver.read()
        (number, *_) = re.findall(r"[+-]?[\d.]+", reading.raw.replace(" ", "").partition("x")[0])
        assert float(number) * pair.driver.count_mm == pytest.approx(reading.displacement_mm, abs=1e-6)


@pytest.mark.parametrize(
    "made",
    [
        lambda link, clock: HeidenhainNd(link, clock, NdSettings(sign=-1)),
        lambda link, clock: LasertexHpi(link, clock, HpiSettings(sign=-1)),
        lambda link, clock: AttocubeIds(link, clock, IdsSettings(sign=-1)),
        lambda link, clock: UmdDisplay(link, clock, UmdSettings(sign=-1)),
    ],
)
def test_a_number_that_falls_has_a_negative_step(made: Make) -> None:
    assert made(pipe("memory://counter")[0], StepClock()).count_mm < 0.0


@pytest.mark.parametrize("mishap", MISHAPS)
@pytest.mark.parametrize(
    ("protocol", "make"),
    [
        *((protocol, DRIVERS[protocol]) for protocol in ("line-counter", "heidenhain-nd", "attocube-ids")),
        ("heidenhain-nd", lambda t, c: HeidenhainNd(t, c, NdSettings(quiet_s=0.001, zero="keys"))),
    ],
)
def test_any_one_spoilt_answer_leaves_a_zero_whole(protocol: str, make: Make, mishap: str) -> None:
    async def zeroed(place: int) -> None:
        async with paired(protocol, make, OPTIONS.get(protocol)) as pair:
            pair.bench.beam.block(None)
            await seen(pair)
            pair.bench.beam.unblock()
            pair.far.passed = spoilt(place, mishap)
            await pair.driver.status()
            assert await pair.driver.zero() == 1
            way_mm = driven_mm(pair.bench, aimed(20.01, 30.01))
            reading = await pair.driver.read()
            assert reading.displacement_mm == pytest.approx(way_mm, rel=1e-3, abs=1.1e-3)

    for place in range(ANSWERS):
        run(zeroed(place))


@every_interferometer
async def test_a_count_before_a_new_link_is_not_trusted(protocol: str) -> None:
    async with paired(protocol, DRIVERS[protocol], OPTIONS.get(protocol)) as pair:
        await pair.driver.zero()
        await pair.far.far.close()
        await pair.far.far.open()
        assert (await seen(pair)).beam_lost
        await pair.driver.zero()
        assert not (await seen(pair)).beam_lost


@every_interferometer
async def test_the_instruments_on_one_beam_have_their_own_zeros(protocol: str) -> None:
    async with paired(protocol, DRIVERS[protocol], OPTIONS.get(protocol)) as pair:
        await pair.driver.zero()
        other = Instrument(pair.bench)
        go(pair.bench, aimed(20.01, 30.01))
        pair.bench.advance(0.01)
        shown_mm = (await pair.driver.read()).displacement_mm
        assert other.zero()
        assert (await pair.driver.read()).displacement_mm == pytest.approx(shown_mm, abs=1e-6)
        assert pair.bench.beam.read().zero_id == 0


@pytest.mark.parametrize(
    ("protocol", "option", "value"),
    [
        ("attocube-ids", "axis", 3),
        ("attocube-ids", "dialect", "new"),
        ("attocube-ids", "ecu_enabled", 1),
        ("heidenhain-nd", "decimals", 0.5),
        ("lasertex-hpi", "signal_full_scale", 300),
        ("lasertex-hpi", "sign", 2),
        ("lasertex-hpi", "compensated", "both"),
        ("umd", "multiplier", 3),
        ("umd", "rate_hz", "fast"),
    ],
)
def test_wrong_options_of_an_emulator_are_named(protocol: str, option: str, value: Option) -> None:
    with pytest.raises(EmulatorError, match=option):
        new_session(quiet_world(), protocol, {option: value})


@pytest.mark.parametrize("protocol", ["lasertex-hpi", "umd"])
async def test_listeners_receive_each_streamed_value_as_it_is_read(protocol: str) -> None:
    async with paired(protocol, DRIVERS[protocol]) as pair:
        seen_values: list[tuple[float, float]] = []
        pair.driver.listen(lambda time_s, displacement_mm: seen_values.append((time_s, displacement_mm)))
        await pair.driver.zero()
        go(pair.bench, aimed(20.01, 30.01))
        for _ in range(5):
            reading = await pair.driver.read()
            assert seen_values[-1] == (reading.time_s, reading.displacement_mm)
        assert abs(seen_values[0][1]) < abs(seen_values[-1][1])
        assert len(seen_values) >= 6
