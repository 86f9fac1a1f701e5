"""Motions of the robot driver against scripted controllers: commanded once, accounted for when the answer is lost."""

import asyncio
from collections.abc import Iterable, Iterator

import pytest
from pydantic import ValidationError

from catseye.drivers.links.healing import ATTEMPTS
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.errors import (
    AlarmError,
    LinkError,
    LinkTimeoutError,
    NotArrivedError,
    NotReadyError,
    RefusedError,
)
from catseye.drivers.roles.pose import SAME_PLACE
from catseye.drivers.roles.robot import RobotStatus
from tests.patience import until
from tests.unit.drivers.melfa_bench import JPOS, QUICK, START, STATE, TARGET, Controller, bench
from tests.unit.drivers.peers import Peer
from tests.unit.drivers.virtual_time import run


async def test_a_move_takes_two_requests_and_one_check() -> None:
    async with bench() as b:
        await b.robot.move_joints(TARGET)
        before = len(b.said)
        await b.robot.move_joints((0.00004, -0.00004, 5.0, 1.23456))
    assert b.said[before : before + 3] == [
        "EXECJCATSEY1=(0.0000,0.0000,5.0000,1.2346)",
        "EXEC2=MOV JCATSEY1",
        "JPOSF",
    ]


async def test_a_definition_that_is_there_already_is_used() -> None:
    """Section 1.9: re-DEF gives 4350, which clients tolerate."""
    controller = Controller()
    controller.replies["EXECDEF JNT JCATSEY1"] = lambda: ["QeR435000000"]
    async with bench(controller) as b:
        await b.robot.move_joints(TARGET)
        assert controller.at == TARGET
    assert "RSTALRM" not in b.said


async def test_a_definition_that_leaves_an_alarm_is_reset() -> None:
    controller = Controller()
    alarms = iter(["Qok4350;2", "QoK"])
    controller.replies["EXECDEF JNT JCATSEY1"] = lambda: ["QeR435000000"]
    controller.replies["ERROR"] = lambda: [next(alarms)]
    async with bench(controller) as b:
        await b.robot.move_joints(TARGET)
    assert b.said[2:6] == ["EXECDEF JNT JCATSEY1", "ERROR", "RSTALRM", "ERROR"]


async def test_a_refused_motion_names_meaning_and_remedy_and_moves_nothing() -> None:
    """Section 5.3: L2602 destination out of range; no alarm stays."""
    controller = Controller()
    controller.replies["EXEC2"] = lambda: ["QeR260200000"]
    async with bench(controller) as b:
        with pytest.raises(RefusedError, match=r"alarm L2602: the target is outside .*MEJAR") as caught:
            await b.robot.move_joints(TARGET)
        assert caught.value.number == 2602
        assert not isinstance(caught.value, AlarmError)


# Section 5.3: emergency stop and pendant link, servo, mode, operation right, STOP.
@pytest.mark.parametrize(
    "number",
    [50, 51, 60, 61, 70, 71, 75, 1680, 1681, 2000, 5000, 5130, 5610, 5630, 6020, 6060],
)
async def test_errors_needing_an_operator_mean_not_ready(number: int) -> None:
    controller = Controller()
    controller.replies["EXEC2"] = lambda: [f"QeR{number:04d}00000"]
    async with bench(controller) as b:
        with pytest.raises(NotReadyError, match=f"{number:04d}") as caught:
            await b.robot.move_joints(TARGET)
        assert caught.value.number == number


async def test_drives_that_are_off_with_an_alarm_stay_an_alarm() -> None:
    controller = Controller()
    controller.alarm = "2000"
    controller.replies["EXEC2"] = lambda: ["QeR200000000"]
    controller.replies["EXECDEF JNT JCATSEY1"] = lambda: ["QoK"]
    controller.replies["EXECJCATSEY1"] = lambda: ["QoK"]
    async with bench(controller) as b:
        with pytest.raises(AlarmError, match="L2000"):
            await b.robot.move_joints(TARGET)


@pytest.mark.parametrize(("reply", "not_ready"), [("QeR561000000", False), ("QeR005000000", True)])
async def test_only_our_own_stop_needs_no_operator(reply: str, not_ready: bool) -> None:
    """Section 5.3: C5610 STOP on. An emergency stop during a stop of this program stays one."""
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEY1" in b.said)
        stopping = asyncio.create_task(b.robot.stop())
        await until(lambda: "STOP" in b.said_aside)
        await b.main.say(reply.encode())
        with pytest.raises(RefusedError) as caught:
            await moving
        await stopping
        assert isinstance(caught.value, NotReadyError) is not_ready


async def test_a_motion_that_a_stop_overtakes_does_not_begin() -> None:
    controller = Controller()
    controller.replies["EXECJCATSEY1"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: any(said.startswith("EXECJCATSEY1=") for said in b.said))
        await b.robot.stop()
        await b.main.say(b"QoK")
        with pytest.raises(RefusedError, match="stop overtook"):
            await moving
        assert not any("MOV" in said for said in b.said)


