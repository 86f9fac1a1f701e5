"""Interferometers over emulated serial lines: each driver on its own pseudo-terminal, with the line's byte time."""

from pathlib import Path
from typing import Any

import pytest

from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.registry import load_driver
from catseye.simulators.config import EmulatedDevice, EmulationConfig, ErrorBudget
from catseye.simulators.emulated_bench import EmulatedBench
from tests.unit.simulators.benches import P2, aimed

LINES = {
    "heidenhain-nd": "baud=9600&bits=7&parity=E&stopbits=2",
    "lasertex-hpi": "baud=3000000",
    "umd": "baud=3000000",
    "line-counter": "baud=9600",
}


@pytest.mark.parametrize("protocol", sorted(LINES))
async def test_an_interferometer_over_a_serial_line(protocol: str, tmp_path: Path) -> None:
    endpoint = f"serial://{tmp_path}/line?{LINES[protocol]}"
    config = EmulationConfig(
        reflectors=(P2,),
        devices=(EmulatedDevice("interferometer", protocol, endpoint),),
        start_joints=aimed(20.0, 30.0),
        # The true place of the reflector is some millimetres off.
        acceptance_mm=60.0,
        budget=ErrorBudget.none(),
    )
    async with EmulatedBench(config) as bench:
        driver: Any = load_driver(protocol).at(endpoint, SystemClock())
        identity = await driver.connect()
        assert identity.simulated
        assert await driver.zero() == 1
        assert abs((await driver.read()).displacement_mm) < 1e-3
        bench.bench.beam.block(None)
        await driver.read()
        assert not (await driver.status()).beam_ok
        bench.bench.beam.unblock()
        await driver.read()
        status = await driver.status()
        assert (status.beam_ok, status.beam_lost) == (True, True)
        assert await driver.zero() == 2
        assert not (await driver.status()).beam_lost
        await driver.close()
