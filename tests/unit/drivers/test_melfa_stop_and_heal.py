"""STOP and healing of the robot driver against scripted controllers."""

import asyncio
from collections.abc import Iterable

import pytest

from catseye.app.testing.memory import MemoryTransport
from catseye.drivers.links.healing import ATTEMPTS
from catseye.drivers.links.record import RecordingTransport
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.errors import (
    LinkError,
    LinkTimeoutError,
    NotArrivedError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from tests.patience import until
from tests.unit.drivers.melfa_bench import (
    JPOS,
    OPEN,
    QUICK,
    START,
    STATE,
    TARGET,
    Controller,
    bench,
    lose_an_answer,
)
from tests.unit.drivers.peers import Peer, StepClock


async def test_after_healing_right_override_and_variable_are_there_again() -> None:
    """The controller forgets a connection's right when it drops (section 1.7, likely)."""
    controller = Controller()
    async with bench(controller) as b:
        await b.robot.set_override(15)
        await b.robot.move_joints(TARGET)
        controller.replies["OVRD"] = list
        with pytest.raises(LinkTimeoutError):
            await b.robot.set_override(20)
        del controller.replies["OVRD"]
        before = len(b.said)
        await b.robot.move_joints(START)
    assert b.said[before : before + 6] == [
        "OPEN=CATSEYE",
        "CNTLON",
        "OVRD",
        "EXECDEF JNT JCATSEY1",
        "EXECJCATSEY1=(0.0000,0.0000,0.0000,0.0000)",
        "EXEC2=MOV JCATSEY1",
    ]


@pytest.mark.parametrize(("found", "left"), [("10", "10"), ("15", "15"), ("40", "15"), ("15.5", "15")])
async def test_healing_lowers_the_override_but_never_raises_it(found: str, left: str) -> None:
    controller = Controller()
    async with bench(controller) as b:
        await b.robot.set_override(15)
        await lose_an_answer(b)
        controller.override = found
        before = len(b.said)
        await b.robot.joints()
        assert controller.override == left
        lowered = ["OVRD=15"] if found != left else []
        assert b.said[before:] == ["OPEN=CATSEYE", "CNTLON", "OVRD", *lowered, "JPOSF"]


async def test_a_right_refused_while_healing_returns_with_the_override() -> None:
    controller = Controller()
    async with bench(controller) as b:
        await b.robot.set_override(15)
        await lose_an_answer(b)
        controller.replies["CNTLON"] = lambda: ["QeR602000000"]
        assert await b.robot.joints() == START
        assert "operation right is refused" in b.robot.notes[0]
        del controller.replies["CNTLON"]
        controller.override = "40"
        before = len(b.said)
        await b.robot.move_joints(TARGET)
        assert b.said[before : before + 3] == ["CNTLON", "OVRD", "OVRD=15"]
        assert b.robot.notes == ()


async def test_a_right_refused_while_healing_is_retaken_before_motion() -> None:
    """Else the motion would go out without the right, at whatever override is in force by now."""
    controller = Controller()
    async with bench(controller) as b:
        await b.robot.set_override(15)
        await b.robot.move_joints(TARGET)
        await lose_an_answer(b)
        controller.override = "40"
        refused = iter([["QeR602000000"]])
        controller.replies["CNTLON"] = lambda: next(refused, ["QoK"])
        before = len(b.said)
        await b.robot.move_joints(START)
        assert b.said[before : before + 6] == [
            "OPEN=CATSEYE",
            "CNTLON",
            "CNTLON",
            "OVRD",
            "OVRD=15",
            "EXECDEF JNT JCATSEY1",
        ]


async def test_nothing_moves_while_the_override_cannot_be_restored() -> None:
    controller = Controller()
    async with bench(controller) as b:
        await b.robot.set_override(15)
        await lose_an_answer(b)
        controller.replies["CNTLON"] = lambda: ["QeR602000000"]
        await b.robot.joints()
        del controller.replies["CNTLON"]
        controller.replies["OVRD"] = lambda: ["QeR601000000"]
        for _ in range(2):
            with pytest.raises(RefusedError, match="refused OVRD"):
                await b.robot.move_joints(TARGET)
    assert not [c for c in b.said if c.startswith("EXEC")]


async def test_a_new_connection_forgets_the_old_override() -> None:
    controller = Controller()
    async with bench(controller) as b:
        await b.robot.set_override(15)
        await b.robot.close()
        controller.override = "40"
        await b.robot.connect()
        await b.robot.move_joints(TARGET)
    assert controller.override == "40"


async def test_a_controller_that_was_exchanged_meanwhile_is_refused() -> None:
    controller = Controller()
    async with bench(controller) as b:
        controller.replies["STATE"] = list
        with pytest.raises(LinkTimeoutError):
            await b.robot.status()
        controller.replies["OPEN"] = lambda: [OPEN.format(copyright="c").replace(";1;3;8;", ";1;4;8;")]
        with pytest.raises(WrongDeviceError, match=r"serial '4', answers instead of the .* serial '3'"):
            await b.robot.status()


async def test_questions_are_asked_again() -> None:
    answers = iter([[], [JPOS.format(*START)]])
    controller = Controller()
    controller.replies["JPOSF"] = lambda: next(answers)
    async with bench(controller) as b:
        assert await b.robot.joints() == START


async def test_an_unexpected_answer_layout_puts_the_link_in_doubt() -> None:
    controller = Controller()
    controller.suffix = "\r"
    controller.replies["JPOSF"] = lambda: ["QoK100"]
    async with bench(controller) as b:
        with pytest.raises(ProtocolError, match=r"memory://robot: JPOSF: .*last bytes b'QoK100\\r'"):
            await b.robot.joints()
        del controller.replies["JPOSF"]
        assert await b.robot.joints() == START
        assert b.said.count("JPOSF") == ATTEMPTS + 1
        assert b.said.count("OPEN=CATSEYE") == ATTEMPTS + 1


async def test_stop_goes_past_a_motion_that_waits() -> None:
    """EXEC2 answers at the end only (section 1.9); STOP takes the other connection and needs no right (1.7)."""
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEY1" in b.said)
        await b.robot.stop()
        # Past everything at once, then on the connection that is healed for the look.
        assert b.said_aside == ["OPEN=CATSEYE", "STOP", "OPEN=CATSEYE", "STOP", *["STATE", "JPOSF"] * 3]
        assert b.said[-1] == "STOP"
        assert "CNTLON" not in b.said_aside
        assert not moving.done()
        await b.main.say(b"QoK")
        with pytest.raises(RefusedError, match="stop overtook"):
            await moving


async def test_stop_is_a_separate_request_without_a_terminator() -> None:
    """Behind a request that was not read yet it would be its continuation (section 1.2)."""
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller, terminator="") as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEY1" in b.said)
        await b.robot.stop()
        assert b"\r1;1;STOP\r" in b.main.requests
        await b.main.say(b"QoK")
        with pytest.raises(RefusedError, match="stop overtook"):
            await moving