async def test_a_stop_signal_long_after_ours_is_foreign() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = lambda: ["QeR561000000"]
    async with bench(controller) as b:
        await b.robot.stop()
        with pytest.raises(NotReadyError, match="C5610"):
            await b.robot.move_joints(TARGET)


async def test_an_alarm_during_a_motion_is_raised_with_its_text() -> None:
    controller = Controller()

    def stops_half_way() -> Iterable[str]:
        controller.alarm = "2171"
        return ["Qok"]

    controller.replies["EXEC2"] = stops_half_way
    async with bench(controller) as b:
        with pytest.raises(AlarmError, match="alarm H2171: joint limit reached downwards, J1; jog") as caught:
            await b.robot.move_joints(TARGET)
        assert caught.value.number == 2171


async def test_a_rejection_during_an_alarm_names_both() -> None:
    """Section 5.3: L5600 alarm present."""
    controller = Controller()
    controller.alarm = "50"
    controller.replies["SRVON"] = lambda: ["QeR560000000"]
    async with bench(controller) as b:
        with pytest.raises(AlarmError, match=r"L5600.*active is alarm H0050"):
            await b.robot.servo(on=True)


async def test_a_robot_that_stands_elsewhere_has_not_arrived() -> None:
    controller = Controller()
    controller.arrives = False
    async with bench(controller) as b:
        with pytest.raises(
            NotArrivedError, match=r"J1 is at 0\.00 deg instead of 10\.0000 deg.*look for a collision"
        ):
            await b.robot.move_joints(TARGET)


@pytest.mark.parametrize("motion", ["exec2", "exec"])
async def test_a_locked_machine_reports_no_arrival(motion: str) -> None:
    """Section 1.10: run bit 04. The controller says that the arm is there, and it has not moved."""
    controller = Controller()
    controller.flags = "A4060"
    async with bench(controller, motion=motion) as b:
        with pytest.raises(NotReadyError, match=r"machine lock is on.*does not make; switch it off"):
            await b.robot.move_joints(TARGET)
        assert controller.at == TARGET


async def test_a_lost_answer_of_a_locked_machine_is_no_arrival() -> None:
    controller = Controller()

    def arrives_unheard() -> Iterable[str]:
        controller.arrive()
        return []

    controller.replies["EXEC2"] = arrives_unheard
    controller.flags = "A4060"
    async with bench(controller, move_timeout_s=0.05) as b:
        with pytest.raises(NotReadyError, match="machine lock is on"):
            await b.robot.move_joints(TARGET)
        assert "STOP" in b.said_aside


async def test_the_resolution_of_the_protocol_is_no_deviation() -> None:
    """Section 1.11: JPOSF has two decimals."""
    controller = Controller()
    controller.arrives = False
    controller.at = (10.0, -20.5, 0.0, 30.25)
    async with bench(controller) as b:
        await b.robot.move_joints((10.0049, -20.4951, 0.0049, 30.2451))
        # Sent once, looked at once, and taken as it stands.
        assert b.said[-3:] == ["EXEC2=MOV JCATSEY1", "JPOSF", "STATE"]
        assert b.said.count("EXEC2=MOV JCATSEY1") == 1


@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
async def test_only_finite_targets_are_sent(bad: float) -> None:
    async with bench() as b:
        with pytest.raises(ValueError, match="finite"):
            await b.robot.move_joints((0.0, bad, 0.0, 0.0))
        assert not [c for c in b.said if c.startswith("EXEC")]


async def test_a_motion_with_a_lost_answer_is_not_resent() -> None:
    controller = Controller()

    def moves_without_answer() -> Iterable[str]:
        controller.arrive()
        return []

    controller.replies["EXEC2"] = moves_without_answer
    async with bench(controller, move_timeout_s=0.5) as b:
        await b.robot.move_joints(TARGET)
        assert b.said.count("EXEC2=MOV JCATSEY1") == 1
        assert b.said_aside[1:3] == ["STATE", "JPOSF"]
        assert "STOP" not in b.said_aside + b.said


async def test_a_lost_answer_without_arrival_stops_and_raises() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller, move_timeout_s=0.5) as b:
        with pytest.raises(
            NotArrivedError, match=r"answer to the motion is lost.*stands elsewhere.*J1 is at 0\.00"
        ):
            await b.robot.move_joints(TARGET)
        assert b.said.count("EXEC2=MOV JCATSEY1") == 1
        assert "STOP" in b.said_aside


