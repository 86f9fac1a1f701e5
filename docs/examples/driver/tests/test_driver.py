"""The driver and the emulator, over a socket."""

import asyncio
from contextlib import asynccontextmanager

import pytest
from norra_ld5.driver import NorraLd5
from norra_ld5.emulator import Display, listen

from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import RefusedError


@asynccontextmanager
async def connected(display):
    """Yield a driver that is connected to an emulated display."""
    async with await listen(display) as server:
        port = server.sockets[0].getsockname()[1]
        driver = NorraLd5.at(f"tcp://127.0.0.1:{port}", SystemClock(), answer_timeout_s=0.5)
        try:
            await driver.connect()
            yield driver
        finally:
            await driver.close()


def test_a_length_is_measured_from_the_zero():
    async def measure():
        display = Display()
        display.length_mm = 100.0
        async with connected(display) as driver:
            assert await driver.zero() == 1
            display.length_mm = 112.345678
            return await driver.read()

    reading = asyncio.run(measure())
    assert reading.displacement_mm == pytest.approx(12.345678, abs=1e-9)
    assert reading.zero_id == 1


def test_a_returning_beam_does_not_revive_the_count():
    async def lose():
        display = Display()
        async with connected(display) as driver:
            await driver.zero()
            display.interrupt()
            with pytest.raises(RefusedError, match="NO BEAM"):
                await driver.zero()
            display.restore()
            status = await driver.status()
            assert status.beam_ok
            assert status.beam_lost
            await driver.zero()
            assert not (await driver.status()).beam_lost

    asyncio.run(lose())
