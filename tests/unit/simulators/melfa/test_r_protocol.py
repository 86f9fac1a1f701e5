"""The robot controller's answers, byte for byte, against the examples of the sheet `melfa`."""

import re
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from catseye.simulators.melfa.choices import Choices
from catseye.simulators.ports.session import Pending
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.melfa.desk import Desk


def test_open_identifies_the_robot_as_emulated() -> None:
    fields = Desk().client().ask("OPEN=USERTOOL").removeprefix("QoK").split(";")
    # Section 1.8: 16 fields, the last one followed by a semicolon.
    assert len(fields) == 17
    assert fields[:4] == ["27", "0F", "7,0", "3,5,A,1E,32,46,64"]
    assert fields[6] == "RH-3FRH5515-D"
    assert "EMULATOR" in fields[12]
    assert fields[16] == ""


def test_a_state_at_rest_is_that_of_the_sheet() -> None:
    # Section 1.10, example of an idle controller.
    assert Desk().client().ask("STATE") == "QoK;0;100;0;01120;0;1;;;;;;;;;REP;START;1;0"


def test_state_bits_follow_right_servo_motion_stop_and_alarm() -> None:
    desk = Desk()
    robot = desk.client()
    assert robot.ask("DSTATE") == "QoK01120;0;0"
    robot.ready()
    assert robot.ask("DSTATE") == "QoKA1120;0;0"
    assert robot.ask("EXECMOV (20,0,0,0)") == "QoK"
    # Of direct execution nothing runs that a STOP has stopped: the controller says so still.
    assert robot.ask("DSTATE") == "QoKE1120;0;1"
    desk.controller.raise_alarm(4220)
    desk.bench.advance(1.0)
    # Section 1.10: the composite A1, 12, error 4220; with an alarm the third letter is small.
    assert robot.ask("DSTATE") == "QokA1124220;0;0"
    assert robot.ask("ERROR") == "Qok4220;2"
    assert robot.ask("RSTALRM") == "QoK"
    assert robot.ask("ERROR") == "QoK"


def test_the_emergency_stop_shows_and_its_alarm_stays_until_reset() -> None:
    desk = Desk()
    robot = desk.client().ready()
    robot.ask("EXECMOV (20,0,0,0)")
    desk.controller.set_emergency_stop(on=True)
    desk.bench.advance(1.0)
    assert robot.ask("STATE") == "Qok;0;100;0;8113" + "50;0;1;;;;;;;;;REP;START;1;0"
    assert robot.ask("STPSIG") == "Qok0;1"
    assert robot.ask("RSTALRM") == "QeR005000000"
    assert robot.ask("SRVON") == "QeR513000000"
    desk.controller.set_emergency_stop(on=False)
    assert robot.ask("SRVON") == "QeR560000000"
    assert robot.ask("RSTALRM") == "QoK"
    assert robot.ask("SRVON") == "QoK"


@pytest.mark.parametrize(
    ("axes", "answer"),
    [
        (4, "QoKJ1;-16.28;J2;38.72;J3;102.51;J4;16.73;;****,****;75;0.00;00000000"),
        # Section 1.11: the layouts for 6 and 8 axes.
        (6, "QoKJ1;-16.28;J2;38.72;J3;102.51;J4;16.73;J5;0.00;J6;0.00;;****,****;75;0.00;00000000"),
        (
            8,
            "QoKJ1;-16.28;J2;38.72;J3;102.51;J4;16.73;J5;0.00;J6;0.00;J7;0.00;J8;0.00;;****,****;75;0.00;00000000",
        ),
    ],
)
def test_joint_answers_have_the_layout_of_the_sheet(axes: int, answer: str) -> None:
    config = replace(QUIET, axis_pattern=axes, start_joints=(-16.28, 38.72, 102.51, 16.73))
    robot = Desk(config).client()
    robot.ask("CNTLON")
    assert robot.ask("OVRD=75") == "QoK75"
    assert robot.ask("JPOSF") == answer
    assert robot.ask("JPOS") == answer


