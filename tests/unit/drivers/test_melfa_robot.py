"""The robot driver against scripted controllers. Bytes come from the protocol sheet, sections given."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from contextlib import asynccontextmanager
from typing import Any

import pytest
from pydantic import ValidationError

from drivers.errors import (
    AlarmError,
    LinkError,
    LinkTimeoutError,
    NotArrivedError,
    NotReadyError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from drivers.melfa.robot import MelfaR3
from drivers.melfa.settings import MelfaSettings
from drivers.memory import MemoryTransport
from tests.unit.drivers.peers import Peer, StepClock, until

# Section 1.8: sixteen fields and a trailing semicolon; patterns 0F of a four-axis RH are inferred there.
OPEN = (
    "QoK0F;0F;7,0;3,5,A,1E,32,46,64;MB5;PRM;RH-3FRH5515-D;CR75x;MELFA;17-10-06;Ver.S7e;ENG;{copyright};1;3;8;"
)
# Section 1.10: A0 operation right and servo, E0 these and running, 80 servo off, 88 TEACH; stop status 60 or 01.
STATE = "QoK;0;20;0;{flags};0;1;;;;;;;;;REP;START;1;0"
# Section 1.11, with the four axes of an RH.
JPOS = "QoKJ1;{:.2f};J2;{:.2f};J3;{:.2f};J4;{:.2f};;****,****;20;0.00;00000000"
TARGET = (10.0, -20.5, 0.0, 30.25)
START = (0.0, 0.0, 0.0, 0.0)
QUICK: dict[str, Any] = {"quiet_s": 0.001, "answer_timeout_s": 0.2}


class Controller:
    """Answers as the sheet's transcripts do; tests replace single answers."""

    def __init__(self) -> None:
        self.at: tuple[float, ...] = START
        self.flags = "A0060"
        self.alarm = ""
        self.override = "20"
        self.copyright = "COPYRIGHT(C) someone"
        self.suffix = ""
        self.arrives = True
        self.replies: dict[str, Callable[[], Iterable[str]]] = {}
        self.target = START

    def answer(self, data: bytes) -> Iterable[bytes]:
        command = data.decode().strip().removeprefix("1;1;")
        replies = self.replies.get(command.partition("=")[0], lambda: self.usual(command))()
        return [(reply + self.suffix).encode() for reply in replies]

    def usual(self, command: str) -> Iterable[str]:
        match command.partition("="):
            case "OPEN", _, _:
                return [OPEN.format(copyright=self.copyright)]
            case "STATE", _, _:
                return [STATE.format(flags=self.flags)]
            case "JPOSF", _, _:
                return [JPOS.format(*self.at)]
            case "ERROR", _, _:
                return [f"Qok{self.alarm};2" if self.alarm else "QoK"]
            case "OVRD", "=", percent:
                self.override = percent
                return [f"QoK{percent}"]
            case "OVRD", _, _:
                return [f"QoK{self.override}"]
            case "EXECJCATSEYE", _, values:
                self.target = tuple(float(v) for v in values.strip("()").split(","))  # type: ignore[assignment]
            case "EXEC2", _, _:
                self.arrive()
            case "EXECMOV JCATSEYE", _, _:
                self.arrive()
        return ["Qok" if self.alarm else "QoK"]

    def halt(self) -> Iterable[str]:
        self.flags = "A0060"
        return ["QoK"]

    def arrive(self) -> None:
        if self.arrives:
            self.at = self.target


class Bench:
    """A driver with its two connections."""

    def __init__(self, controller: Controller, main: Peer, aside: Peer, **settings: Any) -> None:
        self.controller, self.main, self.aside = controller, main, aside
        self.clock = StepClock()
        self.robot = MelfaR3(
            main.transport, aside.transport, self.clock, MelfaSettings(**{**QUICK, **settings})
        )

    @property
    def said(self) -> list[str]:
        """Commands on the first connection."""
        return [data.decode().strip().removeprefix("1;1;") for data in self.main.requests]

    @property
    def said_aside(self) -> list[str]:
        """Commands on the stop connection."""
        return [data.decode().strip().removeprefix("1;1;") for data in self.aside.requests]