async def test_stop_waits_for_standstill() -> None:
    controller = Controller()
    places = iter([(1.0, 0.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0)])
    states = iter(["E0060"])
    controller.replies["STATE"] = lambda: [STATE.format(flags=next(states, "A0060"))]
    controller.replies["JPOSF"] = lambda: [JPOS.format(*next(places, (2.5, 0.0, 0.0, 0.0)))]
    async with bench(controller) as b:
        await b.robot.stop()
        await b.robot.stop()
    assert b.said_aside.count("JPOSF") == 5 + 3


async def test_stop_that_is_not_followed_by_standstill_says_so() -> None:
    controller = Controller()
    controller.flags = "E0060"
    async with bench(controller, stop_timeout_s=0.02) as b:
        with pytest.raises(
            LinkError, match=r"standstill is not confirmed: PRESS .*does not stand still after 0\.02 s"
        ):
            await b.robot.stop()


async def test_cancelling_a_motion_stops_the_robot_and_heals_later() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEY1" in b.said)
        moving.cancel()
        await until(lambda: "STOP" in b.said_aside)
        moving.cancel()
        with pytest.raises(asyncio.CancelledError):
            await moving
        assert b.said_aside[-1] == "JPOSF"
        assert await b.robot.joints() == START
    behind = b.said[b.said.index("EXEC2=MOV JCATSEY1") + 1 :]
    assert behind[:4] == ["STOP", "OPEN=CATSEYE", "CNTLON", "JPOSF"]