def test_one_axis_can_be_asked_for() -> None:
    robot = Desk(replace(QUIET, start_joints=(1.0, 2.0, 3.0, 4.0))).client()
    assert robot.ask("JPOS2") == "QoKJ2;2.00;;****,****;100;0.00;00000000"
    assert robot.ask("JPOS5") == "QeR601000000"


def test_positions_are_nominal_with_posture() -> None:
    robot = Desk(replace(QUIET, start_joints=(30.0, 60.0, 10.0, -45.0))).client()
    # 325 cos 30, 325 sin 30 + 225.
    assert robot.ask("PPOSF") == "QoKX;281.46;Y;387.50;Z;10.00;C;45.00;;4,0;100;0.00;00000000"
    robot = Desk(replace(QUIET, start_joints=(30.0, -60.0, 10.0, 0.0), axis_pattern=8)).client()
    # 325 cos 30 + 225 cos 30, 325 sin 30 - 225 sin 30.
    expected = "QoKX;476.31;Y;50.00;Z;10.00;A;0.00;B;0.00;C;-30.00;L1;0.00;L2;0.00;;0,0;100;0.00;00000000"
    assert robot.ask("PPOSF") == expected


def test_the_destination_is_known_while_the_arm_moves() -> None:
    robot = Desk().client().ready()
    assert robot.ask("EXECMOV (20,30,0,0)") == "QoK"
    assert robot.ask("GJPOSF").startswith("QoKJ1;20.00;J2;30.00;")
    assert robot.ask("JPOSF").startswith("QoKJ1;0.00;J2;0.00;")
    assert robot.ask("GPPOSF").startswith("QoKX;450.03;Y;")
    robot.desk.bench.advance(0.15)
    assert float(robot.ask("JPOSF").split(";")[-2]) > 100.0


def test_exec2_answers_at_the_end_of_the_motion() -> None:
    robot = Desk().client().ready()
    assert robot.ask("EXECJ1=(10.0004,20.0006,5,-30)") == "QoK"
    before_s = robot.desk.bench.time_s
    assert robot.ask("EXEC2=MOV J1") == "QoK"
    assert robot.desk.bench.time_s > before_s
    assert not robot.desk.bench.moving
    # The controller's step is 1 mdeg.
    assert robot.desk.bench.joints == (10.0, 20.001, 5.0, -30.0)


def test_another_clients_stop_ends_a_wait_with_an_error() -> None:
    desk = Desk()
    robot, stopper = desk.client().ready(), desk.client()
    (waiting,) = robot.send(b"1;1;EXEC2=MOV (90,0,0,0)\r")
    desk.bench.advance(0.2)
    assert stopper.ask("STOP") == "QoK"
    assert robot.finish(waiting) == "QeR561000000"
    assert 0.0 < desk.bench.joints[0] < 90.0
    assert not desk.bench.moving
    assert robot.ask("EXEC2=MOV (0,0,0,0)") == "QoK"


def test_a_latched_stop_refuses_motion_until_released() -> None:
    robot = Desk().client().ready()
    assert robot.ask("STOPON") == "QoK"
    assert robot.ask("STPSIG") == "QoK2;0"
    assert robot.ask("EXECMOV (1,0,0,0)") == "QeR561000000"
    assert robot.ask("STOPOFF") == "QoK"
    assert robot.ask("EXECMOV (1,0,0,0)") == "QoK"


def test_requests_behind_a_waiting_motion_are_carried_out_after_it() -> None:
    robot = Desk().client().ready()
    robot.session.feed(b"1;1;EXEC2=MOV (90,0,0,0)\r1;1;JPOS1\r")
    first = robot.session.answer()
    assert isinstance(first, Pending)
    assert robot.finish(first) == "QoK"
    assert robot.session.answer() == b"QoKJ1;90.00;;****,****;100;0.00;00000000"


def test_the_operation_right_belongs_to_one_connection() -> None:
    desk = Desk()
    first, second = desk.client(), desk.client()
    # Section 1.6, captured: no operation right.
    assert first.ask("SRVON") == "QeR602000000"
    assert first.ask("CNTLON") == "QoK"
    assert first.ask("OVRD=50") == "QoK50"
    for command in ("OVRD=50", "EXECMOV (0,0,0,0)", "EXEC2=MOV (0,0,0,0)", "SRVOFF", "RUN"):
        assert second.ask(command) == "QeR602000000"
    first.session.close()
    assert first.ask("OVRD=50") == "QeR602000000"


