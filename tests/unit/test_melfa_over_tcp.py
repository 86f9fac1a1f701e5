"""The robot's driver and its emulated controller over sockets: what a technician does, and a jog's two dead-men."""

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import replace
from importlib.resources import files

import pytest

from catseye.drivers.melfa.controller import ProgramText
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import AlarmError, NotReadyError, RefusedError
from catseye.drivers.roles.robot import JogDirection
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.emulated_bench import EmulatedBench
from tests.patience import HANG_S
from tests.unit.simulators.benches import QUIET


@asynccontextmanager
async def robot_and_bench(
    suffix: str = "", speed: float = 1.0, **options: bool
) -> AsyncIterator[tuple[MelfaR3, EmulatedBench]]:
    controller = EmulatedDevice("robot", "melfa-r3", options=options)
    config = replace(QUIET, speed=speed, answer_suffix=suffix, devices=(controller,))
    async with EmulatedBench(config) as bench:
        robot = MelfaR3.at(bench.endpoints[0].endpoint, SystemClock(speed))
        try:
            await robot.connect()
            yield robot, bench
        finally:
            await robot.close()


async def seen(condition: Callable[[], bool]) -> None:
    """Wait for something on the emulated bench, in real time."""
    while not condition():  # noqa: ASYNC110  # the bench notifies nobody
        await asyncio.sleep(0.002)


def moves(bench: EmulatedBench) -> bool:
    """Return whether the arm moves at this moment; nobody needs to have asked the controller."""
    bench.keeper.sync()
    return bench.bench.moving


async def keep_jogging(robot: MelfaR3, directions: Mapping[str, JogDirection]) -> None:
    """Feed for ever."""
    async with robot.controller.jog(directions) as jog:
        while True:
            jog.feed()
            await asyncio.sleep(0.05)


@pytest.mark.parametrize("suffix", ["", "\r", "\r\n"])
async def test_a_technician_reads_and_writes(suffix: str) -> None:
    async with robot_and_bench(suffix, speed=20.0) as (robot, bench):
        controller = robot.controller
        await controller.write_variable("M1", 2.5)
        assert await controller.read_variable("M1") == 2.5
        await controller.write_outputs(0, 0x0003)
        assert await controller.outputs(0) == 3
        assert await controller.inputs(0) == 0
        await controller.write_parameter("CPRCE13", ["2"], confirm=True)
        assert await controller.read_parameter("CPRCE13") == ("2",)
        bench.controller.raise_alarm(2602)
        bench.controller.raise_alarm(9200)
        assert [entry.number for entry in await controller.error_log(5)] == [9200, 2602]
        await robot.reset_alarm()
        await robot.servo(on=True)
        await robot.move_joints((10.0, -20.0, 1.5, 30.25))
        assert await controller.feedback() == (10.0, -20.0, 1.5, 30.25)
        assert (await controller.encoders())[0].feedback == 10_000
        assert await controller.currents() == (0.0,) * 8
        assert (await controller.stop_sources()).stop == ()
        assert (await controller.clock()).startswith("2026-01-01 00:")
        assert (await controller.joint_limits())[2] == (0.0, 150.0)


async def test_a_machine_that_another_client_locks_is_noticed() -> None:
    """Sections 1.7, 1.10: MLOCKON needs no right, and positions go on as if the arm moved."""
    async with robot_and_bench(speed=20.0) as (robot, bench):
        await robot.servo(on=True)
        await robot.move_joints((5.0, 0.0, 0.0, 0.0))
        host, _, port = bench.endpoints[0].endpoint.removeprefix("tcp://").rpartition(":")
        reader, writer = await asyncio.open_connection(host, int(port))
        writer.write(b"1;1;MLOCKON\r")
        assert await reader.read(100) == b"QoK"
        writer.close()
        assert (await robot.status()).machine_locked
        with pytest.raises(NotReadyError, match="machine lock is on"):
            await robot.move_joints((10.0, -20.0, 1.5, 30.25))
        assert (await robot.joints()) == (10.0, -20.0, 1.5, 30.25)
        assert bench.bench.joints == (5.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("name", ["CATSDL", "CATSMXT"])
async def test_the_shipped_programs_can_be_loaded_and_read_back(name: str) -> None:
    program = ProgramText.of((files("catseye.drivers.melfa") / "programs" / f"{name}.prg").read_text())
    async with robot_and_bench(speed=20.0) as (robot, _):
        controller = robot.controller
        await controller.write_program(name, program)
        assert (await controller.read_program(name)).lines == program.lines
        (entry,) = await controller.programs()
        assert (entry.name, entry.lines) == (f"{name}.MB6", len(program.lines))
        with pytest.raises(RefusedError, match="already"):
            await controller.write_program(name, program)


async def test_a_jog_moves_only_while_fed() -> None:
    async with robot_and_bench() as (robot, bench):
        await robot.servo(on=True)
        async with robot.controller.jog({"J1": 1, "J2": -1}) as jog:
            for _ in range(5):
                jog.feed()
                await asyncio.sleep(0.1)
            assert moves(bench)
            # Fed for 0.2 s, then 0.14 s of the controller's own, then the braking.
            await asyncio.sleep(0.5)
            assert not moves(bench)
            assert bench.bench.joints[0] > 15.0
            assert bench.bench.joints[1] < -15.0
        motions = [entry.text for entry in bench.journal.entries("robot") if entry.text.startswith("motion")]
        assert len(motions) == 1


async def test_a_cancelled_jog_stops_the_robot() -> None:
    async with robot_and_bench() as (robot, bench):
        await robot.servo(on=True)

        held = asyncio.create_task(keep_jogging(robot, {"J1": 1}))
        await seen(lambda: bench.bench.joints[0] > 1.0)
        held.cancel()
        with pytest.raises(asyncio.CancelledError):
            await held
        assert not bench.bench.moving
        assert bench.bench.joints[0] < 15.0


async def test_a_jog_to_the_limit_ends_with_the_alarm() -> None:
    async with robot_and_bench() as (robot, bench):
        await robot.servo(on=True)
        # J3 stands at its lower limit.
        with pytest.raises(AlarmError, match="joint limit reached downwards, J3"):
            await keep_jogging(robot, {"J3": -1})
        assert not bench.bench.moving


@pytest.mark.parametrize("stop", [b"1;1;STOP\r", b"1;1;STOP"])
async def test_a_stop_overtakes_exec2_on_the_same_connection(stop: bytes) -> None:
    """Section 1.9: STOP at any moment; each command gets exactly one answer, in the order of the requests."""
    async with robot_and_bench("\r", speed=5.0, stop_overtakes=True) as (robot, bench):
        await robot.servo(on=True)
        await robot.set_override(5.0)
        host, _, port = bench.endpoints[0].endpoint.removeprefix("tcp://").rpartition(":")
        reader, writer = await asyncio.open_connection(host, int(port))
        try:
            writer.write(b"1;1;CNTLON\r1;1;EXECJ1=(100,0,0,0)\r1;1;EXEC2=MOV J1\r")
            assert await reader.readexactly(8) == b"QoK\rQoK\r"
            await seen(lambda: moves(bench) and bench.bench.joints[0] > 5.0)
            writer.write(stop)
            async with asyncio.timeout(HANG_S):
                assert await reader.readexactly(17) == b"QeR561000000\rQoK\r"
            assert bench.bench.joints[0] < 50.0
        finally:
            writer.close()
            await writer.wait_closed()
