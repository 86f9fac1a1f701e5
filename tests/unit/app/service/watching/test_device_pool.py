"""The bench between runs: devices come and go by themselves, and nothing is held that a run wants."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field

import pytest

from catseye.app.engine.waiting import cancel
from catseye.app.errors import ConfigError
from catseye.app.service.errors import RefusedError
from catseye.app.service.watching.device_pool import WAKING_LIMIT_S, DevicePool
from catseye.app.service.watching.device_supervisor import AIR_S, CLOSE_LIMIT_S
from catseye.app.service.watching.latest_values import LatestValues
from catseye.drivers.roles.air import AirSample
from catseye.drivers.roles.errors import RefusedError as DeviceRefusedError
from tests.unit.app.service.watching.pulled_devices import PulledCell, lost
from tests.unit.drivers.virtual_time import VirtualClock, run


@dataclass
class Idle:
    """A bench in virtual time."""

    cell: PulledCell = field(default_factory=PulledCell)
    troubles: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.latest = LatestValues(VirtualClock())
        self.bench = DevicePool(
            lambda: self.cell.made(self.latest), self.latest, VirtualClock(), self.troubles.append
        )

    async def watched(self, duration_s: float = 1.0) -> None:
        self.bench.watched(on=True)
        await asyncio.sleep(duration_s)

    def links(self) -> list[str]:
        return [self.latest.links[name].state for name in ("robot", "interferometer", "environment")]

    def held(self) -> list[bool]:
        return [device.open for device in self.cell.everyone()]


def played(play: Callable[[Idle], Awaitable[None]]) -> Idle:
    """Play on a bench and end it; nothing is held then, whatever was played."""

    async def whole() -> Idle:
        idle = Idle()
        try:
            await play(idle)
        finally:
            await idle.bench.end()
        assert idle.bench.devices() is None
        return idle

    return run(whole())


def test_devices_are_held_and_sampled_only_while_watched() -> None:
    async def play(idle: Idle) -> None:
        await asyncio.sleep(1.0)
        assert idle.held() == [False, False, False]
        await idle.watched(10.0)
        assert idle.links() == ["ok", "ok", "ok"]
        assert idle.bench.devices() is not None
        cell = idle.cell
        counts = [
            cell.robot.log.count("joints"),
            cell.counter.log.count("read"),
            cell.air.log.count("sample"),
        ]
        # Each answer takes 5 ms, after which the pause begins: 0.25 s, 0.1 s, 2 s.
        assert counts == [39, 91, 5]
        assert cell.robot.log.count("status") == 39
        idle.bench.watched(on=False)
        await asyncio.sleep(0.1)
        assert idle.held() == [False, False, False]
        assert idle.links() == ["closed", "closed", "closed"]
        asked = len(cell.robot.log)
        await asyncio.sleep(10.0)
        assert len(cell.robot.log) == asked

    assert played(play).troubles == []


def test_a_broken_device_is_retried_with_growing_pauses() -> None:
    async def play(idle: Idle) -> None:
        idle.cell.counter.error = lost()
        await idle.watched(60.0)
        assert idle.links() == ["ok", "lost", "ok"]
        assert idle.latest.links["interferometer"].error == "no cable: plug it in"
        # Pauses of 0.5, 1, 2, 4, 8, then 10 s, and 5 ms for each attempt.
        tried_s = [0.0, 0.5, 1.5, 3.5, 7.5, 15.5, 25.5, 35.5, 45.5, 55.5]
        assert idle.cell.counter.times_s == pytest.approx(tried_s, abs=0.06)
        idle.cell.counter.error = None
        await asyncio.sleep(10.0)
        assert idle.links() == ["ok", "ok", "ok"]
        assert idle.latest.links["interferometer"].error is None

    played(play)


def test_a_device_that_is_pulled_is_lost_and_comes_back() -> None:
    async def play(idle: Idle) -> None:
        await idle.watched()
        idle.cell.robot.error = lost()
        await asyncio.sleep(0.4)
        assert (idle.links()[0], idle.latest.links["robot"].error) == ("lost", "no cable: plug it in")
        assert idle.latest.joints is not None
        age_s = idle.latest.age_s(idle.latest.joints.time_s)
        assert 0.0 < age_s < 1.0
        idle.cell.robot.error = None
        await asyncio.sleep(1.0)
        assert idle.links() == ["ok", "ok", "ok"]
        # The pause begins anew: it was well in between.
        idle.cell.robot.error = lost()
        await asyncio.sleep(0.4)
        idle.cell.robot.error = None
        await asyncio.sleep(0.6)
        assert idle.links()[0] == "ok"

    played(play)


def test_a_refusal_neither_loses_the_link_nor_blocks_other_requests() -> None:
    async def play(idle: Idle) -> None:
        idle.cell.counter.refusal = DeviceRefusedError("there is no beam", 1)
        await idle.watched()
        assert idle.links()[1] == "ok"
        assert {"read", "status"} <= set(idle.cell.counter.log)
        assert idle.cell.counter.log.count("connect") == 1

    played(play)


def test_a_driver_fault_is_shown_as_a_lost_link() -> None:
    async def play(idle: Idle) -> None:
        async def broken() -> None:
            raise ZeroDivisionError("division by zero")

        idle.cell.air.sample = broken  # type: ignore[method-assign,assignment]  # a driver with a fault
        await idle.watched()
        assert idle.links() == ["ok", "ok", "lost"]
        assert idle.latest.links["environment"].error == "ZeroDivisionError: division by zero"

    played(play)


def test_links_are_freed_for_a_run_and_reconnected_afterwards() -> None:
    async def play(idle: Idle) -> None:
        await idle.watched()
        start_s = VirtualClock().monotonic_s()
        await idle.bench.release()
        assert VirtualClock().monotonic_s() - start_s < 0.02
        assert idle.held() == [False, False, False]
        # Whoever begins to watch during the run changes nothing.
        idle.bench.watched(on=False)
        await idle.watched(5.0)
        assert idle.held() == [False, False, False]
        idle.bench.take_up()
        await asyncio.sleep(0.1)
        assert idle.held() == [True, True, True]

    played(play)


def test_a_release_awaits_answers_but_not_hanging_connections() -> None:
    async def play(idle: Idle) -> None:
        await idle.watched(0.013)
        before = list(idle.cell.robot.log)
        assert before[-1] in {"status", "joints"}
        await idle.bench.release()
        assert idle.cell.robot.log == ["connect", "status", "joints", "close"]
        idle.bench.take_up()
        await asyncio.sleep(0.002)
        assert idle.latest.links["robot"].state == "connecting"
        await idle.bench.release()
        assert idle.held() == [False, False, False]

    played(play)


def test_a_run_cannot_begin_until_drivers_release_their_links() -> None:
    async def play(idle: Idle) -> None:
        await idle.watched()
        idle.cell.counter.hangs = asyncio.Event()
        start_s = VirtualClock().monotonic_s()
        for _ in range(2):
            with pytest.raises(RefusedError, match="interferometer: the driver does not let its link go"):
                await idle.bench.release()
        assert VirtualClock().monotonic_s() - start_s <= 3 * CLOSE_LIMIT_S + 0.1
        # Back between runs it is reported, and nothing else is kept from being watched.
        idle.bench.take_up()
        await asyncio.sleep(CLOSE_LIMIT_S + 1.0)
        assert idle.links() == ["ok", "lost", "ok"]
        idle.cell.counter.hangs.set()
        await idle.bench.release()
        assert idle.held() == [False, False, False]

    played(play)


def test_a_faulty_cell_file_is_reported_and_read_again() -> None:
    async def play(idle: Idle) -> None:
        idle.cell.fault = ConfigError("line 3: no such key")
        await idle.watched()
        assert idle.troubles == ["the devices of the cell cannot be made: line 3: no such key"]
        with pytest.raises(RefusedError, match="cannot be made"):
            async with idle.bench.acquired():
                pass
        idle.cell.fault = None
        idle.bench.watched(on=True)
        await asyncio.sleep(0.1)
        assert idle.held() == [True, True, True]

    played(play)


def test_a_borrower_has_the_robot_for_himself_and_is_seen() -> None:
    async def play(idle: Idle) -> None:
        async with idle.bench.acquired() as devices:
            assert idle.bench.acquired_devices == ["interferometer", "robot"]
            asked = len(idle.cell.robot.log)
            read = idle.cell.counter.log.count("read")
            await asyncio.sleep(5.0)
            assert len(idle.cell.robot.log) == asked
            assert idle.cell.counter.log.count("read") > read + 30
            await devices.robot.joints()
            assert idle.latest.joints is not None
            assert idle.latest.age_s(idle.latest.joints.time_s) == 0.0
            with pytest.raises(RefusedError, match="used by hand: end that first"):
                await idle.bench.release()
            with pytest.raises(RefusedError, match="used by hand already"):
                async with idle.bench.detached("robot"):
                    pass
        await asyncio.sleep(0.1)
        # Nobody watches.
        assert idle.held() == [False, False, False]

    played(play)


def test_acquiring_is_refused_without_devices_or_during_a_run() -> None:
    async def play(idle: Idle) -> None:
        idle.cell.counter.error = lost()
        with pytest.raises(RefusedError, match="interferometer is not connected: no cable"):
            async with idle.bench.acquired():
                pass
        await asyncio.sleep(0.1)
        idle.cell.counter.error = None
        await idle.bench.release()
        with pytest.raises(RefusedError, match="a run is under way or begins"):
            async with idle.bench.acquired():
                pass
        idle.bench.take_up()
        async with idle.bench.acquired():
            pass

    played(play)


def test_a_robot_alone_can_be_acquired_for_a_stop() -> None:
    async def play(idle: Idle) -> None:
        idle.cell.counter.error = lost()
        async with idle.bench.acquired_robot("robot") as robot:
            asked = len(idle.cell.robot.log)
            await asyncio.sleep(5.0)
            assert len(idle.cell.robot.log) == asked
            await robot.stop()
        assert idle.cell.robot.log.count("stop") == 1
        with pytest.raises(RefusedError, match="environment is not a robot: its driver cannot stop"):
            async with idle.bench.acquired_robot("environment"):
                pass
        idle.cell.robot.error = lost()
        with pytest.raises(RefusedError, match="robot is not connected: no cable"):
            async with idle.bench.acquired_robot("robot"):
                pass

    played(play)


def test_acquiring_a_silent_robot_fails_after_a_limit() -> None:
    async def play(idle: Idle) -> None:
        async def never() -> None:
            await asyncio.Event().wait()

        idle.cell.robot.connect = never  # type: ignore[method-assign,assignment]  # it hangs
        start_s = VirtualClock().monotonic_s()
        with pytest.raises(RefusedError, match="robot is not connected: it does not answer"):
            async with idle.bench.acquired():
                pass
        assert VirtualClock().monotonic_s() - start_s == pytest.approx(WAKING_LIMIT_S, abs=0.1)

    played(play)


def test_a_detached_device_is_released_alone_and_reconnected() -> None:
    async def play(idle: Idle) -> None:
        await idle.watched()
        async with idle.bench.detached("environment"):
            assert idle.held() == [True, True, False]
            await asyncio.sleep(10.0)
            assert idle.links() == ["ok", "ok", "raw"]
            assert idle.cell.air.log.count("connect") == 1
            async with idle.bench.acquired():
                pass
            with pytest.raises(RefusedError, match="environment: used by hand"):
                await idle.bench.release()
        await asyncio.sleep(0.1)
        assert idle.links() == ["ok", "ok", "ok"]
        with pytest.raises(
            RefusedError, match="no device 'door'; there are robot, interferometer, environment"
        ):
            async with idle.bench.detached("door"):
                pass
        idle.cell.air.hangs = asyncio.Event()
        with pytest.raises(RefusedError, match="environment: the driver does not let its link go"):
            async with idle.bench.detached("environment"):
                pass
        idle.cell.air.hangs.set()
        await asyncio.sleep(1.0)
        assert idle.links() == ["ok", "ok", "ok"]

    played(play)


def test_a_robot_lost_while_being_acquired_is_refused() -> None:
    async def play(idle: Idle) -> None:
        await idle.watched()
        asked = asyncio.Event()

        async def slow() -> None:
            asked.set()
            await asyncio.sleep(0.5)
            raise lost()

        idle.cell.robot.joints = slow  # type: ignore[method-assign,assignment]  # it is pulled while it answers
        await asked.wait()
        with pytest.raises(RefusedError, match="robot is not connected: no cable"):
            async with idle.bench.acquired():
                pytest.fail("a robot that nobody has asked who it is was lent")

    played(play)


def test_a_briefly_detached_device_has_only_one_supervisor() -> None:
    async def play(idle: Idle) -> None:
        await idle.watched()
        asked = asyncio.Event()
        sample = idle.cell.air.sample

        async def slow() -> AirSample:
            asked.set()
            await asyncio.sleep(0.5)
            return await sample()

        idle.cell.air.sample = slow  # type: ignore[method-assign]  # a slow sensor
        await asked.wait()

        async def park() -> None:
            async with idle.bench.detached("environment"):
                pass

        parking = asyncio.create_task(park())
        await asyncio.sleep(0.1)
        await cancel(parking)
        before = idle.cell.air.log.count("sample")
        await asyncio.sleep(10 * (AIR_S + 0.5))
        assert idle.links() == ["ok", "ok", "ok"]
        assert idle.cell.air.log.count("sample") - before == pytest.approx(10, abs=1)

    played(play)
