"""STOP on the emulated controller: whatever its connections do, and however it hears."""

import asyncio
import contextlib
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

import pytest

from catseye.app.testing.proxy import Proxy
from catseye.drivers.links.endpoint import TcpEndpoint, parse_endpoint
from catseye.drivers.links.inbox import TURN_BYTES
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import DeviceError, LinkError
from catseye.simulators.config import EmulatedDevice, EmulationConfig, ErrorBudget, Option, ReflectorPlace
from catseye.simulators.emulated_bench import EmulatedBench

FAR = (150.0, 0.0, 0.0, 0.0)
SLOW = EmulationConfig(reflectors=(ReflectorPlace("P1", 650.0, -400.0),), budget=ErrorBudget.none())


@asynccontextmanager
async def emulated(**options: Option) -> AsyncIterator[tuple[EmulatedBench, str]]:
    """An emulated controller and where it listens."""
    config = replace(SLOW, devices=(EmulatedDevice("robot", "melfa-r3", options=options),))
    async with EmulatedBench(config) as bench:
        yield bench, bench.endpoints[0].endpoint


@asynccontextmanager
async def ready(robot: MelfaR3) -> AsyncIterator[MelfaR3]:
    """A robot that may move, slowly."""
    await robot.connect()
    try:
        await robot.servo(on=True)
        await robot.set_override(5.0)
        yield robot
    finally:
        await robot.close()


@asynccontextmanager
async def moving(bench: EmulatedBench, robot: MelfaR3) -> AsyncIterator[None]:
    """A motion of many seconds is under way."""
    motion = asyncio.create_task(robot.move_joints(FAR))
    while not bench.bench.moving:  # noqa: ASYNC110  # the bench has no event for it
        await asyncio.sleep(0.001)
    try:
        yield
    finally:
        motion.cancel()
        with contextlib.suppress(DeviceError, asyncio.CancelledError):
            await motion


@pytest.mark.parametrize("overtakes", [False, True])
async def test_the_arm_stops_however_the_controller_hears(overtakes: bool) -> None:
    async with emulated(stop_overtakes=overtakes) as (bench, endpoint), ready(robot_at(endpoint)) as robot:
        async with moving(bench, robot):
            await robot.stop()
            assert not bench.bench.moving
        assert robot.notes == ()


async def test_two_connections_are_enough_to_stop() -> None:
    async with emulated(clients=2) as (bench, endpoint), ready(robot_at(endpoint)) as robot:
        assert "no third connection for questions during motion" in robot.notes[0]
        async with moving(bench, robot):
            assert (await robot.status()).running
            await robot.stop()
            assert not bench.bench.moving


async def test_one_connection_is_enough_to_stop() -> None:
    async with emulated(clients=1) as (bench, endpoint), ready(robot_at(endpoint)) as robot:
        assert "no second connection for STOP" in robot.notes[0]
        async with moving(bench, robot):
            await robot.stop()
            assert not bench.bench.moving


@pytest.mark.parametrize("flood", [b"\r\n", b"\xff garbage \x00", b"QoK\r"])
async def test_a_flood_on_every_connection_does_not_delay_stop(flood: bytes) -> None:
    async with emulated() as (bench, endpoint):
        target = parse_endpoint(endpoint)
        assert isinstance(target, TcpEndpoint)
        proxy = Proxy((target.host, target.port))
        async with proxy.serving(), ready(robot_at(proxy.endpoint)) as robot, moving(bench, robot):
            proxy.flood = flood
            while proxy.flooded_bytes < 4 * TURN_BYTES:  # noqa: ASYNC110  # the proxy has no event for it
                await asyncio.sleep(0)
            with contextlib.suppress(LinkError):
                await robot.stop()
            assert not bench.bench.moving
            proxy.flood = b""


def robot_at(endpoint: str) -> MelfaR3:
    """A driver for the emulated controller."""
    return MelfaR3.at(endpoint, SystemClock())
