"""Bench time from wall time, with a wall clock set by hand."""

import asyncio

import pytest

from catseye.simulators.world.timed_bench import TimedBench
from catseye.simulators.world.timekeeper import TimeKeeper
from tests.patience import HANG_S, until
from tests.unit.simulators.benches import quiet_bench


class Wall:
    """A wall clock."""

    def __init__(self) -> None:
        self.time_s = 1000.0

    def __call__(self) -> float:
        return self.time_s


def test_the_bench_follows_the_wall_times_the_speed() -> None:
    wall = Wall()
    keeper = TimeKeeper(quiet_bench(), 10.0, wall)
    assert keeper.sync() == 0.0
    wall.time_s += 2.0
    assert keeper.sync() == pytest.approx(20.0)
    keeper.speed = 1.0
    wall.time_s += 2.0
    assert keeper.sync() == pytest.approx(22.0)


def test_a_change_of_speed_does_not_jump() -> None:
    wall = Wall()
    keeper = TimeKeeper(quiet_bench(), 1.0, wall)
    wall.time_s += 1.0
    keeper.speed = 1000.0
    assert keeper.bench.time_s == pytest.approx(1.0)
    assert keeper.sync() == pytest.approx(1.0)


def costly(monkeypatch: pytest.MonkeyPatch, bench: TimedBench, wall: Wall, cost: float) -> list[float]:
    """Let each bench second take `cost` real seconds; return the list of the times that the bench is advanced to."""
    passed, advance_to = [], bench.advance_to

    def advanced(time_s: float) -> None:
        wall.time_s += cost * max(0.0, time_s - bench.time_s)
        advance_to(time_s)
        passed.append(time_s)

    monkeypatch.setattr(bench, "advance_to", advanced)
    return passed


def test_an_overloaded_bench_falls_behind_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    wall, said = Wall(), list[float]()
    keeper = TimeKeeper(quiet_bench(), 10.0, wall)
    keeper.on_behind = said.append
    passed = costly(monkeypatch, keeper.bench, wall, 0.5)
    longest_s = 0.0
    for _ in range(500):
        wall.time_s += 0.01
        began_s = wall.time_s
        keeper.sync()
        longest_s = max(longest_s, wall.time_s - began_s)
    # Half a second of calculation for a bench second: at most two of them pass in a real one.
    assert longest_s < 0.1
    assert 0.5 < keeper.bench.time_s / (wall.time_s - 1000.0) < 2.0
    assert keeper.behind_s == said[-1]
    assert keeper.behind_s == pytest.approx(10.0 * (wall.time_s - 1000.0) - keeper.bench.time_s, abs=2.5)
    assert passed == sorted(passed)


def test_a_pause_of_the_machine_is_caught_up(monkeypatch: pytest.MonkeyPatch) -> None:
    wall = Wall()
    keeper = TimeKeeper(quiet_bench(), 10.0, wall)
    costly(monkeypatch, keeper.bench, wall, 0.05)
    wall.time_s += 0.2
    for _ in range(20):
        keeper.sync()
    assert keeper.bench.time_s == pytest.approx(10.0 * (wall.time_s - 1000.0), rel=0.01)
    assert keeper.behind_s == 0.0


async def test_who_waits_on_an_overloaded_bench_gets_there(monkeypatch: pytest.MonkeyPatch) -> None:
    wall = Wall()
    keeper = TimeKeeper(quiet_bench(), 10.0, wall)
    costly(monkeypatch, keeper.bench, wall, 0.5)
    wall.time_s += 5.0
    await asyncio.wait_for(keeper.wait(lambda: 5.0 if keeper.bench.time_s < 5.0 else None), HANG_S)
    assert keeper.bench.time_s == 5.0
    assert keeper.behind_s > 10.0


async def test_who_waits_finds_the_bench_exactly_at_its_moment() -> None:
    wall = Wall()
    keeper = TimeKeeper(quiet_bench(), 1e9, wall)
    bench = keeper.bench
    await keeper.wait(lambda: 5.0 if bench.time_s < 5.0 else None)
    assert bench.time_s == 5.0


async def test_a_change_lets_look_again() -> None:
    wall = Wall()
    keeper = TimeKeeper(quiet_bench(), 1.0, wall)
    due: list[float | None] = [1e6]
    waiting = asyncio.create_task(keeper.wait(lambda: due[0]))
    await asyncio.sleep(0)
    due[0] = None
    keeper.changed()
    await asyncio.wait_for(waiting, HANG_S)
    assert keeper.bench.time_s == 0.0


async def test_nothing_to_wait_for_returns_at_once() -> None:
    keeper = TimeKeeper(quiet_bench(), 1.0, Wall())
    await asyncio.wait_for(keeper.wait(lambda: None), HANG_S)
    assert keeper.bench.time_s == 0.0


async def test_a_process_that_slept_lets_the_bench_stand_still() -> None:
    wall = Wall()
    keeper = TimeKeeper(quiet_bench(), 10.0, wall)
    keeper.stay_awake(lambda: True)
    for slept_s, bench_s in ((0.05, 0.5), (0.7, 0.5), (0.05, 1.0)):
        wall.time_s += slept_s
        assert keeper.sync() == pytest.approx(bench_s)
    assert keeper.behind_s == pytest.approx(7.0)


async def test_who_waits_over_a_sleep_waits_for_the_rest() -> None:
    wall = Wall()
    keeper = TimeKeeper(quiet_bench(), 1.0, wall)
    keeper.stay_awake(lambda: True)
    waiting = asyncio.create_task(keeper.wait(lambda: 0.5 if keeper.bench.time_s < 0.5 else None))
    await asyncio.sleep(0)
    wall.time_s += 0.7
    assert keeper.sync() == 0.0
    for _ in range(6):
        assert not waiting.done()
        wall.time_s += 0.09
        keeper.sync()
    await asyncio.wait_for(waiting, HANG_S)
    assert keeper.bench.time_s == pytest.approx(0.54)


async def test_a_sleep_that_nobody_minds_is_caught_up() -> None:
    wall = Wall()
    keeper = TimeKeeper(quiet_bench(), 1.0, wall)
    needed = [True, False]
    keeper.stay_awake(lambda: needed.pop(0))
    await until(lambda: not needed)
    wall.time_s += 0.7
    assert keeper.sync() == pytest.approx(0.7)