@asynccontextmanager
async def bench(
    controller: Controller | None = None, *, connect: bool = True, **settings: Any
) -> AsyncIterator[Bench]:
    """Run a controller with two connections, connect, close at the end."""
    controller = controller or Controller()
    async with (
        Peer(controller.answer, endpoint="memory://robot") as main,
        Peer(controller.answer, endpoint="memory://stop") as aside,
    ):
        made = Bench(controller, main, aside, **settings)
        if connect:
            await made.robot.connect()
        yield made
        await made.robot.close()


@pytest.mark.parametrize("suffix", ["", "\r", "\r\n"])
async def test_the_life_of_a_session(suffix: str) -> None:
    """Sections 1.2, 1.8, 1.9: OPEN first, CLOSE last, for controllers with any answer terminator."""
    controller = Controller()
    controller.suffix = suffix
    async with bench(controller, connect=False) as b:
        identity = await b.robot.connect()
        assert (identity.model, identity.firmware, identity.serial) == (
            "RH-3FRH5515-D (CR75x)",
            "Ver.S7e",
            "3",
        )
        assert not identity.simulated
        assert await b.robot.set_override(20) == 20.0
        await b.robot.servo(on=True)
        await b.robot.move_joints(TARGET)
        assert await b.robot.joints() == TARGET
        await b.robot.close()
        await b.robot.close()
    assert b.said == [
        "OPEN=CATSEYE",
        "CNTLON",
        "OVRD=20",
        "OVRD",
        "SRVON",
        "STATE",
        "EXECDEF JNT JCATSEYE",
        "EXECJCATSEYE=(10.0000,-20.5000,0.0000,30.2500)",
        "EXEC2=MOV JCATSEYE",
        "JPOSF",
        "JPOSF",
        "CNTLOFF",
        "CLOSE",
    ]
    assert b.said_aside == ["OPEN=CATSEYE", "CLOSE"]
    assert b.robot.notes == ()


async def test_requests_end_in_cr_and_carry_robot_and_slot() -> None:
    """Sections 1.2 and 1.5."""
    async with bench() as b:
        assert b.main.requests[0] == b"1;1;OPEN=CATSEYE\r"


async def test_an_emulator_is_recognised() -> None:
    controller = Controller()
    controller.copyright = "catseye Emulator"
    async with bench(controller, connect=False) as b:
        assert (await b.robot.connect()).simulated


async def test_another_robot_is_refused_unless_it_is_expected() -> None:
    async with bench(connect=False, expected_model="RH-6FRH55") as b:
        with pytest.raises(
            WrongDeviceError, match=r"'RH-3FRH5515-D'.*expected is a 'RH-6FRH55'.*expected_model"
        ):
            await b.robot.connect()
        assert not b.main.transport.is_open
    async with bench(connect=False, expected_model="") as b:
        assert (await b.robot.connect()).model.startswith("RH-3FRH5515-D")


@pytest.mark.parametrize(
    ("first", "shown"),
    [
        ("SSH-2.0-OpenSSH_9.2\r\n", "SSH-2.0"),
        ("HTTP/1.1 400 Bad Request\r\n\r\n", "HTTP/1.1"),
        ("1;1;OPEN=CATSEYE\r", "1;1;OPEN"),
        ("E01\r\n", "E01"),
        ("QoK\r", "QoK"),
    ],
)
async def test_a_stranger_is_named_by_its_first_bytes(first: str, shown: str) -> None:
    controller = Controller()
    controller.replies["OPEN"] = lambda: [first]
    async with bench(controller, connect=False) as b:
        with pytest.raises(WrongDeviceError, match=rf"memory://robot: no MELFA controller.*{shown}.*10001"):
            await b.robot.connect()


async def test_a_stranger_that_speaks_first_is_named_by_its_greeting() -> None:
    controller = Controller()
    controller.replies["OPEN"] = list
    async with bench(controller, connect=False) as b:
        connecting = asyncio.create_task(b.robot.connect())
        await until(lambda: b.main.transport.is_open)
        await b.main.say(b"220 FTP ready\r\n")
        with pytest.raises(WrongDeviceError, match="220 FTP ready"):
            await connecting


async def test_a_silent_port_is_a_timeout() -> None:
    controller = Controller()
    controller.replies["OPEN"] = list
    async with bench(controller, connect=False) as b:
        with pytest.raises(LinkTimeoutError, match=r"memory://robot: no answer to b'1;1;OPEN=CATSEYE\\r'"):
            await b.robot.connect()


