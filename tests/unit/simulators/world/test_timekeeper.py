"""Bench time from wall time, with a wall clock set by hand."""

import asyncio

import pytest

from catseye.simulators.world.timekeeper import TimeKeeper
from tests.patience import HANG_S
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