async def test_a_failed_stop_is_raised_despite_the_cancellation() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller, stop_timeout_s=0.02) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEY1" in b.said)
        controller.flags = "E0060"
        moving.cancel()
        with pytest.raises(LinkError, match="PRESS THE EMERGENCY STOP"):
            await moving


async def test_a_single_connection_polls_motions_and_still_stops() -> None:
    """Section 1.15: one source claims that a port serves one client only."""
    controller = Controller()
    async with Peer(controller.answer, endpoint="memory://robot") as main:
        nobody = MemoryTransport("memory://nobody")
        clock = StepClock()
        robot = MelfaR3(main.transport, nobody, clock, MelfaSettings(**QUICK), variable="JCATSEY1")
        await robot.connect()
        assert "stop_endpoint" in robot.notes[0]
        controller.arrives = False
        controller.flags = "E0060"
        moving = asyncio.create_task(robot.move_joints(TARGET))
        await until(lambda: b"1;1;EXECMOV JCATSEY1\r" in main.requests)
        controller.replies["STOP"] = controller.halt
        await robot.stop()
        with pytest.raises(RefusedError, match="stop overtook"):
            await moving
        await robot.close()
    assert b"1;1;STOP\r" in main.requests
    assert not [data for data in main.requests if b"EXEC2" in data]


async def test_a_broken_stop_connection_falls_back_to_the_first() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEY1" in b.said)
        await b.aside.far.close()
        await b.aside.far.open()
        await b.robot.stop()
        assert b.said[b.said.index("EXEC2=MOV JCATSEY1") + 1] == "STOP"
        assert "STOP" in b.said_aside
        with pytest.raises(NotArrivedError):
            await moving


async def test_stop_that_cannot_be_sent_calls_for_the_emergency_stop() -> None:
    async with bench() as b:
        await b.aside.far.close()
        await b.main.far.close()
        for peer in (b.main, b.aside):
            await peer.transport.close()
        with pytest.raises(
            LinkError, match="STOP could not be sent on any connection: PRESS THE EMERGENCY STOP"
        ):
            await b.robot.stop()
        for peer in (b.main, b.aside):
            await peer.far.open()


async def test_stop_is_sent_as_soon_as_the_link_reopens() -> None:
    """The one connection is closed for healing when STOP is called; its greeting is not answered for a while."""
    controller = Controller()
    async with Peer(controller.answer, endpoint="memory://robot") as main:
        robot = MelfaR3(
            main.transport, None, StepClock(), MelfaSettings(**{**QUICK, "answer_timeout_s": 5.0})
        )
        await robot.connect()
        controller.replies["OPEN"] = list
        await main.transport.close()
        stopping = asyncio.create_task(robot.stop())
        # Real time passes here, as between two STOPs.
        while b"1;1;STOP\r" not in main.requests and not stopping.done():  # noqa: ASYNC110  # a list notifies nobody
            await asyncio.sleep(0.01)
        controller.replies["OPEN"] = lambda: [OPEN.format(copyright="c")]
        await main.say(b"?")
        await stopping
        assert b"1;1;STOP\r" in main.requests
        await robot.close()


async def test_close_does_not_wait_for_a_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("catseye.drivers.melfa.robot._CLOSE_TIMEOUT_S", 0.01)
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEY1" in b.said)
        await b.robot.close()
        with pytest.raises(LinkError):
            await moving


async def test_stop_is_written_before_reading_a_flood() -> None:
    """On every connection, before anything is waited for."""
    seen: list[tuple[str, str, bytes]] = []
    controller = Controller()

    def recorded(peer: Peer, name: str) -> RecordingTransport:
        return RecordingTransport(
            peer.transport, lambda direction, data: seen.append((name, direction, data))
        )

    async with (
        Peer(controller.answer, endpoint="memory://main") as main,
        Peer(controller.answer, endpoint="memory://stop") as stop,
        Peer(controller.answer, endpoint="memory://status") as status,
    ):
        robot = MelfaR3(
            recorded(main, "main"),
            recorded(stop, "stop"),
            StepClock(),
            MelfaSettings(**QUICK),
            status_transport=recorded(status, "status"),
        )
        await robot.connect()
        seen.clear()
        for peer in (main, stop, status):
            await peer.say(b"\r\n" * 100_000)
        await robot.stop()
        asked = b"1;1;STOP\r"
        assert seen[:3] == [("main", "tx", asked), ("stop", "tx", asked), ("status", "tx", asked)]
        await robot.close()