async def test_status_takes_one_request() -> None:
    """Section 1.10: A0060 is operation right and servo, paused."""
    async with bench() as b:
        status = await b.robot.status()
        assert (status.servo_on, status.operation_enabled, status.running) == (True, True, False)
        assert (status.teach_mode, status.emergency_stop, status.override_percent) == (False, False, 20.0)
        assert (status.alarm_number, status.alarm_text) == (0, "")
    assert b.said[1:2] == ["STATE"]


@pytest.mark.parametrize(("flags", "teach", "stop"), [("09060", True, False), ("80010", False, True)])
async def test_status_tells_teach_mode_and_emergency_stop(flags: str, teach: bool, stop: bool) -> None:
    """Section 1.10: run bit 08, stop bit 01."""
    controller = Controller()
    controller.flags = flags
    async with bench(controller) as b:
        status = await b.robot.status()
        assert (status.teach_mode, status.emergency_stop) == (teach, stop)


async def test_status_in_an_alarm_asks_for_it() -> None:
    """Sections 1.6, 1.13: error 2164 in STATE, its level in ERROR."""
    controller = Controller()
    controller.flags, controller.alarm = "80002164", "2164"
    async with bench(controller) as b:
        status = await b.robot.status()
        assert status.alarm_number == 2164
        assert status.alarm_text.startswith("alarm H2164: joint limit reached upwards, J4; jog")
    assert b.said[1:3] == ["STATE", "ERROR"]


async def test_reading_takes_no_operation_right() -> None:
    """Section 1.7: no read needs it, nor STOP, nor RSTALRM; also not after the link was healed."""
    controller = Controller()
    controller.replies["PNRMEJAR"] = lambda: ["QoKMEJAR;-170,170,-145,145,0,150,-360,360;16"]
    async with bench(controller) as b:
        await b.robot.status()
        await b.robot.joints()
        await b.robot.joint_limits()
        await b.robot.reset_alarm()
        await b.robot.stop()
        controller.replies["RSTALRM"] = list
        with pytest.raises(LinkTimeoutError):
            await b.robot.reset_alarm()
        await b.robot.joints()
    assert b.said == [
        *["OPEN=CATSEYE", "STATE", "JPOSF", "PNRMEJAR", "RSTALRM", "ERROR", "RSTALRM"],
        *["OPEN=CATSEYE", "JPOSF", "CLOSE"],
    ]


@pytest.mark.parametrize(
    ("act", "command"),
    [
        (lambda robot: robot.servo(on=True), "SRVON"),
        (lambda robot: robot.set_override(10), "OVRD=10"),
        (lambda robot: robot.move_joints(TARGET), "EXECDEF JNT JCATSEYE"),
    ],
)
async def test_the_first_command_that_needs_it_takes_the_right(
    act: Callable[[MelfaR3], Awaitable[object]], command: str
) -> None:
    """Section 1.7: SRVON, OVRD= and EXEC need it; it is taken once and given back."""
    async with bench() as b:
        await act(b.robot)
        await act(b.robot)
    assert b.said[:3] == ["OPEN=CATSEYE", "CNTLON", command]
    assert b.said.count("CNTLON") == 1
    assert b.said[-2:] == ["CNTLOFF", "CLOSE"]


async def test_the_drives_go_off_without_having_been_used_before() -> None:
    """Section 1.7: SRVOFF needs the right too."""
    controller = Controller()
    controller.flags = "80060"
    async with bench(controller) as b:
        await b.robot.servo(on=False)
    assert b.said[1:4] == ["CNTLON", "SRVOFF", "STATE"]


async def test_a_refused_right_is_told_and_leaves_the_state_readable() -> None:
    """Section 1.7: nobody knows when CNTLON is refused; TEACH must be reported rather than a closed door."""
    controller = Controller()
    controller.flags = "09060"
    controller.replies["CNTLON"] = lambda: ["QeR602000000"]
    async with bench(controller) as b:
        notes_before = b.robot.notes
        assert notes_before == ()
        with pytest.raises(NotReadyError, match="refused CNTLON: alarm L6020"):
            await b.robot.servo(on=True)
        assert "operation right is refused" in b.robot.notes[0]
        assert (await b.robot.status()).teach_mode
        assert "SRVON" not in b.said
        del controller.replies["CNTLON"]
        await b.robot.set_override(10)
        assert b.robot.notes == ()


