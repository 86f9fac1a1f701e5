"""Drivers of data link and real-time control against the emulators over sockets: stop, cancel, alarm, go on."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

import pytest

from catseye.drivers.melfa.datalink.robot import MelfaDatalink
from catseye.drivers.melfa.mxt.robot import MelfaMxt
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import AlarmError, DeviceError, NotReadyError
from catseye.drivers.roles.pose import Pose
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.emulated_bench import EmulatedBench
from tests.patience import HANG_S
from tests.unit.simulators.benches import QUIET

SPEED = 5.0
WAY: tuple[Pose, ...] = ((20.0, 10.0, 0.0, -20.0), (40.0, 20.0, 0.0, -45.0), (60.0, 30.0, 0.0, -70.0))
CONFIG = replace(
    QUIET,
    speed=SPEED,
    devices=(
        EmulatedDevice("robot", "melfa-r3"),
        EmulatedDevice("robot", "melfa-datalink", options={"number_format": "exponent"}),
        EmulatedDevice("robot", "melfa-mxt", "udp://127.0.0.1:0", {"mxt_timeout_s": 20.0}),
    ),
)
DRIVERS = ["datalink", "mxt"]


@asynccontextmanager
async def ready(which: str) -> AsyncIterator[tuple[EmulatedBench, MelfaDatalink | MelfaMxt]]:
    """Connect one of the drivers to a bench, drives on; slow, so that a stop finds the arm on its way."""
    async with EmulatedBench(CONFIG) as bench:
        r3, link, stream, _control = (served.endpoint for served in bench.endpoints)
        clock = SystemClock(SPEED)
        robot = (
            MelfaDatalink.at(r3, clock, datalink_endpoint=link)
            if which == "datalink"
            else MelfaMxt.at(r3, clock, mxt_endpoint=stream, mxt_timeout_s=20.0)
        )
        try:
            assert (await robot.connect()).simulated
            await robot.servo(on=True)
            await robot.set_override(5.0)
            yield bench, robot
        finally:
            await robot.close()


async def moving(bench: EmulatedBench) -> None:
    """Wait until the arm is well on its way."""
    async with asyncio.timeout(HANG_S):
        while bench.bench.joints[0] < 10.0:
            bench.keeper.sync()
            await asyncio.sleep(0.001)


@pytest.mark.parametrize("which", DRIVERS)
async def test_the_arm_drives_a_new_path_after_a_stop(which: str) -> None:
    async with ready(which) as (bench, robot):
        way = asyncio.create_task(robot.follow(WAY))
        await moving(bench)
        await robot.stop()
        assert not bench.bench.moving
        with pytest.raises(DeviceError):
            await way
        assert 10.0 <= bench.bench.joints[0] < 59.0
        await robot.follow(WAY)
        assert bench.bench.joints == pytest.approx(WAY[-1], abs=2e-3)
        assert await robot.joints() == pytest.approx(WAY[-1], abs=2e-3)


@pytest.mark.parametrize("which", DRIVERS)
async def test_cancelling_a_path_leaves_the_arm_at_rest_and_usable(which: str) -> None:
    async with ready(which) as (bench, robot):
        way = asyncio.create_task(robot.follow(WAY))
        await moving(bench)
        way.cancel()
        with pytest.raises(asyncio.CancelledError):
            await way
        assert not bench.bench.moving
        stopped = bench.bench.joints
        await asyncio.sleep(0.05)
        bench.keeper.sync()
        assert bench.bench.joints == stopped
        await robot.move_joints(WAY[0])
        assert bench.bench.joints == pytest.approx(WAY[0], abs=2e-3)


@pytest.mark.parametrize("which", DRIVERS)
async def test_an_emergency_stop_on_a_path_raises_an_alarm(which: str) -> None:
    async with ready(which) as (bench, robot):
        way = asyncio.create_task(robot.follow(WAY))
        await moving(bench)
        bench.controller.set_emergency_stop(on=True)
        with pytest.raises((AlarmError, NotReadyError), match="50"):
            await way
        assert not bench.bench.moving
        assert not bench.controller.servo_on


@pytest.mark.parametrize("which", DRIVERS)
async def test_a_path_beyond_controller_limits_fails_with_the_arm_inside(which: str) -> None:
    async with ready(which) as (bench, robot):
        with pytest.raises(DeviceError):
            await robot.follow(((0.0, 10.0, 0.0, 0.0), (0.0, 10.0, 200.0, 0.0)))
        assert not bench.bench.moving
        assert bench.bench.joints[2] <= 150.0 + 1e-3


async def test_a_path_follows_one_whose_answer_was_lost() -> None:
    """The emulated controller refuses RSTPRG and RUN while the program runs, which it does then."""
    async with ready("datalink") as (bench, robot):
        _, program, _ = bench.reach.ports_of("robot")
        way = asyncio.create_task(robot.follow(WAY))
        await moving(bench)
        program.muted = True
        await way
        program.muted = False
        assert bench.bench.joints == pytest.approx(WAY[-1], abs=2e-3)
        await robot.follow(WAY[:1])
        assert bench.bench.joints == pytest.approx(WAY[0], abs=2e-3)


@pytest.mark.parametrize("which", DRIVERS)
async def test_a_path_of_a_locked_machine_is_no_arrival(which: str) -> None:
    """The R-protocol reports the end of the path, and the arm has not moved."""
    async with ready(which) as (bench, robot):
        await robot.set_override(100.0)
        bench.controller.residents["CATSDL" if which == "datalink" else "CATSMXT"].reset()
        bench.controller.lock_machine(on=True)
        assert (await robot.status()).machine_locked
        with pytest.raises(NotReadyError, match="machine lock is on"):
            await robot.follow(WAY)
        assert bench.bench.joints == (0.0,) * 4
