"""Looks during a run: while it moves, asks or is held, never on a link that it uses, never at the arm as it moves."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace

import pytest

from catseye.app.engine.control import RunControl
from catseye.app.protocol.state import ControlState
from catseye.app.service.watching.latest_values import LatestValues
from catseye.app.service.watching.run_sampler import RunSampler
from tests.unit.app.service.watching.pulled_devices import PulledCell, lost
from tests.unit.drivers.virtual_time import VirtualClock, run


class Run:
    """A run whose state is as a test says."""

    def __init__(self) -> None:
        self.cell = PulledCell()
        self.latest = LatestValues(VirtualClock())
        self.control = RunControl(VirtualClock(), lambda _state, _reason: None)
        self.control.state = ControlState.EXECUTE
        self.sampler = RunSampler(self.latest, VirtualClock())
        self.sampler.devices = self.cell.observed(self.latest)
        self.asking = False

    async def ticks(self, duration_s: float) -> list[str]:
        """Return what was asked of robot and counter meanwhile."""
        robot, counter = len(self.cell.robot.log), len(self.cell.counter.log)
        for _ in range(round(duration_s / 0.2)):
            self.sampler.tick(self.control, asking=self.asking)
            await asyncio.sleep(0.2)
        return self.cell.robot.log[robot:] + self.cell.counter.log[counter:]


def played(play: Callable[[Run], Awaitable[None]]) -> None:
    async def whole() -> None:
        await play(Run())

    run(whole())


def test_nothing_is_asked_while_the_run_works() -> None:
    async def play(bench: Run) -> None:
        for state in (
            ControlState.STARTING,
            ControlState.EXECUTE,
            ControlState.SUSPENDED,
            ControlState.HOLDING,
            ControlState.STOPPING,
            ControlState.COMPLETE,
        ):
            bench.control.state = state
            assert await bench.ticks(2.0) == []
        bench.sampler.devices = None
        bench.control.moving = True
        assert await bench.ticks(2.0) == []

    played(play)


def test_only_the_beam_is_sampled_slowly_during_motion() -> None:
    async def play(bench: Run) -> None:
        bench.control.moving = True
        asked = await bench.ticks(10.0)
        assert asked == ["status", "read"] * (len(asked) // 2)
        assert 20 <= len(asked) // 2 <= 40
        assert bench.cell.robot.log == []

    played(play)


@pytest.mark.parametrize("state", [ControlState.HELD, ControlState.EXECUTE])
def test_joints_are_sampled_while_waiting_for_a_person(state: ControlState) -> None:
    async def play(bench: Run) -> None:
        bench.control.state = state
        bench.asking = state == ControlState.EXECUTE
        asked = await bench.ticks(10.0)
        assert 8 <= asked.count("joints") <= 10
        assert asked.count("read") >= 20

    played(play)


def test_alarm_and_override_stay_fresh_while_a_question_waits() -> None:
    async def play(bench: Run) -> None:
        bench.control.state, bench.asking = ControlState.STARTING, True
        for _ in range(5):
            await bench.ticks(2.0)
            status = bench.latest.status
            assert status is not None
            assert bench.latest.age_s(status.time_s) < 2.0

    played(play)


def test_without_a_counter_the_robot_alone_is_asked() -> None:
    async def play(bench: Run) -> None:
        assert bench.sampler.devices is not None
        bench.sampler.devices = replace(bench.sampler.devices, interferometer=None)
        bench.asking = True
        assert set(await bench.ticks(10.0)) == {"joints", "status"}

    played(play)


def test_what_the_run_itself_reads_is_not_asked_again() -> None:
    async def play(bench: Run) -> None:
        bench.asking = True
        devices = bench.sampler.devices
        assert devices is not None
        assert devices.interferometer is not None
        for _ in range(20):
            await devices.interferometer.status()
            await devices.interferometer.read()
            await devices.robot.joints()
            await devices.robot.status()
            before = list(bench.cell.counter.log), list(bench.cell.robot.log)
            bench.sampler.tick(bench.control, asking=True)
            await asyncio.sleep(0.2)
            assert (bench.cell.counter.log, bench.cell.robot.log) == before

    played(play)


def test_the_length_is_sampled_while_the_run_reads_signals() -> None:
    async def play(bench: Run) -> None:
        bench.asking = True
        devices = bench.sampler.devices
        assert devices is not None
        assert devices.interferometer is not None
        for _ in range(50):
            await devices.interferometer.status()
            await bench.ticks(0.2)
            length = bench.latest.displacement_mm
            assert length is not None
            assert bench.latest.age_s(length.time_s) < 1.0
        assert bench.cell.counter.log.count("read") <= 40

    played(play)


def test_a_link_in_use_is_left_alone() -> None:
    async def play(bench: Run) -> None:
        bench.control.moving = True
        devices = bench.sampler.devices
        assert devices is not None
        assert devices.interferometer is not None
        reading = asyncio.create_task(devices.interferometer.read())
        await asyncio.sleep(0)
        bench.sampler.tick(bench.control, asking=False)
        await reading
        await asyncio.sleep(0.1)
        assert bench.cell.counter.log == ["read"]

    played(play)


def test_a_device_not_answering_is_sampled_rarely() -> None:
    async def play(bench: Run) -> None:
        async def slow() -> None:
            bench.cell.counter.log.append("status")
            await asyncio.sleep(1.0)
            raise lost()

        bench.cell.counter.status = slow  # type: ignore[method-assign,assignment]  # it times out
        bench.control.moving = True
        asked = await bench.ticks(60.0)
        # A second each, and twenty without.
        assert asked == ["status"] * 3
        assert bench.latest.links["interferometer"].state == "lost"

    played(play)