async def test_a_refused_right_does_not_keep_the_drives_on() -> None:
    controller = Controller()
    controller.flags = "80060"
    controller.replies["CNTLON"] = lambda: ["QeR602000000"]
    async with bench(controller) as b:
        await b.robot.servo(on=False)
    assert "SRVOFF" in b.said
    assert "CNTLOFF" not in b.said


async def test_servo_waits_until_state_says_so() -> None:
    """Section 1.9: the answer to SRVON is immediate, the servo comes later."""
    states = iter(["80060", "80060", "A0060"])
    controller = Controller()
    controller.replies["STATE"] = lambda: [STATE.format(flags=next(states))]
    async with bench(controller) as b:
        before = b.clock.time_s
        await b.robot.servo(on=True)
        assert b.clock.time_s - before == pytest.approx(0.04)
    assert b.said[1:6] == ["CNTLON", "SRVON", "STATE", "STATE", "STATE"]


async def test_servo_that_does_not_come_names_what_to_check() -> None:
    controller = Controller()
    controller.flags = "80010"
    async with bench(controller, servo_timeout_s=0.01) as b:
        with pytest.raises(
            RefusedError, match=r"not on after 0\.01 s, emergency stop circuit open, key at AUTO"
        ):
            await b.robot.servo(on=True)


async def test_servo_is_refused_in_an_alarm_but_goes_off() -> None:
    controller = Controller()
    controller.alarm, controller.flags = "50", "80000"
    async with bench(controller) as b:
        with pytest.raises(AlarmError, match="alarm H0050: external emergency stop"):
            await b.robot.servo(on=True)
        await b.robot.servo(on=False)
    assert "SRVOFF" in b.said


async def test_override_is_read_back_and_never_rounded_up() -> None:
    """Section 1.9: OVRD=<1-100>."""
    controller = Controller()
    controller.replies["OVRD"] = lambda: ["QoK10"]
    async with bench(controller) as b:
        assert await b.robot.set_override(19.9) == 10.0
        for percent in (0.5, 101, float("nan")):
            with pytest.raises(ValueError, match="from 1 to 100"):
                await b.robot.set_override(percent)
    assert b.said[1:4] == ["CNTLON", "OVRD=19", "OVRD"]


async def test_joint_limits_come_from_the_controller() -> None:
    """Section 1.14: PNRMEJAR, -J1, +J1, ..."""
    controller = Controller()
    controller.replies["PNRMEJAR"] = lambda: [
        "QoKMEJAR;-170.00,170.00,-145.00,145.00,0.00,150.00,-360.00,360.00;16"
    ]
    async with bench(controller) as b:
        assert await b.robot.joint_limits() == (
            (-170.0, 170.0),
            (-145.0, 145.0),
            (0.0, 150.0),
            (-360.0, 360.0),
        )
        controller.replies["PNRMEJAR"] = lambda: ["QoKMEJAR;-170.00,170.00;16"]
        with pytest.raises(ProtocolError, match="2 values, 8 are needed"):
            await b.robot.joint_limits()


async def test_reset_alarm_looks_whether_it_is_gone() -> None:
    controller = Controller()
    controller.alarm = "50"
    async with bench(controller) as b:
        with pytest.raises(AlarmError) as caught:
            await b.robot.reset_alarm()
        assert caught.value.number == 50
        controller.alarm = ""
        await b.robot.reset_alarm()


async def test_a_move_takes_two_requests_and_one_check() -> None:
    async with bench() as b:
        await b.robot.move_joints(TARGET)
        before = len(b.said)
        await b.robot.move_joints((0.00004, -0.00004, 5.0, 1.23456))
    assert b.said[before : before + 3] == [
        "EXECJCATSEYE=(0.0000,0.0000,5.0000,1.2346)",
        "EXEC2=MOV JCATSEYE",
        "JPOSF",
    ]


async def test_a_definition_that_is_there_already_is_used() -> None:
    """Section 1.9: re-DEF gives 4350, which clients tolerate."""
    controller = Controller()
    controller.replies["EXECDEF JNT JCATSEYE"] = lambda: ["QeR435000000"]
    async with bench(controller) as b:
        await b.robot.move_joints(TARGET)
        assert controller.at == TARGET
    assert "RSTALRM" not in b.said