def test_the_servo_needs_its_time_and_motion_needs_the_servo() -> None:
    robot = Desk().client()
    robot.ask("CNTLON")
    assert robot.ask("EXECMOV (1,0,0,0)") == "QeR200000000"
    assert robot.ask("SRVON") == "QoK"
    assert robot.ask("VALM_SVO") == "QoKM_SVO=+0"
    assert robot.ask("EXECMOV (1,0,0,0)") == "QeR200000000"
    robot.desk.bench.advance(1.0)
    assert robot.ask("VALM_SVO") == "QoKM_SVO=+1"
    (waiting,) = robot.send(b"1;1;EXEC2=MOV (90,0,0,0)\r")
    robot.desk.bench.advance(0.1)
    robot.desk.controller.switch_servo_off()
    assert robot.finish(waiting) == "QeR200000000"
    assert robot.ask("EXECSERVO ON") == "QoK"
    assert robot.ask("EXECSERVO OFF") == "QoK"


def test_an_alarm_refuses_motion_until_it_is_reset() -> None:
    robot = Desk().client().ready()
    robot.desk.controller.raise_alarm(2160)
    assert robot.ask("EXECMOV (1,0,0,0)") == "QeR560000000"
    assert robot.ask("RSTALRM") == "QoK"
    # One of high level took the servo with it.
    assert robot.ask("EXECMOV (1,0,0,0)") == "QeR200000000"
    assert robot.ask("ERRORLOGTOP") == "QoK26-01-01;00:00:01;2160;Upper limit of an axis;H;;0;216000000"
    assert robot.ask("ERRORLOG-1") == "QoK"


def test_a_caution_stops_nothing() -> None:
    robot = Desk().client().ready()
    robot.desk.controller.raise_alarm(9200)
    # Section 1.13: level 3; it goes on all the same.
    assert robot.ask("ERROR") == "Qok9200;3"
    assert robot.ask("EXEC2=MOV (1,0,0,0)") == "Qok"
    assert robot.ask("ERRORLOGEND").endswith(";C;;0;920000000")


@pytest.mark.parametrize("target", ["(170.001,0,0,0)", "(0,-145.1,0,0)", "(0,0,-1,0)", "(0,0,0,361)"])
def test_a_target_outside_the_limits_is_refused_before_motion(target: str) -> None:
    robot = Desk().client().ready()
    assert robot.ask(f"EXECMOV {target}") == "QeR260200000"
    assert robot.desk.bench.joints == (0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("statement", "number"), [("MOV (180,0,0,0)", 2602), ("MVS (600,0,10,0,0,0)(4,0)", 2802)]
)
def test_a_target_out_of_reach_leaves_its_alarm(statement: str, number: int) -> None:
    robot = Desk().client().ready()
    assert robot.ask(f"EXEC{statement}") == f"QeR{number}00000"
    assert robot.ask("ERROR").startswith(f"Qok{number};2")
    # Section 5.3: a low level leaves the drives on; section 6: nothing moves until the reset.
    assert robot.desk.controller.servo_on
    assert robot.ask("EXECMOV (10,0,0,0)") == "QeR560000000"
    assert robot.ask("RSTALRM") == "QoK"
    assert robot.ask("EXECMOV (10,0,0,0)") == "QoK"


def test_a_controller_may_refuse_a_target_without_an_alarm() -> None:
    robot = Desk(choices=Choices(limit_raises_alarm=False)).client().ready()
    assert robot.ask("EXECMOV (180,0,0,0)") == "QeR260200000"
    assert robot.ask("EXECMOV (10,0,0,0)") == "QoK"