async def test_an_arm_that_still_approaches_its_target_is_waited_for() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = lambda: ["\x02?"]
    places = iter([(2.0 * k, -4.1 * k, 0.0, 6.05 * k) for k in range(6)])
    controller.replies["JPOSF"] = lambda: [JPOS.format(*next(places, TARGET))]
    controller.flags = "E0060"
    async with bench(controller) as b:
        await b.robot.move_joints(TARGET)
        assert "STOP" not in b.said_aside + b.said


async def test_a_doubled_answer_does_not_end_the_motion_early() -> None:
    """The double of the answer to the assignment comes behind the motion and is taken for that to it."""
    places = iter([START] * 5 + [(share * 10.0, share * -20.5, 0.0, share * 30.25) for share in (0.1, 0.5)])
    controller = Controller()
    controller.replies["JPOSF"] = lambda: [JPOS.format(*next(places, TARGET))]
    async with bench(controller) as b:
        await b.robot.move_joints(TARGET)
        assert b.said.count("EXEC2=MOV JCATSEY1") == 1
        assert "STOP" not in b.said_aside


async def test_an_arm_that_leaves_its_way_is_stopped() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = lambda: ["\x02?"]
    places = iter([(2.0, 0.0, 0.0, 0.0), (3.0, 0.0, 0.0, 0.0), (3.0, 0.1, 0.0, 0.0)])
    controller.replies["JPOSF"] = lambda: [JPOS.format(*next(places, START))]
    controller.flags = "E0060"
    controller.replies["STOP"] = controller.halt
    async with bench(controller) as b:
        with pytest.raises(NotArrivedError, match=r"moves elsewhere .* was told to stop"):
            await b.robot.move_joints(TARGET)
        assert "STOP" in b.said_aside


def test_an_unanswered_motion_is_noticed_within_two_seconds() -> None:
    """The arm has long arrived, and nobody waits for the whole time that a motion may take."""

    async def moved() -> float:
        controller = Controller()

        def arrives_unheard() -> Iterable[str]:
            controller.arrive()
            return []

        controller.replies["EXEC2"] = arrives_unheard
        async with bench(controller) as b:
            loop = asyncio.get_running_loop()
            began_s = loop.time()
            await b.robot.move_joints(TARGET)
            assert b.said.count("EXEC2=MOV JCATSEY1") == 1
            return loop.time() - began_s

    assert run(moved()) < 2.0


