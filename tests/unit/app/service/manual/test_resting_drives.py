"""Drives that a run has left on go off after some rest, with a countdown for everybody."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from dataclasses import replace
from datetime import datetime
from typing import Any

import pytest

from catseye.app.errors import ArmInUseError
from catseye.app.protocol.engine_events import DrivesChanged
from catseye.app.protocol.events import AnyEvent
from catseye.app.service.errors import RefusedError
from catseye.app.service.manual.drives import RestingDrives
from catseye.drivers.roles.errors import LinkError
from tests.unit.app.engine.fakes import FakeRobot
from tests.unit.app.engine.test_door_watch import SteppedClock


class Bench:
    """Lends a robot, unless it is out of reach; somebody may work on it by hand."""

    def __init__(self) -> None:
        self.clock = SteppedClock()
        self.robot = FakeRobot(self.clock)
        self.robot.state = replace(self.robot.state, servo_on=True)
        self.begun = 0
        self.occupied: str | None = None
        self.away = False
        self.elsewhere = False
        self.announced: list[DrivesChanged] = []
        self.drives = RestingDrives(self, self.clock, self._announce, self, self.owned)

    def _announce(self, event: AnyEvent) -> None:
        assert isinstance(event, DrivesChanged)
        self.announced.append(event)

    def acquired(self) -> AbstractAsyncContextManager[Any]:
        raise NotImplementedError

    def detached(self, device: str) -> AbstractAsyncContextManager[None]:
        raise NotImplementedError

    @asynccontextmanager
    async def acquired_robot(self, device: str) -> AsyncIterator[FakeRobot]:
        assert device == "robot"
        if self.away:
            raise RefusedError("robot is not connected: no answer")
        yield self.robot

    @asynccontextmanager
    async def owned(self, what: str) -> AsyncIterator[None]:
        assert what == "its drives go off"
        if self.elsewhere:
            raise ArmInUseError("the arm is in use by process 7")
        yield

    async def pass_s(self, duration_s: float) -> None:
        """Let time pass in small steps."""
        for _ in range(round(duration_s / 0.25)):
            self.clock.advance(0.25)
            for _ in range(5):
                await asyncio.sleep(0)


@pytest.fixture
async def bench() -> AsyncIterator[Bench]:
    made = Bench()
    yield made
    await made.drives.cancel()


async def test_drives_go_off_after_their_rest(bench: Bench) -> None:
    bench.drives.begin(300.0)
    await bench.pass_s(299.0)
    assert bench.robot.calls == []
    await bench.pass_s(2.0)
    assert bench.robot.calls == ["servo off"]
    reason = "the arm has rested for 300 s: the drives are off"
    assert bench.announced[-1] == DrivesChanged(on=False, reason=reason)
    assert bench.drives.facts is None


async def test_the_time_of_switching_drives_off_is_announced(bench: Bench) -> None:
    bench.drives.begin(300.0)
    begun = bench.clock.now_utc()
    for _ in range(3):
        await asyncio.sleep(0)
    (announced,) = bench.announced
    assert (datetime.fromisoformat(str(announced.off_at_utc)) - begun).total_seconds() == 300.0
    assert bench.drives.facts == announced


async def test_a_jog_begins_the_count_anew(bench: Bench) -> None:
    bench.drives.begin(300.0)
    await bench.pass_s(290.0)
    bench.begun, bench.occupied = 1, "Ada moves the arm"
    await bench.pass_s(60.0)
    bench.occupied = None
    await bench.pass_s(290.0)
    assert bench.robot.calls == []
    await bench.pass_s(15.0)
    assert bench.robot.calls == ["servo off"]


async def test_a_jog_within_a_tick_begins_the_count_anew(bench: Bench) -> None:
    bench.drives.begin(300.0)
    await bench.pass_s(290.0)
    bench.begun += 1
    await bench.pass_s(299.0)
    assert bench.robot.calls == []
    await bench.pass_s(2.0)
    assert bench.robot.calls == ["servo off"]


async def test_a_jog_before_the_first_turn_of_the_count(bench: Bench) -> None:
    bench.drives.begin(300.0)
    bench.begun += 1
    await bench.pass_s(300.5)
    assert bench.robot.calls == []
    await bench.pass_s(2.0)
    assert bench.robot.calls == ["servo off"]


async def test_a_run_takes_the_drives_over(bench: Bench) -> None:
    bench.drives.begin(300.0)
    await bench.pass_s(200.0)
    await bench.drives.cancel()
    await bench.pass_s(200.0)
    assert bench.robot.calls == []


async def test_a_run_that_left_them_alone_begins_the_count_anew(bench: Bench) -> None:
    bench.drives.begin(300.0)
    await bench.pass_s(200.0)
    await bench.drives.cancel()
    bench.drives.begin_again()
    await bench.pass_s(301.0)
    assert bench.robot.calls == ["servo off"]


async def test_a_run_that_took_them_over_begins_no_count(bench: Bench) -> None:
    bench.drives.begin(300.0)
    await bench.pass_s(200.0)
    await bench.drives.cancel()
    bench.drives.forget()
    bench.drives.begin_again()
    await bench.pass_s(301.0)
    assert bench.robot.calls == []


async def test_drives_of_another_programs_arm_stay_as_they_are(bench: Bench) -> None:
    bench.elsewhere = True
    bench.drives.begin(10.0)
    await bench.pass_s(11.0)
    assert bench.robot.calls == []
    assert "process 7" in str(bench.announced[-1].reason)


async def test_what_failed_after_the_rest_is_tried_at_the_end(bench: Bench) -> None:
    bench.drives.begin(300.0)
    bench.away = True
    await bench.pass_s(302.0)
    assert bench.announced[-1].on is True
    bench.away = False
    await bench.drives.end()
    assert bench.robot.calls == ["servo off"]
    await bench.drives.end()
    assert bench.robot.calls == ["servo off"]


async def test_an_engine_that_ends_switches_them_off_now(bench: Bench) -> None:
    bench.drives.begin(300.0)
    await bench.pass_s(1.0)
    await bench.drives.end()
    assert bench.robot.calls == ["servo off"]
    await bench.drives.end()
    assert bench.robot.calls == ["servo off"]


@pytest.mark.parametrize("how", ["away", "broken"])
async def test_drives_that_stay_on_are_said(bench: Bench, how: str, monkeypatch: pytest.MonkeyPatch) -> None:
    async def refuse(*, on: bool) -> None:
        raise LinkError(f"robot: link lost, asked for on={on}")

    monkeypatch.setattr(bench.robot, "servo", refuse)
    bench.away = how == "away"
    bench.drives.begin(10.0)
    await bench.pass_s(11.0)
    assert bench.announced[-1].on is True
    assert "not certain to be off" in str(bench.announced[-1].reason)