def test_cartesian_targets_are_solved_for_the_posture() -> None:
    robot = Desk().client().ready()
    assert robot.ask("EXEC2=MOV (281.458256,387.5,10,,,45)(4,0)") == "QoK"
    assert robot.desk.bench.joints == (30.0, 60.0, 10.0, -45.0)
    # 325 cos 30 + 225 cos 30, 325 sin 30 - 225 sin 30: the left-handed pose (30, -60).
    robot.ask("EXECP1=(476.313972,50,10,0,0,-30) (0,0)")
    # No straight way leads to another posture.
    assert robot.ask("EXEC2=MVS P1") == "QeR281000000"
    robot.do("RSTALRM")
    assert robot.ask("EXEC2=MOV P1") == "QoK"
    assert robot.desk.bench.joints == (30.0, -60.0, 10.0, 0.0)
    assert robot.ask("EXEC2=MOV P_CURR+(10,0,0,0,0,0)") == "QoK"
    assert robot.ask("PPOSF").startswith("QoKX;486.31;Y;50.00;")
    assert robot.ask("EXECMOV (600,0,0,0,0,0)(4,0)") == "QeR280200000"


def test_variables_are_defined_written_and_read() -> None:
    robot = Desk().client().ready()
    assert robot.ask("EXECDEF JNT JCOSIROP") == "QoK"
    assert robot.ask("EXECdef jnt jcosirop") == "QeR435000000"
    assert robot.ask("EXECJCOSIROP = (1,2,3,4,5,6)") == "QoK"
    assert robot.ask("VALJCOSIROP") == "QoKJCOSIROP=(+1.00,+2.00,+3.00,+4.00)"
    assert robot.ask("VAL=P1=(400.13,0,644.62,180,0,180)(7,0)") == "QoK"
    # Section 1.14: the layout of a position value.
    assert robot.ask("VALP1") == "QoKP1=(+400.13,+0.00,+644.62,+0.00,+0.00,+180.00)(7,0)"
    robot.do("LOAD=MOVEIT", "SAVE")
    assert robot.ask("HOTMoveit;M1=3") == "QoK"
    assert robot.ask("VALM1") == "QoKM1=+3"
    assert robot.ask("VALJ9") == "QeR434000000"
    assert robot.ask("EXECMOV J9") == "QeR434000000"
    assert robot.ask("EXECJ1=P1") == "QeR422000000"


def test_speeds_multiply() -> None:
    robot = Desk().client().ready()
    robot.ask("OVRD=50.0")
    assert robot.ask("OVRD") == "QoK50"
    robot.ask("EXECOVRD 50")
    robot.ask("EXECJOVRD 20")
    assert robot.desk.controller.effective_percent == pytest.approx(5.0)
    assert robot.ask("VALM_JOVRD") == "QoKM_JOVRD=+20"
    robot.ask("EXECOVRD M_NOVRD")
    robot.ask("EXECJOVRD M_NJOVRD")
    assert robot.desk.controller.effective_percent == pytest.approx(50.0)
    assert robot.ask("EXECSPD M_NSPD") == "QoK"
    assert robot.ask("EXECACCEL 50,80") == "QoK"
    assert robot.desk.controller.accel_percent == 50.0


@pytest.mark.parametrize(
    ("command", "answer"),
    [
        ("OVRD=0", "QeR311000000"),
        ("OVRD=101", "QeR311000000"),
        ("OVRD=x", "QeR422000000"),
        ("OVRD=1_0", "QeR422000000"),
        ("EXECOVRD 0", "QeR311000000"),
        ("EXECOVRD", "QeR311000000"),
        ("EXECFLY 1", "QeR422000000"),
        ("EXECMOV (1,2", "QeR422000000"),
        ("EXECMOV (nan,0,0,0)", "QeR422000000"),
        ("EXECMOV (1E99,0,0,0)", "QeR311000000"),
        ("EXECMOV M_SVO", "QeR422000000"),
        ("EXEC", "QeR422000000"),
        ("STATEX", "QeR601000000"),
        ("PRTVERLISTL", "QeR601000000"),
        ("RUNABC;1", "QeR414000000"),
        ("RUN", "QeR510000000"),
        ("PRGLOAD=COSIROP", "QeR414000000"),
        ("OUT=999;0001", "QeR660000000"),
        ("PNRNOTHING", "QeR311000000"),
    ],
)
def test_what_cannot_be_is_refused_with_its_number(command: str, answer: str) -> None:
    robot = Desk().client().ready()
    assert robot.ask(command) == answer


