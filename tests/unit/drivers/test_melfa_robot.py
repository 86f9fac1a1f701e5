"""The robot driver against scripted controllers: session, state, right, drives, override."""

import asyncio
from collections.abc import Awaitable, Callable

import pytest
from pydantic import ValidationError

from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.errors import (
    AlarmError,
    LinkError,
    LinkTimeoutError,
    NotReadyError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from tests.patience import until
from tests.unit.drivers.melfa_bench import STATE, TARGET, Controller, bench, lose_an_answer
from tests.unit.drivers.peers import StepClock


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
        "EXECDEF JNT JCATSEY1",
        "EXECJCATSEY1=(10.0000,-20.5000,0.0000,30.2500)",
        "EXEC2=MOV JCATSEY1",
        "JPOSF",
        "STATE",
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
async def test_status_reports_teach_mode_and_emergency_stop(flags: str, teach: bool, stop: bool) -> None:
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
        await lose_an_answer(b)
        await b.robot.joints()
    assert b.said == [
        *["OPEN=CATSEYE", "STATE", "JPOSF", "PNRMEJAR", "RSTALRM", "ERROR", "STOP"],
        *["OPEN=CATSEYE", "RSTALRM", "OPEN=CATSEYE", "JPOSF", "CLOSE"],
    ]


@pytest.mark.parametrize(
    ("act", "command"),
    [
        (lambda robot: robot.servo(on=True), "SRVON"),
        (lambda robot: robot.set_override(10), "OVRD=10"),
        (lambda robot: robot.move_joints(TARGET), "EXECDEF JNT JCATSEY1"),
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


async def test_a_refused_right_is_reported_and_leaves_the_state_readable() -> None:
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


def test_settings_are_strict() -> None:
    with pytest.raises(ValidationError, match="move_timeout"):
        MelfaR3.at("tcp://127.0.0.1:1", StepClock(), move_timeout=5)
    with pytest.raises(ValidationError, match="exec2"):
        MelfaSettings(motion="jog")  # type: ignore[arg-type]  # the wrong value is the test


def test_endpoints_are_checked_before_anything_is_opened() -> None:
    with pytest.raises(LinkError, match="port must be a number"):
        MelfaR3.at("tcp://127.0.0.1", StepClock())
    with pytest.raises(LinkError, match="device path must follow"):
        MelfaR3.at("tcp://127.0.0.1:1", StepClock(), stop_endpoint="serial://")
    with pytest.raises(LinkError, match="set terminator"):
        MelfaR3.at("serial:///dev/ttyUSB0?baud=9600", StepClock(), terminator="")
