"""Signals, log, variables, positions and monitors of the emulated controller (sheet, sections 1.11 to 1.14)."""

import re

import pytest

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.errors import EmulatorError
from catseye.simulators.melfa.choices import Choices
from catseye.simulators.melfa.commands.table import COMMANDS
from tests.unit.simulators.melfa.desk import Desk, with_axes


def test_outputs_are_single_bits() -> None:
    robot = Desk().client()
    robot.do("OUT=16;00ff")
    assert robot.ask("OUT16") == "QoK00FF"
    assert robot.ask("OUT12") == "QoK0FF0"
    assert robot.ask("OUT20") == "QoK000F"
    robot.do("RSTIO")
    assert robot.ask("OUT16") == "QoK0000"


def test_inputs_show_what_was_written_while_pseudo_inputs_are_on() -> None:
    robot = Desk().client()
    robot.do("IN=8;0005")
    assert robot.ask("IN8") == "QoK0000"
    robot.do("INDMY")
    assert robot.ask("IOSIGNAL8;0") == "QoK00050000"
    # Section 1.10: the bit of pseudo input.
    assert robot.ask("DSTATE").startswith("QoK0152")
    robot.do("INSET")
    assert robot.ask("IN8") == "QoK0000"


def test_registers_are_sixteen_decimals_from_6000() -> None:
    robot = Desk().client()
    robot.do("DOUT=6001;00ff")
    assert robot.ask("DOUT6000") == "QoK0;255" + ";0" * 14
    assert robot.ask("DIN6000") == "QoK0" + ";0" * 15
    assert robot.ask("DIN5999") == "QeR660000000"


def test_hand_states_are_eight_triples() -> None:
    robot = Desk().client()
    assert robot.ask("HNDSTS") == "QoK900;2;0" + ";-1;-1;-1" * 7
    robot.do("HNDON1")
    assert robot.ask("HNDSTS").startswith("QoK900;1;0;")
    assert robot.ask("USERAREASTS") == "QoK00"
    assert robot.ask("CALIB") == "QoKN0F0F"


def test_the_error_log_is_read_filtered_counted_and_cleared() -> None:
    desk = Desk()
    robot = desk.client()
    for number in (2602, 9200, 2602):
        desk.bench.advance(1.0)
        desk.controller.raise_alarm(number)
    robot.do("RSTALRM")
    assert robot.ask("ERRORLOGTOP").startswith("QoK26-01-01;00:00:03;2602;")
    assert robot.ask("ERRORLOG+1") == "QoK26-01-01;00:00:02;9200;Emulated alarm;C;;0;920000000"
    assert robot.ask("ERRORLOGEND").startswith("QoK26-01-01;00:00:01;2602;")
    assert robot.ask("ERRORLOG+1") == "QoK"
    assert robot.ask("ERRLOG2=TOP;3;").endswith(";C;;0;920000000")
    assert robot.ask("ERRSUM1").startswith("QoK2;260200000;L;Destination outside the joint limits;")
    assert robot.ask("ERRSUM1").endswith(";2")
    assert robot.ask("ERRSUM2=2") == "QoK2;920000000;C;Emulated alarm;;;1;26-01-01;00:00:02"
    assert robot.ask("ERRSUM3") == "QoK2;000000000;;;;;0"
    robot.do("ERRLOGCLR3")
    assert robot.ask("ERRSUM1").startswith("QoK1;")
    robot.do("ERRLOGCLR0")
    assert robot.ask("ERRORLOGTOP") == "QoK"


def test_variables_are_listed_by_type() -> None:
    robot = Desk().client()
    robot.do("VAL=M1=3", "VAL=M2=-4.5", "VAL=J1=(1,2,3,4)", "VAL=M_01=7")
    assert robot.ask("VALTOP;M") == "QoKM1=+3"
    assert robot.ask("VAL+1;M") == "QoKM2=-4.5"
    assert robot.ask("VAL+1;M") == "QoK"
    assert robot.ask("VALSTOP;M") == "QoKM1=+3\vM2=-4.5;2;0"
    assert robot.ask("GVALSTOP;M") == "QoKM_01=+7;1;0"
    assert robot.ask("GVALM_01") == "QoKM_01=+7"
    assert robot.ask("VTYPRDJ1") == "QoKJ"
    robot.do(*(f"VAL=M{n}=1" for n in range(100, 160)))
    first = robot.ask("VALSTOP;M")
    assert first.endswith(";1")
    assert len(first) < 400


def test_positions_of_every_kind() -> None:
    robot = Desk(with_axes(6)).client().ready()
    robot.do("EXEC2=MOV (30,60,10,-45)")
    assert robot.ask("XPOSF").startswith("QoKX;281.46;Y;387.50;Z;10.00;J4;-45.00;J5;0.00;J6;0.00;;4,0;")
    # atan2(387.5, 281.458) = 54.009 deg at a radius of 478.93 mm.
    assert robot.ask("RPOSF").startswith("QoKR;478.93;T;54.01;Z;10.00;A;0.00;B;0.00;C;45.00;;4,0;")
    assert robot.ask("XPOS4").startswith("QoKJ4;-45.00;;")