@pytest.mark.parametrize(
    ("command", "answer"),
    [
        ("PARRLNG", "QoKRLNG;1;1"),
        ("PARMEXTL", "QoKMEXTL;0.00, 0.00, 0.00, 0.00, 0.00, 0.00;6"),
        ("RSTPRG", "QoK"),
        ("SLOTINIT", "QoK"),
        ("CSTOP", "QoK"),
        ("LISTCNT", "QoK0000"),
        ("PDIRTOP", "QoK"),
        ("TIME", "QoK26-01-0100:00:01"),
        ("OUT=16;00ff", "QoK"),
        ("IN16", "QoK0000"),
        ("HNDON1", "QoK"),
        ("EXECHOPEN 1", "QoK"),
        ("EXECTOOL (0,0,0,0,0,0)", "QoK"),
        ("EXECBASE P_NBASE", "QoK"),
        ("ERRORMES2000", "QoKServo is off"),
        ("CNTLOFF", "QoK"),
        ("CLOSE", "QoK"),
    ],
)
def test_small_commands_answer_as_in_the_sheet(command: str, answer: str) -> None:
    robot = Desk().client().ready()
    assert robot.ask(command) == answer


def test_outputs_and_limits_are_kept() -> None:
    robot = Desk().client()
    robot.ask("OUT=16;00ff")
    assert robot.ask("OUT16") == "QoK00FF"
    assert robot.ask("PNRMEJAR").startswith(
        "QoKMEJAR;-170.00, 170.00, -145.00, 145.00, 0.00, 150.00, -360.00, 360.00"
    )


def test_a_motion_is_refused_while_another_runs() -> None:
    robot = Desk().client().ready()
    robot.ask("EXECMOV (90,0,0,0)")
    assert robot.ask("EXECMOV (0,0,0,0)") == "QeR564000000"


@pytest.mark.parametrize("prefix", ["1;1;", "1;9;", "1;-1;", ";;", "", "0;0;"])
def test_robot_and_slot_may_be_left_out(prefix: str) -> None:
    robot = Desk().client()
    assert robot.send(f"{prefix}OVRD\r".encode()) == [b"QoK100"]


@pytest.mark.parametrize(("prefix", "number"), [("4;1;", 5430), ("1;34;", 5120), ("1;-2;", 5120)])
def test_robots_and_slots_that_do_not_exist_are_refused(prefix: str, number: int) -> None:
    robot = Desk().client()
    assert robot.send(f"{prefix}OVRD\r".encode()) == [f"QeR{number}00000".encode()]


@pytest.mark.parametrize("end", [b"\r", b"\n", b"\r\n"])
def test_any_terminator_ends_a_request(end: bytes) -> None:
    robot = Desk().client()
    assert robot.send(b"1;1;OVRD" + end + b"1;1;ERROR" + end) == [b"QoK100", b"QoK"]


def test_an_unambiguous_word_without_terminator_is_answered_immediately() -> None:
    robot = Desk().client()
    assert robot.send(b"1;1;STATE") == [b"QoK;0;100;0;01120;0;1;;;;;;;;;REP;START;1;0"]
    # STOP could become STOPON, OVRD could become OVRD=10: these wait for the pause.
    for command, answer in ((b"1;1;STOP", b"QoK"), (b"1;1;OVRD", b"QoK100")):
        assert robot.send(command) == []
        assert robot.session.silence_s() == pytest.approx(0.005)
        robot.session.idle()
        assert robot.answers() == [answer]
        assert robot.session.silence_s() is None


def test_the_suffix_is_appended() -> None:
    assert Desk().client("\r\n").send(b"1;1;OVRD\r") == [b"QoK100\r\n"]
    assert Desk().client("\r").send(b"1;1;NONSENSE\r") == [b"QeR601000000\r"]


def test_a_request_too_long_is_refused_once() -> None:
    robot = Desk().client()
    assert robot.send(b"1;1;EXEC" + b"A" * 248 + b"\r") == [b"QeR608000000"]
    assert robot.send(b"B" * 1000) == []
    assert robot.send(b"B" * 1000) == []
    assert robot.send(b"B\r1;1;OVRD\r") == [b"QeR608000000", b"QoK100"]