async def test_status_during_a_motion_uses_the_third_connection() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = list
    controller.flags = "E0060"
    async with Peer(controller.answer, endpoint="memory://status") as third, bench(controller) as b:
        robot = MelfaR3(
            b.main.transport,
            b.aside.transport,
            b.clock,
            MelfaSettings(**QUICK),
            status_transport=third.transport,
            variable="JCATSEY1",
        )
        await b.robot.close()
        await robot.connect()
        before = len(b.said_aside)
        moving = asyncio.create_task(robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEY1" in b.said)
        assert (await robot.status()).running
        controller.arrive()
        await b.main.say(b"QoK")
        await moving
        assert third.requests == [b"1;1;OPEN=CATSEYE\r", b"1;1;STATE\r"]
        assert len(b.said_aside) == before
        await robot.close()


async def test_a_lost_assignment_is_made_again() -> None:
    controller = Controller()
    lost: Iterator[Iterable[str]] = iter([[]])
    controller.replies["EXECJCATSEY1"] = lambda: next(lost, ["QoK"])
    controller.target = TARGET
    async with bench(controller) as b:
        await b.robot.move_joints(TARGET)
        assert sum(said.startswith("EXECJCATSEY1") for said in b.said) == 2
        assert b.said.count("EXEC2=MOV JCATSEY1") == 1


async def test_a_motion_answered_by_garbage_is_not_resent() -> None:
    controller = Controller()

    def garbles() -> Iterable[str]:
        controller.arrive()
        return ["\x02?"]

    controller.replies["EXEC2"] = garbles
    async with bench(controller) as b:
        await b.robot.move_joints(TARGET)
        assert b.said.count("EXEC2=MOV JCATSEY1") == 1


async def test_a_motion_on_a_silent_controller_is_a_link_error() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = list
    for command in ("STATE", "JPOSF"):
        controller.replies[command] = list
    async with bench(controller, move_timeout_s=0.01, answer_timeout_s=0.05) as b:
        with pytest.raises(LinkError, match="standstill is not confirmed: PRESS THE EMERGENCY STOP"):
            await b.robot.move_joints(TARGET)
        assert "STOP" in b.said_aside


async def test_a_lost_assignment_moves_nothing() -> None:
    controller = Controller()
    controller.replies["EXECJCATSEY1"] = list
    async with bench(controller) as b:
        with pytest.raises(LinkTimeoutError, match="EXECJCATSEY1"):
            await b.robot.move_joints(TARGET)
        assert "EXEC2=MOV JCATSEY1" not in b.said


async def test_motions_can_be_polled_for_controllers_without_exec2() -> None:
    """Section 1.9: EXEC answers when accepted; EXEC2 is not on CRn-500."""
    controller = Controller()
    controller.arrives = False
    polls = 0

    def state() -> Iterable[str]:
        nonlocal polls
        polls += 1
        # The run bit comes late: nothing runs yet at the first poll.
        if polls == 3:
            controller.at = TARGET
        return [STATE.format(flags="E0060" if polls == 2 else "A0060")]

    controller.replies["STATE"] = state
    async with bench(controller, motion="exec") as b:
        await b.robot.move_joints(TARGET)
    assert polls == 3
    assert "EXECMOV JCATSEY1" in b.said


async def test_a_refused_query_does_not_repeat_a_polled_motion() -> None:
    controller = Controller()
    async with bench(controller, motion="exec") as b:
        refusals = iter([["QeR601000000"]])

        def states() -> Iterable[str]:
            moving = any(said.startswith("EXECMOV") for said in b.said)
            return next(refusals, [STATE.format(flags="A0060")]) if moving else [STATE.format(flags="A0060")]

        controller.replies["STATE"] = states
        await b.robot.move_joints(TARGET)
        assert sum(said.startswith("EXECMOV") for said in b.said) == 1
        assert await b.robot.joints() == TARGET


async def test_a_question_refused_behind_the_answer_leaves_no_arm_driving() -> None:
    """That answer may have been the late double of another one: the arm is on its way."""
    controller = Controller()
    controller.arrives = False
    controller.replies["EXEC2"] = lambda: ["QoK"]
    async with bench(controller) as b:
        refusals: Iterator[Iterable[str]] = iter([["QeR381000000"]])
        controller.replies["JPOSF"] = lambda: next(refusals, controller.usual("JPOSF"))
        with pytest.raises(NotArrivedError, match="refused while the arm may move"):
            await b.robot.move_joints(TARGET)
        assert "STOP" in b.said_aside


async def test_a_doubled_answer_to_the_assignment_keeps_the_motion_back() -> None:
    controller = Controller()
    controller.suffix = "\r"
    doubled: Iterator[Iterable[str]] = iter([["QoK\rQoK"]])
    controller.replies["EXECJCATSEY1"] = lambda: next(doubled, ["QoK"])
    controller.target = TARGET
    async with bench(controller) as b:
        await b.robot.move_joints(TARGET)
        assert sum(said.startswith("EXECJCATSEY1") for said in b.said) == 2
        assert b.said.count("EXEC2=MOV JCATSEY1") == 1
        assert "STOP" not in b.said + b.said_aside


async def test_a_question_kept_back_sends_no_motion_again() -> None:
    """Its link needs more than all attempts to get in step: that says nothing of the motion before it."""
    controller = Controller()
    controller.suffix = "\r"

    def moves_and_answers_twice() -> Iterable[str]:
        controller.arrive()
        return ["QoK\rQoK"]

    controller.replies["EXEC2"] = moves_and_answers_twice
    rights = iter([["QoK"], *[["QoK", "QoK"]] * ATTEMPTS])
    controller.replies["CNTLON"] = lambda: next(rights, ["QoK"])
    async with bench(controller) as b:
        await b.robot.move_joints(TARGET)
        assert b.said.count("EXEC2=MOV JCATSEY1") == 1
        assert b.said.count("CNTLON") == 1 + ATTEMPTS


async def test_a_link_healed_by_a_question_gets_the_target_again() -> None:
    """The watch asks between assignment and motion, and heals the link that the assignment has left out of step."""
    controller = Controller()
    controller.suffix = "\r"
    looks: list[asyncio.Task[RobotStatus]] = []

    async with bench(controller) as b:

        def doubled_once() -> Iterable[str]:
            if looks:
                return ["QoK"]
            looks.append(asyncio.create_task(b.robot.status()))
            return ["QoK\rQoK"]

        await b.robot.move_joints(TARGET)
        controller.replies["EXECJCATSEY1"] = doubled_once
        before = len(b.said)
        await b.robot.move_joints(TARGET)
        await asyncio.gather(*looks)
        said = b.said[before:]
        motion = said.index("EXEC2=MOV JCATSEY1")
        assert said.index("OPEN=CATSEYE") < motion
        assert said[motion - 2] == "EXECDEF JNT JCATSEY1"
        assert said[motion - 1].startswith("EXECJCATSEY1=")
        assert said.count("EXEC2=MOV JCATSEY1") == 1


@pytest.mark.parametrize("name", ["tolerance_deg", "tolerance_mm"])
def test_a_tolerance_ends_where_an_arm_counts_as_moved(name: str) -> None:
    MelfaSettings.model_validate({name: SAME_PLACE})
    with pytest.raises(ValidationError, match=r"less than or equal to 0\.03"):
        MelfaSettings.model_validate({name: SAME_PLACE + 0.001})
