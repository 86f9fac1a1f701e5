"""Drivers and emulators over an emulated serial line: nothing but bytes joins them."""

from dataclasses import replace

from catseye.drivers.counter.counter import LineCounter
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.roles.clock import SystemClock
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.emulated_bench import EmulatedBench
from tests.unit.simulators.benches import QUIET, aimed

LINE = "serial:///dev/ptmx?baud=115200&parity=E&stopbits=2"
CONFIG = replace(
    QUIET,
    speed=20.0,
    start_joints=aimed(20.0, 30.0),
    devices=(
        EmulatedDevice("robot", "melfa-r3", LINE),
        EmulatedDevice("interferometer", "line-counter", LINE),
    ),
)


def endpoint_of(bench: EmulatedBench, device: str) -> str:
    return next(served.endpoint for served in bench.endpoints if served.device == device)


async def test_a_robot_moves_over_a_serial_line() -> None:
    async with EmulatedBench(CONFIG) as bench:
        robot = MelfaR3.at(endpoint_of(bench, "robot"), SystemClock(20.0))
        try:
            assert (await robot.connect()).simulated
            # A line has room for one client: STOP goes between two polls.
            assert any("no second connection for STOP" in note for note in robot.notes)
            await robot.servo(on=True)
            await robot.move_joints((21.0, 31.0, 0.0, 10.0))
            assert await robot.joints() == (21.0, 31.0, 0.0, 10.0)
            await robot.stop()
        finally:
            await robot.close()
        assert bench.bench.joints == (21.0, 31.0, 0.0, 10.0)


async def test_a_counter_works_and_reconnects_over_a_serial_line() -> None:
    async with EmulatedBench(CONFIG) as bench:
        counter = LineCounter.at(endpoint_of(bench, "interferometer"), SystemClock(20.0))
        try:
            for _ in range(2):
                assert (await counter.connect()).simulated
                assert (await counter.read()).raw.endswith(" mm")
                assert (await counter.status()).laser_ready
                await counter.close()
        finally:
            await counter.close()
