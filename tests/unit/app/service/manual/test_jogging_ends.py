"""Moving by hand in virtual time: how it ends, whatever fails. The arm's own log is the witness."""

import asyncio
from contextlib import suppress
from dataclasses import replace

import pytest

from catseye.app.cell.model import Cell
from catseye.app.engine.waiting import cancel
from catseye.app.exitcode import ExitCode
from catseye.app.service.errors import RefusedError
from catseye.app.service.manual.jogging import Jogging
from catseye.drivers.roles.errors import LinkError
from tests.unit.app.service.manual.benches import client
from tests.unit.app.service.manual.jogs import alive, fed, hold, jogged, mode, nothing, now_s, step
from tests.unit.app.service.manual.timed_arm import ManualFixture, TimedArm
from tests.unit.drivers.virtual_time import run


@pytest.mark.parametrize("how", ["step", "hold"])
def test_an_open_door_stops_a_motion_and_ends_the_jog(cell: Cell, how: str) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        if how == "step":
            moving = asyncio.create_task(alive(jog, step(joint="j1", by=50.0)))
        else:
            moving = asyncio.create_task(fed(jog, 5.0, hold()))
        await asyncio.sleep(1.0)
        fixture.door.closed = False
        opened_s = now_s()
        with pytest.raises(RefusedError, match=r"door is open|jog is over"):
            await moving
        assert next(time_s for time_s, text in fixture.arm.log if text == "stop") - opened_s < 0.35
        await jog.over()

    fixture = jogged(cell, script)
    assert "the door is open" in str(fixture.events("error")[0]["text"])
    assert fixture.events("error")[0]["exit_code"] == ExitCode.SAFETY


@pytest.mark.parametrize("how", ["step", "hold"])
def test_nothing_is_sent_to_the_controller_after_a_stop(cell: Cell, how: str) -> None:
    """A raised override is lowered before a motion; a stop that comes while it is read forbids that too."""

    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        fixture.arm.state = replace(fixture.arm.state, override_percent=100.0)
        moving = jog.step(step(joint="j1", by=5.0), now_s) if how == "step" else jog.hold(hold())
        await asyncio.sleep(0)
        jog.end("Ben stopped it")
        assert isinstance(moving, asyncio.Future)
        with pytest.raises(RefusedError):
            await moving

    log = [text for _, text in jogged(cell, script, percent=5.0).arm.log]
    assert set(log[log.index("stop") :]) == {"stop", "servo off"}


def test_no_drives_while_the_door_is_open(cell: Cell) -> None:
    async def work() -> None:
        fixture = ManualFixture(cell, TimedArm())
        fixture.door.closed = False
        jog = Jogging(fixture.bench, mode(), client())
        with pytest.raises(RefusedError, match="the door is open"):
            await jog.begun
        await jog.over()
        assert "servo on" not in fixture.arm.said("servo")

    run(work())


def test_an_alarm_between_motions_ends_the_jog(cell: Cell) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        fixture.arm.state = replace(fixture.arm.state, alarm_number=2100, alarm_text="collision")
        await jog.over()

    fixture = jogged(cell, script)
    assert "2100" in str(fixture.events("error")[0]["text"])
    assert fixture.events("jog")[-1]["on"] is False


def test_an_end_while_the_drives_come_on_leaves_them_off(cell: Cell) -> None:
    async def work() -> None:
        fixture = ManualFixture(cell, TimedArm(answer_s=0.1))
        jog = Jogging(fixture.bench, mode(), client())
        await asyncio.sleep(0.45)
        jog.end("Ada released control")
        with pytest.raises(RefusedError, match="released control"):
            await jog.begun
        await jog.over()
        assert fixture.arm.said("servo")[-1] == "servo off"
        assert fixture.events("jog") == []

    run(work())


@pytest.mark.parametrize("stuck", [True, False])
def test_an_arm_that_does_not_stop_aborts_the_jog(cell: Cell, stuck: bool) -> None:
    async def work() -> None:
        fixture = ManualFixture(cell, TimedArm())
        jog = Jogging(fixture.bench, mode(), client())
        await jog.begun
        moving = jog.step(step(joint="j1", by=50.0), now_s)
        await asyncio.sleep(1.0)
        fixture.arm.runs_away = True
        if stuck:
            fixture.arm.servo_error = LinkError("the controller does not answer")
        jog.end("Ben stopped it")
        with pytest.raises(RefusedError):
            await moving
        await jog.over()
        assert "EMERGENCY STOP" in jog.aborted
        assert jog.aborted in str(fixture.events("error")[0]["text"])
        assert fixture.arm.said("servo")[-1] == "servo off"

    run(work())