async def test_stop_goes_on_until_the_arm_is_seen_to_stand() -> None:
    """The arm moves on for half a second, as if the first STOP had not been heard."""
    controller = Controller()
    controller.flags = "E0060"
    async with bench(controller) as b:
        stopping = asyncio.create_task(b.robot.stop())
        await asyncio.sleep(0.5)
        assert b.said.count("STOP") > 2
        assert b.said_aside.count("STOP") > 2
        controller.flags = "A0060"
        await stopping


async def test_stop_does_not_wait_for_a_pending_answer() -> None:
    controller = Controller()
    controller.replies["JPOSF"] = list
    async with bench(controller) as b:
        asking = [
            asyncio.create_task(b.robot.account_for(TARGET, LinkTimeoutError("lost"))) for _ in range(2)
        ]
        await until(lambda: "JPOSF" in b.said_aside)
        del controller.replies["JPOSF"]
        at = len(b.said_aside)
        stopping = asyncio.create_task(b.robot.stop())
        await until(lambda: len(b.said_aside) > at)
        assert b.said_aside[at] == "STOP"
        await stopping
        await asyncio.gather(*asking, return_exceptions=True)


async def test_a_right_unanswered_while_healing_is_claimed_again() -> None:
    controller = Controller()
    async with bench(controller) as b:
        await b.robot.set_override(15)
        spoilt = iter([["\x02?"]])
        controller.replies["CNTLON"] = lambda: next(spoilt, ["QoK"])
        await lose_an_answer(b)
        before = len(b.said)
        await b.robot.move_joints(TARGET)
        assert b.said[before : before + 5] == ["OPEN=CATSEYE", "CNTLON", "OPEN=CATSEYE", "CNTLON", "OVRD"]


@pytest.mark.parametrize("number", [5420, 5430, 6010])
async def test_a_question_that_arrives_garbled_is_asked_again(number: int) -> None:
    """What the controller does not understand may have lost bytes on its way."""
    refusals = iter([[f"QeR{number}00000"]])
    controller = Controller()
    async with bench(controller) as b:
        controller.replies["JPOSF"] = lambda: next(refusals, [JPOS.format(*START)])
        before = len(b.said)
        assert await b.robot.joints() == START
    assert [text for text in b.said[before:] if text == "JPOSF"] == ["JPOSF"] * 2


async def test_a_question_refused_twice_is_refused() -> None:
    controller = Controller()
    async with bench(controller) as b:
        controller.replies["JPOSF"] = lambda: ["QeR601000000"]
        before = len(b.said)
        with pytest.raises(RefusedError, match="does not know the command"):
            await b.robot.joints()
    assert b.said[before:].count("JPOSF") == 2


async def test_a_harmless_order_that_arrives_garbled_is_given_again() -> None:
    refusals = iter([["QeR601000000"]])
    controller = Controller()

    def switched_off() -> Iterable[str]:
        if refusal := next(refusals, None):
            return refusal
        controller.flags = "80060"
        return ["QoK"]

    async with bench(controller) as b:
        controller.replies["SRVOFF"] = switched_off
        await b.robot.servo(on=False)
    assert b.said.count("SRVOFF") == 2


@pytest.mark.parametrize("garbled", ["QeR601000000", OPEN.format(copyright="").replace("RH-3F", "RH")])
async def test_a_greeting_that_is_garbled_is_said_again(garbled: str) -> None:
    """Proxy campaign: the link healed after a lost answer, and the model lost a character on its way."""
    answers = iter([[garbled]])
    controller = Controller()
    async with bench(controller) as b:
        await lose_an_answer(b)
        controller.replies["OPEN"] = lambda: next(answers, [OPEN.format(copyright="")])
        assert await b.robot.joints() == START
    assert b.said.count("OPEN=CATSEYE") == 3


async def test_a_first_greeting_that_arrives_garbled_is_said_again() -> None:
    answers = iter([["QeR601000000"]])
    controller = Controller()
    controller.replies["OPEN"] = lambda: next(answers, [OPEN.format(copyright="")])
    async with bench(controller) as b:
        assert await b.robot.joints() == START