def test_replayed_answers_are_refused_and_the_line_stays_in_step() -> None:
    # Section 1.14: one client sends recorded answers as if they were commands.
    robot = Desk().client()
    assert robot.send(b"3F;3F;7,0;3,5,A,1E,32,46,64;MB4\r1;1;OVRD\r") == [b"QeR601000000", b"QoK100"]


def test_every_request_is_noted() -> None:
    desk = Desk()
    desk.client().ask("OVRD")
    assert desk.heard == ["1;1;OVRD"]


STREAM = (
    b"1;1;OPEN=USERTOOL\r\n1;1;CNTLON\r1;1;OVRD=20\n1;1;STATE\r\n1;1;JPOSF\r\n1;1;EXECJ1=(1,2,3,4)\r\n"
    b"1;1;VALJ1\r\n1;1;STOP\r\n1;1;NONSENSE\r\nERROR\r\n"
)


@given(st.lists(st.integers(0, len(STREAM)), max_size=8))
def test_any_cut_of_a_stream_gives_the_same_answers(cuts: list[int]) -> None:
    whole = Desk().client().send(STREAM)
    robot = Desk().client()
    places = [0, *sorted(cuts), len(STREAM)]
    parts = [STREAM[a:b] for a, b in pairwise(places)]
    assert [answer for part in parts for answer in robot.send(part)] == whole
    assert len(whole) == 10


WORDS = st.sampled_from(
    (
        b"1;1;|EXEC|EXEC2=|MOV |VAL|VAL=|(|)|,|;|\r|\v|J1|P1=|9|-1|+1|TOP|LOAD=A|EDATA|EDINS=|DELETE|RENUM|LISTL|"
        b"SAVE|RUNA|RSTPRG|STOP|JOG00;00;00;01;00|FOPENA;w|FWRITE|FREAD|FCLOSE|PRM=|PMR=|HOT|VALS|CNTLON"
    ).split(b"|")
)


@given(st.lists(st.one_of(st.binary(max_size=40), WORDS), max_size=40).map(b"".join))
@example(b"1;1;VAL=P1=(" + b"9" * 200 + b",0,0,0,0,0)\r1;1;EXECMOV P1\r")
@example(b"1;1;ERRORMES-5\r1;1;JPOS\xb2\r1;99999999999;STATE\r\xb2;1;STATE\r")
def test_random_bytes_give_an_error_or_nothing(data: bytes) -> None:
    robot = Desk().client().ready()
    said = robot.send(data)
    robot.session.idle()
    said += robot.answers()
    for answer in said:
        assert re.match(r"Qo[Kk]|QeR\d{9}$|Qer\d{9};", robot.finish(answer))
        robot.desk.bench.advance(0.05)
    assert robot.finish(robot.send(b"\r1;1;OVRD\r")[-1]).lower().startswith("qok")


def test_state_shows_a_stop_signal_while_it_is_on() -> None:
    """Section 1.10: stop bit 08; section 1.9: STOPON holds it until STOPOFF."""
    robot = Desk().client()
    robot.do("STOP")
    assert robot.ask("DSTATE") == "QoK01120;0;0"
    robot.do("STOPON")
    assert robot.ask("DSTATE") == "QoK011A0;0;0"
    assert robot.ask("STPSIG") == "QoK2;0"
    robot.do("STOPOFF")
    assert robot.ask("DSTATE") == "QoK01120;0;0"


def test_state_shows_what_runs_in_teach() -> None:
    """Section 1.10: run bits 08 TEACH and 10 running in TEACH."""
    desk = Desk(choices=Choices(teach_keeps_right=True))
    robot = desk.client().ready()
    desk.controller.set_teach_mode(on=True)
    assert robot.ask("DSTATE").startswith("QoKA9")
    robot.do("EXECMOV (30,0,0,0)")
    assert robot.ask("DSTATE").startswith("QoKF9")


@pytest.mark.parametrize(("command", "number"), [("JOGST", 6010), ("SRVCUR", 6010), ("SRVCUR2", 3110)])
def test_what_the_sheet_does_not_have_is_refused(command: str, number: int) -> None:
    """Section 1.14: without the operation right, too."""
    assert Desk().client().ask(command) == f"QeR{number}00000"
