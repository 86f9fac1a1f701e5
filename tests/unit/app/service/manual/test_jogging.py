"""Moving by hand in virtual time: who may, and how far. The arm's own log is the witness."""

import asyncio
from dataclasses import replace

import pytest

from catseye.app.cell.model import Cell
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.answers import Answer, Stepped
from catseye.app.service.errors import RefusedError
from catseye.app.service.manual.jogging import Jogging
from catseye.app.service.manual.manual_arm import SILENCE_S
from tests.unit.app.service.manual.benches import client
from tests.unit.app.service.manual.jogs import alive, fed, hold, jogged, mode, nothing, now_s, step
from tests.unit.app.service.manual.timed_arm import HOME, ManualFixture, StepsOnlyArm, TimedArm
from tests.unit.drivers.virtual_time import run


def test_drives_and_override_from_the_beginning_to_the_end(cell: Cell) -> None:
    fixture = jogged(cell, nothing, percent=5.0)
    assert fixture.arm.said("override", "servo", "stop") == ["override 5", "servo on", "stop", "servo off"]
    first, last = fixture.events("jog")
    assert (first["on"], first["percent"], first["by"], first["moving"]) == (True, 5.0, "Ada (test-1)", None)
    assert (last["on"], last["reason"]) == (False, "the script is over")


def test_drives_that_were_on_stay_on(cell: Cell) -> None:
    arm = TimedArm()
    arm.state = replace(arm.state, servo_on=True)
    assert jogged(cell, nothing, arm).arm.said("servo") == ["servo on"]


def test_the_override_is_capped_and_never_raised(cell: Cell) -> None:
    assert jogged(cell, nothing, percent=80.0).arm.said("override") == ["override 20"]
    arm = TimedArm()
    arm.state = replace(arm.state, override_percent=3.0)
    assert jogged(cell, nothing, arm, percent=10.0).arm.said("override") == []


@pytest.mark.parametrize(
    ("typed", "code", "text"),
    [(None, ExitCode.USAGE, "the devices are real"), ("other", ExitCode.SAFETY, "names 'other'")],
)
def test_real_devices_need_the_cells_name(cell: Cell, typed: str | None, code: ExitCode, text: str) -> None:
    async def work() -> ManualFixture:
        fixture = ManualFixture(cell, TimedArm(simulated=False))
        jog = Jogging(fixture.bench, mode(arm=typed), client())
        with pytest.raises(RefusedError, match=text) as refused:
            await jog.begun
        assert refused.value.code == code
        await jog.over()
        return fixture

    fixture = run(work())
    assert fixture.arm.log == []
    assert fixture.announced == []


def test_real_devices_move_when_the_cells_name_is_typed(cell: Cell) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        assert await alive(jog, step(joint="j1", by=1.0)) == Stepped(joints=(1.0, 0.0, 50.0, 0.0))

    assert jogged(cell, script, TimedArm(simulated=False), arm=cell.name).arm.said("move")


def test_the_devices_are_not_to_be_had(cell: Cell) -> None:
    async def work() -> None:
        fixture = ManualFixture(cell, TimedArm())
        fixture.acquire_error = RefusedError("the robot is not connected", ExitCode.DEVICE)
        jog = Jogging(fixture.bench, mode(), client())
        with pytest.raises(RefusedError, match="not connected") as refused:
            await jog.begun
        assert refused.value.code == ExitCode.DEVICE
        await jog.over()

    run(work())


def test_a_step_ends_where_it_should(cell: Cell) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        assert await alive(jog, step(joint="j2", by=-2.5)) == Stepped(joints=(0.0, -2.5, 50.0, 0.0))
        assert await alive(jog, step(joint="j4", by=7.0)) == Stepped(joints=(0.0, -2.5, 50.0, 7.0))

    fixture = jogged(cell, script)
    assert [event["moving"] for event in fixture.events("jog")] == [None, "j2", None, "j4", None, None]


def test_a_step_beyond_a_limit_does_not_end_the_jog(cell: Cell) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        with pytest.raises(RefusedError, match="J1 = 171 deg is outside") as refused:
            await alive(jog, step(joint="j1", by=2.0))
        assert refused.value.code == ExitCode.SAFETY
        await alive(jog, step(joint="j1", by=1.0))

    fixture = jogged(cell, script, TimedArm(pose=(169.0, 0.0, 50.0, 0.0)))
    assert fixture.arm.said("move") == ["move 170.0000 0.0000 50.0000 0.0000"]