async def test_a_definition_that_leaves_an_alarm_is_reset() -> None:
    controller = Controller()
    alarms = iter(["Qok4350;2", "QoK"])
    controller.replies["EXECDEF JNT JCATSEYE"] = lambda: ["QeR435000000"]
    controller.replies["ERROR"] = lambda: [next(alarms)]
    async with bench(controller) as b:
        await b.robot.move_joints(TARGET)
    assert b.said[2:6] == ["EXECDEF JNT JCATSEYE", "ERROR", "RSTALRM", "ERROR"]


async def test_a_refused_motion_tells_meaning_and_remedy_and_moves_nothing() -> None:
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
async def test_a_controller_that_an_operator_has_to_look_at_is_not_ready(number: int) -> None:
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
    controller.replies["EXECDEF JNT JCATSEYE"] = lambda: ["QoK"]
    controller.replies["EXECJCATSEYE"] = lambda: ["QoK"]
    async with bench(controller) as b:
        with pytest.raises(AlarmError, match="L2000"):
            await b.robot.move_joints(TARGET)


@pytest.mark.parametrize(("reply", "not_ready"), [("QeR561000000", False), ("QeR005000000", True)])
async def test_only_the_stop_of_this_program_is_no_matter_for_an_operator(
    reply: str, not_ready: bool
) -> None:
    """Section 5.3: C5610 STOP on. An emergency stop during a stop of this program stays one."""
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEYE" in b.said)
        stopping = asyncio.create_task(b.robot.stop())
        await until(lambda: "STOP" in b.said_aside)
        await b.main.say(reply.encode())
        with pytest.raises(RefusedError) as caught:
            await moving
        await stopping
        assert isinstance(caught.value, NotReadyError) is not_ready


async def test_a_motion_that_a_stop_overtakes_does_not_begin() -> None:
    controller = Controller()
    controller.replies["EXECJCATSEYE"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: any(said.startswith("EXECJCATSEYE=") for said in b.said))
        await b.robot.stop()
        await b.main.say(b"QoK")
        with pytest.raises(RefusedError, match="stop overtook"):
            await moving
        assert not any("MOV" in said for said in b.said)


async def test_stop_that_is_on_long_after_the_stop_of_this_program_is_somebody_elses() -> None:
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


async def test_a_rejection_while_an_alarm_is_active_tells_both() -> None:
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


async def test_the_resolution_of_the_protocol_is_no_deviation() -> None:
    """Section 1.11: JPOSF has two decimals."""
    controller = Controller()
    controller.arrives = False
    controller.at = (10.0, -20.5, 0.0, 30.25)
    async with bench(controller) as b:
        await b.robot.move_joints((10.0049, -20.4951, 0.0049, 30.2451))


@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
async def test_only_finite_targets_are_sent(bad: float) -> None:
    async with bench() as b:
        with pytest.raises(ValueError, match="finite"):
            await b.robot.move_joints((0.0, bad, 0.0, 0.0))
        assert not [c for c in b.said if c.startswith("EXEC")]


async def test_a_lost_answer_to_a_motion_is_looked_up_and_not_sent_again() -> None:
    controller = Controller()

    def moves_without_answer() -> Iterable[str]:
        controller.arrive()
        return []

    controller.replies["EXEC2"] = moves_without_answer
    async with bench(controller, move_timeout_s=0.01) as b:
        await b.robot.move_joints(TARGET)
        assert b.said.count("EXEC2=MOV JCATSEYE") == 1
        assert b.said_aside[1:3] == ["STATE", "JPOSF"]
        assert "STOP" not in b.said_aside


async def test_a_lost_answer_of_a_robot_that_did_not_arrive_stops_and_raises() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller, move_timeout_s=0.01) as b:
        with pytest.raises(
            NotArrivedError, match=r"answer to the motion is lost.*stands elsewhere.*J1 is at 0\.00"
        ):
            await b.robot.move_joints(TARGET)
        assert b.said.count("EXEC2=MOV JCATSEYE") == 1
        assert "STOP" in b.said_aside