def test_a_fault_of_the_program_stops_the_arm_too(cell: Cell, monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        moving = asyncio.create_task(alive(jog, step(joint="j1", by=50.0)))
        await asyncio.sleep(1.0)
        monkeypatch.setattr(fixture.door, "door_closed", None)
        with pytest.raises(RefusedError):
            await moving
        assert not fixture.arm.moving
        await jog.over()

    assert len(jogged(cell, script).events("error")) == 1


@pytest.mark.parametrize("moving", [True, False])
def test_a_watch_that_is_cancelled_from_outside_ends_the_jog(
    cell: Cell, monkeypatch: pytest.MonkeyPatch, moving: bool
) -> None:
    async def cancelled() -> bool:
        raise asyncio.CancelledError

    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        motion = asyncio.create_task(alive(jog, step(joint="j1", by=50.0))) if moving else None
        await asyncio.sleep(1.0)
        monkeypatch.setattr(fixture.door, "door_closed", cancelled)
        async with asyncio.timeout(1.0):
            await jog.over()
        if motion is not None:
            with pytest.raises(RefusedError):
                await motion
        assert not fixture.arm.moving

    fixture = jogged(cell, script)
    assert "watched no more: the watch was cancelled" in str(fixture.events("error")[0]["text"])


def test_a_step_whose_client_is_watched_no_more_is_stopped(cell: Cell) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        def heard_s() -> float:
            if fixture.arm.moving:
                raise asyncio.CancelledError
            return now_s()

        with pytest.raises(RefusedError, match="watched no more"):
            await jog.step(step(joint="j1", by=50.0), heard_s)
        assert fixture.arm.pose[0] < 5.0

    jogged(cell, script)


def test_an_engine_that_ends_leaves_the_arm_at_rest(cell: Cell) -> None:
    async def work() -> TimedArm:
        fixture = ManualFixture(cell, TimedArm())
        jog = Jogging(fixture.bench, mode(), client())
        await jog.begun
        feeding = asyncio.create_task(fed(jog, 5.0, hold()))
        await asyncio.sleep(1.0)
        jog.abort("SIGTERM")
        await jog.over()
        assert jog.aborted == "SIGTERM"
        await cancel(feeding)
        assert not fixture.arm.moving
        return fixture.arm

    assert run(work()).said("servo")[-1] == "servo off"


@pytest.mark.parametrize(
    ("before", "percent", "stated"),
    [(100.0, 5.0, "5 %"), (10.0, 5.0, "5 %"), (5.0, 5.0, ""), (100.0, 20.0, "")],
)
def test_the_end_reports_an_override_staying_low(
    cell: Cell, before: float, percent: float, stated: str
) -> None:
    arm = TimedArm()
    arm.state = replace(arm.state, override_percent=before)
    warnings = jogged(cell, nothing, arm, percent=percent).events("warning")
    assert len(warnings) == bool(stated)
    if stated:
        assert f"stays at {stated} and runs are planned with 20 %: = on" in str(warnings[0]["text"])


def test_a_jog_that_is_ended_in_its_first_moment_answers(cell: Cell) -> None:
    async def work() -> None:
        fixture = ManualFixture(cell, TimedArm())
        jog = Jogging(fixture.bench, mode(), client())
        jog.end("Ben stopped it")
        await jog.over()
        with pytest.raises(RefusedError, match="Ben stopped it") as refused:
            async with asyncio.timeout(1.0):
                await jog.begun
        assert refused.value.code == ExitCode.INTERRUPTED
        assert fixture.arm.log == []

    run(work())


def test_a_swallowed_cancellation_still_ends_the_jog(cell: Cell, monkeypatch: pytest.MonkeyPatch) -> None:
    async def work() -> ManualFixture:
        fixture = ManualFixture(cell, TimedArm())
        jog = Jogging(fixture.bench, mode(), client())

        async def deaf(percent: float) -> float:
            with suppress(asyncio.CancelledError):
                await asyncio.sleep(1.0)
            fixture.arm.state = replace(fixture.arm.state, override_percent=percent)
            return percent

        monkeypatch.setattr(fixture.arm, "set_override", deaf)
        await asyncio.sleep(0.5)
        jog.end("Ben stopped it")
        with pytest.raises(RefusedError, match="Ben stopped it"):
            await jog.begun
        async with asyncio.timeout(5.0):
            await jog.over()
        return fixture

    fixture = run(work())
    assert fixture.events("jog") == []
    assert fixture.arm.said("servo")[-1] == "servo off"


def test_a_robot_that_nobody_knows_is_not_moved(cell: Cell) -> None:
    async def work() -> None:
        fixture = ManualFixture(cell, TimedArm(simulated=False))
        fixture.bench = replace(fixture.bench, identities=dict)
        jog = Jogging(fixture.bench, mode(), client())
        with pytest.raises(RefusedError, match="not known which robot answers"):
            await jog.begun
        await jog.over()
        assert fixture.arm.log == []

    run(work())


def test_a_driver_that_fails_at_the_end_lets_nothing_begin(
    cell: Cell, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def work() -> None:
        fixture = ManualFixture(cell, TimedArm())
        jog = Jogging(fixture.bench, mode(), client())
        await jog.begun

        async def broken() -> None:
            raise ValueError("no number: b'?'")

        monkeypatch.setattr(fixture.arm, "status", broken)
        await jog.over()
        assert "EMERGENCY STOP" in jog.aborted
        assert "no number" in jog.aborted
        assert fixture.arm.said("servo")[-1] == "servo off"

    run(work())


def test_an_override_that_cannot_be_read_keeps_no_arm(cell: Cell, monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(fixture: ManualFixture, _jog: Jogging) -> None:
        async def switched_off(*, on: bool) -> None:
            del on
            # The drives go off last, before the override is read.
            monkeypatch.setattr(fixture.arm, "status", broken)

        async def broken() -> None:
            raise ValueError("no number: b'?'")

        monkeypatch.setattr(fixture.arm, "servo", switched_off)

    fixture = jogged(cell, script)
    assert fixture.guard.calls[-1] == "let go"
    assert fixture.events("error") == []
    assert fixture.events("override-left") == []


def test_the_published_override_is_the_one_read_back(cell: Cell) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        await alive(jog, step(joint="j1", by=1.0))
        fixture.arm.state = replace(fixture.arm.state, override_percent=8.0)
        await alive(jog, step(joint="j1", by=1.0))

    arm = TimedArm()
    arm.state = replace(arm.state, override_percent=3.0)
    percents = [event["percent"] for event in jogged(cell, script, arm, percent=10.0).events("jog")]
    assert percents == [3.0, 3.0, 3.0, 8.0, 8.0, 8.0]
