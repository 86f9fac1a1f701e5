"""The robot over RS-232 as its controllers have it: 9600 baud, 8 bits, even parity, 2 stop bits (sheet, section 1.3).

Time runs at its own pace here: a byte takes 1.25 ms, STATE and JPOSF together about 0.2 s.
"""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import replace

import pytest

from catseye.drivers.melfa.motion import unstarted_polls
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.session import byte_time_s
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import RefusedError
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.emulated_bench import EmulatedBench
from tests.unit.simulators.benches import QUIET

LINE = "serial:///dev/ptmx?baud=9600&parity=E&stopbits=2"
CONFIG = replace(QUIET, devices=(EmulatedDevice("robot", "melfa-r3", LINE),))


def test_a_byte_takes_what_it_takes() -> None:
    """Start bit, eight data bits, parity, two stop bits."""
    assert byte_time_s(LINE) == pytest.approx(12 / 9600)
    assert byte_time_s("serial:///dev/ttyUSB0?baud=19200") == pytest.approx(10 / 19_200)
    assert byte_time_s("tcp://127.0.0.1:10001") == 0.0


def test_a_slow_line_needs_fewer_polls() -> None:
    assert unstarted_polls(0.0) == 25
    assert unstarted_polls(byte_time_s(LINE)) == 4


@asynccontextmanager
async def robot_on_the_line() -> AsyncIterator[tuple[MelfaR3, EmulatedBench]]:
    async with EmulatedBench(CONFIG) as bench:
        endpoint = next(served.endpoint for served in bench.endpoints if served.device == "robot")
        robot = MelfaR3.at(endpoint, SystemClock())
        try:
            assert (await robot.connect()).simulated
            yield robot, bench
        finally:
            await robot.close()


def asked(bench: EmulatedBench) -> list[str]:
    entries = bench.journal.entries("robot")
    return [entry.text.removeprefix("1;1;") for entry in entries if entry.kind == "request"]


async def seen(condition: Callable[[], bool]) -> None:
    """Wait for something on the emulated bench, in real time."""
    while not condition():  # noqa: ASYNC110  # the bench notifies nobody
        await asyncio.sleep(0.005)


@pytest.mark.slow
async def test_a_polled_motion_is_stopped_between_polls() -> None:
    async with robot_on_the_line() as (robot, bench):
        assert any("no second connection" in note for note in robot.notes)
        assert sum(command.startswith("OPEN=") for command in asked(bench)) == 1
        await robot.servo(on=True)
        await robot.set_override(2.0)
        moving = asyncio.create_task(robot.move_joints((60.0, 0.0, 0.0, 0.0)))
        await seen(lambda: bench.bench.moving)
        await asyncio.sleep(0.5)
        asked_before = len(asked(bench))
        stopping = asyncio.create_task(robot.stop())
        await seen(lambda: "STOP" in asked(bench))
        # The poll under way ends first, and nothing else comes before it.
        assert asked(bench).index("STOP") - asked_before <= 1
        await stopping
        assert not bench.bench.moving
        assert 0.0 < bench.bench.joints[0] < 60.0
        with pytest.raises(RefusedError, match="a stop overtook the motion"):
            await moving
        assert not any(command.startswith("EXEC2") for command in asked(bench))


@pytest.mark.slow
async def test_a_motion_arrives_and_other_questions_have_their_time() -> None:
    async with robot_on_the_line() as (robot, bench):
        await robot.servo(on=True)
        await robot.move_joints((1.0, -1.0, 0.5, 2.0))
        assert bench.bench.joints == (1.0, -1.0, 0.5, 2.0)
        # More than 200 bytes, 0.25 s on the line.
        assert (await robot.controller.read_parameter("MEJAR"))[:2] == ("-170.00", "170.00")
        assert len(await robot.controller.encoders()) == 8
        with pytest.raises(RefusedError, match="no program"):
            await robot.controller.read_program("NONE")


@pytest.mark.slow
async def test_a_jog_is_repeated_in_time_on_a_slow_line() -> None:
    async with robot_on_the_line() as (robot, bench):
        await robot.servo(on=True)
        async with robot.controller.jog({"J1": 1}) as jog:
            for _ in range(8):
                jog.feed()
                await asyncio.sleep(0.1)
            # 10 % of 420 deg/s for 0.7 s at least, without a break.
            assert bench.bench.joints[0] > 20.0
        assert not bench.bench.moving
        motions = [entry.text for entry in bench.journal.entries("robot") if entry.text.startswith("motion")]
        assert len(motions) == 1