def test_monitors_return_eight_axes() -> None:
    desk = Desk(choices=Choices(pulses_per_unit=100.0))
    robot = desk.client().ready()
    robot.do("EXEC2=MOV (30,60,10,-45)")
    encoders = robot.ask("SRVENC").removeprefix("QoK").split(";")
    assert len(encoders) == 32
    assert (encoders[0], encoders[4], encoders[8], encoders[12]) == ("3000", "6000", "1000", "-4500")
    assert robot.ask("SRVDRP") == "QoK" + ";".join(["0"] * 16)
    assert robot.ask("SRVSPD") == "QoK" + ";".join(["0"] * 24)
    robot.do("OVRD=10", "EXECMOV (90,60,10,-45)")
    desk.bench.advance(0.15)
    # A tenth of the largest speed, after a ramp of 42 / 2000 s: feedback, largest and command of each axis.
    assert robot.ask("SRVSPD") == "QoK10;10;10;" + ";".join(["0"] * 21)
    assert robot.ask("SRVCUR1") == "QoK3.00;3.00;3.00;" + ";".join(["0.00"] * 21)
    assert robot.ask("SRVLCR") == "QoK3.00;3.00;" + ";".join(["0.00"] * 14)
    desk.bench.advance(10.0)
    assert robot.ask("SRVSPD") == "QoK0;10;0;" + ";".join(["0"] * 21)
    robot.do("SVMONRST=1")
    assert robot.ask("SRVSPD") == "QoK" + ";".join(["0"] * 24)


@pytest.mark.parametrize(
    ("command", "count"),
    [
        ("SRVSPD", 24),
        ("SRVCUR0", 32),
        ("SRVCUR1", 24),
        ("SRVLCR", 16),
        ("SRVVOL", 11),
        ("PTIME", 22),
        ("EMISS", 8),
    ],
)
def test_monitors_have_the_fields_of_the_sheet(command: str, count: int) -> None:
    """Section 1.14: layouts of the monitor commands."""
    answer = Desk().client().ask(command)
    assert answer.startswith("QoK")
    assert answer.count(";") == count - 1


def test_smaller_monitors() -> None:
    robot = Desk().client()
    assert robot.ask("PTIME") == "QoK0;0;0;0;0;" + "0;" * 12 + "0;0;0;14000;1"
    assert robot.ask("ENCBATTM") == "QoK0;14000"
    assert robot.ask("OPNUMRD") == "QoK1"
    # Section 1.14: address, real-time port 10000, OPT11 to OPT19 at 10001 to 10009.
    options = robot.ask("OPSTSRD")
    assert all(text in options for text in ("192.168.0.20", "10000", "OPT11=10001,", "OPT19=10009,"))
    assert robot.ask("SLOTRD") == "QoK;REP;START;1"


def test_in_teach_the_right_is_gone_and_refused() -> None:
    desk = Desk()
    robot = desk.client().ready()
    robot.do("EXECMOV (90,0,0,0)")
    desk.bench.advance(0.1)
    desk.controller.set_teach_mode(on=True)
    desk.bench.advance(1.0)
    assert 0.0 < desk.bench.joints[0] < 90.0
    assert robot.ask("DSTATE").startswith("QoK2912")
    assert robot.ask("EXECMOV (0,0,0,0)") == "QeR602000000"
    assert robot.ask("CNTLON") == "QeR500000000"
    desk.controller.set_teach_mode(on=False)
    assert robot.ask("CNTLON") == "QoK"
    lenient = Desk(choices=Choices(teach_keeps_right=True))
    lenient.controller.set_teach_mode(on=True)
    assert lenient.client().ask("CNTLON") == "QoK"


def test_the_right_can_be_exclusive() -> None:
    desk = Desk(choices=Choices(exclusive_right=True))
    first, second = desk.client(), desk.client()
    first.do("CNTLON", "CNTLON")
    assert second.ask("CNTLON") == "QeR602000000"
    first.do("CLOSE")
    second.do("CNTLON")


@pytest.mark.parametrize(
    "word", ["PRTVERLISTL", "CHGPRT=HC", "SNREAD=", "PARCRC=NETIP", "JOGST", "FQUIT", "MESTRD02"]
)
def test_undocumented_words_are_illegal(word: str) -> None:
    assert Desk().client().ready().ask(word) == "QeR601000000"


def test_on_a_serial_line_only_a_terminator_ends_a_request() -> None:
    robot = Desk().client("\r", segments=False)
    assert robot.send(b"1;1;STATE") == []
    assert robot.session.silence_s() is None
    assert robot.send(b"\r") == [b"QoK;0;100;0;01120;0;1;;;;;;;;;REP;START;1;0\r"]


def test_no_argument_upsets_a_command() -> None:
    robot = Desk().client().ready()
    for word in sorted(COMMANDS):
        for arguments in ("", "1", "TOP", ";", "A;B;C;D;E", "-", "=", "\xb2", "1;\xb2", "9" * 30):
            assert re.match(r"Qo[Kk]|Qe[Rr]\d{9}", robot.ask(word + arguments)), word + arguments


def test_what_is_not_known_is_chosen_by_options() -> None:
    device = EmulatedDevice(
        "robot", "melfa-r3", options={"exclusive_right": True, "jog_percent": 5, "slot": 1}
    )
    choices = Choices.of(device)
    assert (choices.exclusive_right, choices.teach_keeps_right, choices.jog_percent) == (True, False, 5)
    with pytest.raises(EmulatorError, match=r"robot: option exclusive_right: .*valid boolean"):
        Choices.of(EmulatedDevice("robot", "melfa-r3", options={"exclusive_right": "yes"}))