def test_an_arm_at_another_height_is_not_moved(cell: Cell) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        with pytest.raises(RefusedError, match="J3 = 0 mm is outside"):
            await alive(jog, step(joint="j1", by=1.0))
        with pytest.raises(RefusedError, match="J3 = 0 mm is outside"):
            await jog.hold(hold())  # type: ignore[misc]  # the first feed is answered later

    assert jogged(cell, script, TimedArm(pose=(0.0, 0.0, 0.0, 0.0))).arm.said("move", "jog") == []


def test_a_raised_override_is_lowered_before_the_next_motion(cell: Cell) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        arm = fixture.arm
        arm.state = replace(arm.state, override_percent=100.0)
        await alive(jog, step(joint="j1", by=1.0))
        arm.state = replace(arm.state, override_percent=50.0)
        await jog.hold(hold())  # type: ignore[misc]  # the first feed is answered later

    fixture = jogged(cell, script, percent=5.0)
    assert fixture.arm.said("override", "move", "jog")[1:] == [
        "override 5",
        "move 1.0000 0.0000 50.0000 0.0000",
        "override 5",
        "jog J1+1",
    ]


def test_one_motion_at_a_time(cell: Cell) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        long = jog.step(step(joint="j1", by=20.0), now_s)
        with pytest.raises(RefusedError, match="j1 is moving"):
            jog.step(step(joint="j2", by=1.0), now_s)
        with pytest.raises(RefusedError, match="a step of j1 is under way"):
            jog.hold(hold("j2"))
        await long

    assert len(jogged(cell, script).arm.said("move", "jog")) == 1


def test_a_long_step_goes_on_while_its_client_lives(cell: Cell) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        begun_s = now_s()
        assert await alive(jog, step(joint="j1", by=50.0)) == Stepped(joints=(50.0, 0.0, 50.0, 0.0))
        assert now_s() - begun_s > 5.0

    jogged(cell, script)


def test_a_step_is_stopped_when_its_client_falls_silent(cell: Cell) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        begun_s = now_s()
        with pytest.raises(RefusedError, match="the client sent nothing") as refused:
            await jog.step(step(joint="j1", by=50.0), lambda: begun_s)
        assert refused.value.code == ExitCode.SAFETY
        stopped_s = next(time_s for time_s, text in fixture.arm.log if text == "stop")
        assert SILENCE_S < stopped_s - begun_s < SILENCE_S + 0.15
        await jog.over()

    fixture = jogged(cell, script)
    assert fixture.arm.pose[0] < 10.0
    assert "the client sent nothing" in str(fixture.events("error")[0]["text"])
    assert fixture.arm.said("servo")[-1] == "servo off"


@pytest.mark.parametrize("how", ["release", "stop", "end"])
def test_a_step_is_stopped_at_once(cell: Cell, how: str) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        moving = jog.step(step(joint="j1", by=50.0), now_s)
        await asyncio.sleep(1.0)
        asked_s = now_s()
        if how == "release":
            assert jog.hold(hold(direction=0)) == Answer()
        else:
            jog.end("Ben stopped it")
        with pytest.raises(RefusedError, match="stopped") as refused:
            await moving
        assert refused.value.code == ExitCode.INTERRUPTED
        assert next(time_s for time_s, text in fixture.arm.log if text == "stop") == asked_s
        assert not fixture.arm.moving
        if how == "release":
            await alive(jog, step(joint="j1", by=1.0))
        else:
            with pytest.raises(RefusedError, match="the jog is over"):
                jog.step(step(joint="j1", by=1.0), now_s)
            await jog.over()

    fixture = jogged(cell, script)
    assert len(fixture.arm.said("move")) == (2 if how == "release" else 1)
    assert fixture.events("error") == []


@pytest.mark.parametrize("moving", [True, False])
def test_a_stop_is_idempotent(cell: Cell, moving: bool) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        if moving:
            await jog.hold(hold())  # type: ignore[misc]  # the first feed is answered later
        for _ in range(3):
            jog.end("Ben stopped it")
            await asyncio.sleep(0.01)
        await jog.over()
        jog.end("Ben stopped it")

    fixture = jogged(cell, script)
    assert len([event for event in fixture.events("jog") if not event["on"]]) == 1
    assert fixture.arm.said("servo") == ["servo on", "servo off"]


