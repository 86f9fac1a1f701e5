"""A walk whose key is let go and taken up again."""

import asyncio
from pathlib import Path

import pytest

from catseye.app.engine.request import RunOutcome
from catseye.drivers.roles.pose import Pose
from tests.patience import until
from tests.unit.app.engine.fakes import ManualClock
from tests.unit.app.engine.walked.tours import ELSEWHERE, FIRST, SECOND, Tour, TourBench

HALFWAY: Pose = (15.0, 60.0, 50.0, 10.0)


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> TourBench:
    monkeypatch.setattr("catseye.app.service.walk.fed_robot.SystemClock", ManualClock)
    bench = TourBench(tmp_path, Tour((SECOND,)))
    bench.fakes.robot.blocks = True
    return bench


async def until_suspended(bench: TourBench) -> None:
    await until(lambda: "SUSPENDED" in bench.fakes.states())


async def let_go(bench: TourBench, stands: Pose) -> "asyncio.Task[RunOutcome]":
    """Begin a walk and release the key on the way; return the walk, which waits."""
    walk = asyncio.create_task(bench.walk())
    await bench.fakes.robot.moving.wait()
    bench.fakes.robot.pose = stands
    bench.feed.let_go()
    await until_suspended(bench)
    bench.fakes.robot.blocks = False
    return walk


async def test_letting_go_stops_the_arm_and_holds_the_walk(bench: TourBench) -> None:
    walk = await let_go(bench, HALFWAY)
    assert bench.fakes.robot.calls[-2:] == ["stop", "move cancelled"]
    suspensions = [event for event in bench.fakes.said("state") if event["state"] == "SUSPENDED"]
    assert "not an enabling device" in str(suspensions[0]["reason"])
    for _ in range(50):
        await asyncio.sleep(0)
    assert bench.moves == 1
    bench.feed.feed()
    assert (await walk).status == "complete"


async def test_taken_up_again_it_goes_on_to_the_same_place(bench: TourBench) -> None:
    walk = await let_go(bench, HALFWAY)
    bench.feed.feed()
    outcome = await walk
    assert outcome.status == "complete"
    assert bench.fakes.robot.pose == SECOND
    assert "SUSPENDED" in bench.fakes.states()
    assert bench.fakes.states()[-2:] == ["EXECUTE", "COMPLETE"]


async def test_an_arm_that_was_moved_meanwhile_is_left_alone(bench: TourBench) -> None:
    walk = await let_go(bench, ELSEWHERE)
    bench.feed.feed()
    outcome = await walk
    assert outcome.status == "failed"
    assert "the arm was moved while the walk was let go" in outcome.text
    assert bench.moves == 1
    assert bench.fakes.robot.pose == ELSEWHERE


async def test_the_gate_is_asked_again_before_it_goes_on(bench: TourBench) -> None:
    walk = await let_go(bench, HALFWAY)
    robot = bench.fakes.robot
    robot.state = type(robot.state)(False, False, False, False, True, 10.0, 0, "")
    bench.feed.feed()
    outcome = await walk
    assert outcome.status == "aborted"
    assert bench.moves == 1


async def test_a_stop_ends_a_walk_that_waits(bench: TourBench) -> None:
    walk = await let_go(bench, HALFWAY)
    bench.fakes.signal(2)
    outcome = await walk
    assert outcome.status == "stopped"
    assert bench.moves == 1


async def test_unfed_nothing_moves_at_all(bench: TourBench) -> None:
    walk = asyncio.create_task(bench.walk())
    bench.feed.let_go()
    await asyncio.sleep(0)
    bench.feed.let_go()
    await until_suspended(bench)
    assert bench.moves == 0
    bench.fakes.robot.blocks = False
    bench.feed.feed()
    assert (await walk).status == "complete"
    assert bench.fakes.robot.pose == SECOND != FIRST