async def test_a_motion_that_takes_too_long_is_stopped() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = list
    states = iter(["E0060"])
    controller.replies["STATE"] = lambda: [STATE.format(flags=next(states, "A0060"))]
    async with bench(controller, move_timeout_s=0.01) as b:
        with pytest.raises(
            NotArrivedError, match="was still moving and was told to stop: raise move_timeout_s"
        ):
            await b.robot.move_joints(TARGET)


async def test_garbage_instead_of_the_end_of_a_motion_is_looked_up_too() -> None:
    controller = Controller()

    def garbles() -> Iterable[str]:
        controller.arrive()
        return ["\x02?"]

    controller.replies["EXEC2"] = garbles
    async with bench(controller) as b:
        await b.robot.move_joints(TARGET)
        assert b.said.count("EXEC2=MOV JCATSEYE") == 1


async def test_a_lost_answer_and_a_silent_controller_is_an_error_of_the_link() -> None:
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
    controller.replies["EXECJCATSEYE"] = list
    async with bench(controller) as b:
        with pytest.raises(LinkTimeoutError, match="EXECJCATSEYE"):
            await b.robot.move_joints(TARGET)
        assert "EXEC2=MOV JCATSEYE" not in b.said


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
        "EXECDEF JNT JCATSEYE",
        "EXECJCATSEYE=(0.0000,0.0000,0.0000,0.0000)",
        "EXEC2=MOV JCATSEYE",
    ]


@pytest.mark.parametrize(("found", "left"), [("10", "10"), ("15", "15"), ("40", "15"), ("15.5", "15")])
async def test_healing_lowers_the_override_but_never_raises_it(found: str, left: str) -> None:
    controller = Controller()
    async with bench(controller) as b:
        await b.robot.set_override(15)
        controller.replies["RSTALRM"] = list
        with pytest.raises(LinkTimeoutError):
            await b.robot.reset_alarm()
        controller.override = found
        before = len(b.said)
        await b.robot.joints()
        assert controller.override == left
        lowered = ["OVRD=15"] if found != left else []
        assert b.said[before:] == ["OPEN=CATSEYE", "CNTLON", "OVRD", *lowered, "JPOSF"]


async def test_a_right_that_was_refused_while_healing_comes_back_with_the_override() -> None:
    controller = Controller()
    async with bench(controller) as b:
        await b.robot.set_override(15)
        controller.replies["RSTALRM"] = list
        with pytest.raises(LinkTimeoutError):
            await b.robot.reset_alarm()
        controller.replies["CNTLON"] = lambda: ["QeR602000000"]
        assert await b.robot.joints() == START
        assert "operation right is refused" in b.robot.notes[0]
        del controller.replies["CNTLON"]
        controller.override = "40"
        before = len(b.said)
        await b.robot.move_joints(TARGET)
        assert b.said[before : before + 3] == ["CNTLON", "OVRD", "OVRD=15"]
        assert b.robot.notes == ()


async def test_nothing_moves_while_the_override_cannot_be_restored() -> None:
    controller = Controller()
    async with bench(controller) as b:
        await b.robot.set_override(15)
        controller.replies["RSTALRM"] = list
        with pytest.raises(LinkTimeoutError):
            await b.robot.reset_alarm()
        controller.replies["CNTLON"] = lambda: ["QeR602000000"]
        await b.robot.joints()
        del controller.replies["CNTLON"]
        controller.replies["OVRD"] = lambda: ["QeR601000000"]
        for _ in range(2):
            with pytest.raises(RefusedError, match="refused OVRD"):
                await b.robot.move_joints(TARGET)
    assert not [c for c in b.said if c.startswith("EXEC")]


async def test_a_new_connection_has_forgotten_the_override_of_the_old_one() -> None:
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


async def test_questions_are_asked_again_once() -> None:
    answers = iter([[], [JPOS.format(*START)]])
    controller = Controller()
    controller.replies["JPOSF"] = lambda: next(answers)
    async with bench(controller) as b:
        assert await b.robot.joints() == START


async def test_an_answer_of_another_layout_makes_the_driver_distrust_the_link() -> None:
    controller = Controller()
    controller.suffix = "\r"
    controller.replies["JPOSF"] = lambda: ["QoK100"]
    async with bench(controller) as b:
        with pytest.raises(ProtocolError, match=r"memory://robot: JPOSF: .*last bytes b'QoK100\\r'"):
            await b.robot.joints()
        del controller.replies["JPOSF"]
        assert await b.robot.joints() == START
        assert b.said.count("OPEN=CATSEYE") == 2