def test_a_hold_moves_while_fed_and_stops_soon_after(cell: Cell) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        await fed(jog, 1.0, hold("j2", -1))
        last_s = now_s()
        await asyncio.sleep(0.4)
        assert not fixture.arm.moving
        at = (await fixture.arm.joints())[1]
        assert -14.0 < at < -9.0
        await asyncio.sleep(1.0)
        assert (await fixture.arm.joints())[1] == at
        assert next(time_s for time_s, text in fixture.arm.log if text == "stop") - last_s < 0.3

    fixture = jogged(cell, script)
    assert fixture.arm.said("jog") == ["jog J2-1"]
    assert [event["moving"] for event in fixture.events("jog")] == [None, "j2", None, None]


def test_a_hold_is_released_at_once(cell: Cell) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        await fed(jog, 0.5, hold())
        asked_s = now_s()
        jog.hold(hold(direction=0))
        await asyncio.sleep(0.1)
        assert next(time_s for time_s, text in fixture.arm.log if text == "stop") == asked_s
        assert not fixture.arm.moving

    jogged(cell, script)


def test_another_direction_begins_after_standstill(cell: Cell) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        await fed(jog, 0.5, hold("j1", 1))
        await fed(jog, 0.6, hold("j1", -1))
        assert fixture.arm.said("jog", "stop")[:3] == ["jog J1+1", "stop", "jog J1-1"]

    jogged(cell, script)


def test_a_hold_released_before_it_began_moves_nothing(cell: Cell) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        answer = jog.hold(hold())
        assert isinstance(answer, asyncio.Future)
        jog.hold(hold(direction=0))
        with pytest.raises(RefusedError, match="j1 was not moved: released"):
            await answer

    assert jogged(cell, script).arm.said("jog") == []


def test_a_slow_controller_does_not_start_a_released_joint(cell: Cell) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        with pytest.raises(RefusedError, match="not fed any more"):
            await jog.hold(hold())  # type: ignore[misc]  # the first feed is answered later

    assert jogged(cell, script, TimedArm(answer_s=0.1)).arm.said("jog") == []


@pytest.mark.parametrize(("joint", "place"), [("j1", 0), ("j2", 1), ("j4", 3)])
@pytest.mark.parametrize("way", [-1, 1])
@pytest.mark.parametrize("speed_deg_s", [1.0, 20.0])
def test_a_hold_stops_ahead_of_the_limit(
    cell: Cell, joint: str, place: int, way: int, speed_deg_s: float
) -> None:
    limit_deg = getattr(cell.robot.limits_deg, joint)[0 if way < 0 else 1]
    pose = list(HOME)
    pose[place] = limit_deg - way * 45.0

    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        with pytest.raises(RefusedError, match=f"{joint.upper()} is too near to its limit"):
            await fed(jog, 100.0, hold(joint, way))
        left_deg = way * (limit_deg - (await fixture.arm.joints())[place])
        # A degree is to spare; doubt about the speed and the time to stop cost the rest.
        assert 1.0 <= left_deg < 1.0 + 2.0 * 0.25 * speed_deg_s + 0.5
        assert not fixture.arm.moving
        inward = jog.hold(hold(joint, -way))
        assert isinstance(inward, asyncio.Future)
        await inward

    fixture = jogged(cell, script, TimedArm(speed_deg_s=speed_deg_s, pose=(pose[0], pose[1], 50.0, pose[3])))
    reasons = [str(event.get("reason", "")) for event in fixture.events("jog")]
    assert any("too near to its limit" in reason for reason in reasons)
    assert fixture.events("error") == []


def test_a_robot_without_a_dead_man_is_moved_by_steps(cell: Cell) -> None:
    async def work() -> None:
        fixture = ManualFixture(cell, StepsOnlyArm())
        jog = Jogging(fixture.bench, mode(), client())
        await jog.begun
        with pytest.raises(RefusedError, match="move by steps"):
            jog.hold(hold())
        await alive(jog, step(joint="j1", by=1.0))
        jog.end("over")
        await jog.over()

    run(work())


@pytest.mark.parametrize("joint", ["j3", "j9", "beam"])
def test_an_axis_that_is_not_held_is_refused(cell: Cell, joint: str) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        with pytest.raises(RefusedError, match=f"no axis '{joint}' to move; there are j1, j2, j4"):
            jog.hold(hold(joint))

    assert jogged(cell, script).arm.said("jog", "move") == []


@pytest.mark.parametrize("joint", ["j3", "a1"])
def test_an_axis_that_is_not_stepped_is_refused(cell: Cell, joint: str) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        with pytest.raises(RefusedError, match=f"no axis '{joint}' to move; there are j1, j2, j4, beam"):
            await alive(jog, step(joint=joint, by=1.0))

    assert jogged(cell, script).arm.said("jog", "move") == []