async def test_stop_goes_past_a_motion_that_waits() -> None:
    """EXEC2 answers at the end only (section 1.9); STOP takes the other connection and needs no right (1.7)."""
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEYE" in b.said)
        await b.robot.stop()
        assert b.said_aside == ["OPEN=CATSEYE", "STOP", *["STATE", "JPOSF"] * 3]
        assert "CNTLON" not in b.said_aside
        assert not moving.done()
        await b.main.say(b"QoK")
        with pytest.raises(NotArrivedError):
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


async def test_cancelling_a_motion_stops_the_robot_and_leaves_the_link_to_be_healed() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEYE" in b.said)
        moving.cancel()
        await until(lambda: "STOP" in b.said_aside)
        moving.cancel()
        with pytest.raises(asyncio.CancelledError):
            await moving
        assert b.said_aside.count("STOP") == 1
        assert b.said_aside[-1] == "JPOSF"
        assert await b.robot.joints() == START
    assert b.said[b.said.index("EXEC2=MOV JCATSEYE") + 1 :][:3] == ["OPEN=CATSEYE", "CNTLON", "JPOSF"]


async def test_a_stop_that_fails_is_told_although_the_motion_was_cancelled() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller, stop_timeout_s=0.02) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEYE" in b.said)
        controller.flags = "E0060"
        moving.cancel()
        with pytest.raises(LinkError, match="PRESS THE EMERGENCY STOP"):
            await moving


async def test_without_a_second_connection_motions_are_polled_and_stop_goes_between() -> None:
    """Section 1.15: one source claims that a port serves one client only."""
    controller = Controller()
    async with Peer(controller.answer, endpoint="memory://robot") as main:
        nobody = MemoryTransport("memory://nobody")
        clock = StepClock()
        robot = MelfaR3(main.transport, nobody, clock, MelfaSettings(**QUICK))
        await robot.connect()
        assert "stop_endpoint" in robot.notes[0]
        controller.arrives = False
        controller.flags = "E0060"
        moving = asyncio.create_task(robot.move_joints(TARGET))
        await until(lambda: b"1;1;EXECMOV JCATSEYE\r" in main.requests)
        controller.replies["STOP"] = controller.halt
        await robot.stop()
        with pytest.raises(NotArrivedError):
            await moving
        await robot.close()
    assert b"1;1;STOP\r" in main.requests
    assert not [data for data in main.requests if b"EXEC2" in data]


async def test_a_broken_stop_connection_shouts_on_the_first_one() -> None:
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEYE" in b.said)
        await b.aside.far.close()
        await b.aside.far.open()
        await b.robot.stop()
        assert b.said[b.said.index("EXEC2=MOV JCATSEYE") + 1] == "STOP"
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
    assert "EXECMOV JCATSEYE" in b.said


async def test_close_does_not_wait_for_a_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("drivers.melfa.robot._CLOSE_TIMEOUT_S", 0.01)
    controller = Controller()
    controller.replies["EXEC2"] = list
    async with bench(controller) as b:
        moving = asyncio.create_task(b.robot.move_joints(TARGET))
        await until(lambda: "EXEC2=MOV JCATSEYE" in b.said)
        await b.robot.close()
        with pytest.raises(LinkError):
            await moving


def test_settings_are_strict() -> None:
    with pytest.raises(ValidationError, match="move_timeout"):
        MelfaR3.at("tcp://127.0.0.1:1", StepClock(), move_timeout=5)
    with pytest.raises(ValidationError, match="exec2"):
        MelfaSettings(motion="jog")  # type: ignore[arg-type]


def test_endpoints_are_checked_before_anything_is_opened() -> None:
    with pytest.raises(LinkError, match="port must be a number"):
        MelfaR3.at("tcp://127.0.0.1", StepClock())
    with pytest.raises(LinkError, match="device path must follow"):
        MelfaR3.at("tcp://127.0.0.1:1", StepClock(), stop_endpoint="serial://")
    with pytest.raises(LinkError, match="set terminator"):
        MelfaR3.at("serial:///dev/ttyUSB0?baud=9600", StepClock(), terminator="")


async def test_a_question_refused_during_a_polled_motion_is_accounted_for_and_the_motion_stays_one() -> None:
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
