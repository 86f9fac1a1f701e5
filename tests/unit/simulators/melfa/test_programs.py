"""Programs, files and parameters of the emulated controller (sheet, sections 1.9, 1.14 and 1.16)."""

import pytest

from tests.unit.simulators.melfa.desk import Desk, Talker

LINES = ("MOV (10,0,0,0)", "' a comment; with a semicolon", "JOVRD 50", "MOV (20,0,0,0)", "END")


def with_program(desk: Desk, name: str = "ABC", lines: tuple[str, ...] = LINES) -> Talker:
    robot = desk.client().ready()
    robot.do(f"LOAD={name}", *(f"EDATA{10 * n} {line}" for n, line in enumerate(lines, start=1)), "SAVE")
    return robot


def test_a_program_is_written_listed_and_kept() -> None:
    robot = with_program(Desk())
    assert robot.ask("LISTI10") == "QeR482000000"
    robot.do("LOAD=ABC")
    assert robot.ask("LISTCNT") == "QoK0005"
    assert robot.ask("LISTCNT20;30") == "QoK0002"
    assert robot.ask("LISTITOP") == "QoK10 MOV (10,0,0,0)"
    assert robot.ask("LISTI+1") == "QoK20 ' a comment; with a semicolon"
    assert robot.ask("LISTI40") == "QoK40 MOV (20,0,0,0)"
    assert robot.ask("LISTI-1") == "QoK30 JOVRD 50"
    assert robot.ask("LISTIEND") == "QoK50 END"
    assert robot.ask("LISTI+1") == "QoK"
    assert robot.ask("LISTI55") == "QoK"
    assert robot.ask("LISTL40") == "QoK40 MOV (20,0,0,0)\v50 END;2;0"


def test_lines_are_inserted_deleted_and_renumbered() -> None:
    robot = Desk().client()
    robot.do("LOAD=X", "EMDAT1 MOV P1\v2 MOV P2\v3 MOV P3", "EDINS=2;MOV P9")
    assert [robot.ask(f"LISTI{n}")[5:] for n in range(1, 5)] == ["MOV P1", "MOV P9", "MOV P2", "MOV P3"]
    robot.do("DELETE3;4", "RENUM")
    assert robot.ask("LISTL10") == "QoK10 MOV P1\v20 MOV P9;2;0"
    robot.do("EDATA20")
    assert robot.ask("LISTCNT") == "QoK0001"
    robot.do("ECLR")
    assert robot.ask("LISTITOP") == "QoK"


def test_what_is_not_saved_is_gone() -> None:
    robot = with_program(Desk())
    robot.do("LOAD=ABC", "ECLR", "NEW", "LOAD=ABC")
    assert robot.ask("LISTCNT") == "QoK0005"


def test_faults_in_a_line_are_reported_with_their_place() -> None:
    """Section 1.6: Qer<no>;<pos>, EMDAT with the line in front."""
    robot = Desk().client()
    robot.do("LOAD=X")
    assert robot.ask("EDATAMOV P1") == "Qer422000000;1"
    assert robot.ask("EDATA10 " + "A" * 128) == "Qer421000000;128"
    assert robot.ask("EMDAT1 MOV P1\vMOV P2") == "Qer422000000;2;1"


def test_one_client_edits() -> None:
    desk = Desk()
    first, second = desk.client(), desk.client()
    first.do("LOAD=X")
    assert second.ask("LOAD=Y") == "QeR603000000"
    assert second.ask("EDATA10 MOV P1") == "QeR603000000"
    first.session.close()
    assert second.ask("LOAD=Y") == "QoK"


def test_positions_belong_to_the_program() -> None:
    robot = Desk().client().ready()
    robot.do("LOAD=X", "EDATAP1=(400,0,0,0,0,0)(4,0)", "EDATAJ1=(1,2,3,4)", "EDATA10 MOV P1")
    assert robot.ask("LISTPTOP") == "QoKJ1=(+1.00,+2.00,+3.00,+4.00)"
    assert robot.ask("LISTP+1") == "QoKP1=(+400.00,+0.00,+0.00,+0.00,+0.00,+0.00)(4,0)"
    assert robot.ask("LISTPP7") == "QoK"
    robot.do("SAVE", "RUNX;1")
    robot.desk.bench.advance(5.0)
    assert robot.ask("PPOSF").startswith("QoKX;400.00;Y;0.00;")


def test_a_program_of_statements_runs_through() -> None:
    desk = Desk()
    robot = with_program(desk)
    robot.do("PRGLOAD=ABC")
    assert robot.ask("PRGRD") == "QoKABC.MB6"
    assert robot.ask("LINERD") == "QoK10 MOV (10,0,0,0)"
    robot.do("RUNABC;1")
    assert robot.ask("STATE") == "QoKABC.MB6;10;100;2;E0000;10;1;;;;;;;;;CYC;START;1;1"
    assert robot.ask("EXECMOV (0,0,0,0)") == "QeR564000000"
    assert robot.ask("PRGLOAD=ABC") == "QeR564000000"
    desk.bench.advance(5.0)
    assert desk.bench.joints == (20.0, 0.0, 0.0, 0.0)
    assert desk.controller.joint_override_percent == 50.0
    assert robot.ask("STATE") == "QoKABC.MB6;10;100;0;A0100;10;1;;;;;;;;;CYC;START;1;0"
    assert robot.ask("CYCLETIMEABC").endswith(";1")


def test_a_stopped_program_goes_on_where_it_was() -> None:
    desk = Desk()
    robot = with_program(desk, lines=("MOV (90,0,0,0)", "MOV (0,0,0,0)"))
    with_program(desk, "OTHER")
    robot.do("RUNABC")
    desk.bench.advance(0.2)
    robot.do("STOP")
    desk.bench.advance(1.0)
    assert 0.0 < desk.bench.joints[0] < 90.0
    assert robot.ask("PRGLOAD=OTHER") == "QeR511000000"
    robot.do("RUN")
    desk.bench.advance(0.5)
    assert robot.ask("LINENO") == "QoK20"
    robot.do("CSTOP")
    desk.bench.advance(5.0)
    assert desk.bench.joints[0] == 0.0
    assert robot.ask("LINENO=20") == "QoK"
    assert robot.ask("LINENO=25") == "QeR311000000"
    robot.do("RSTPRG", "PRGLOAD=OTHER", "PRGUP")
    assert robot.ask("PRGRD") == "QoKABC.MB6"
    robot.do("PRGDOWN")
    assert robot.ask("PRGRD") == "QoKOTHER.MB6"


def test_a_repeated_program_goes_on_until_its_cycle_is_stopped() -> None:
    desk = Desk()
    robot = with_program(desk, lines=("MOV (10,0,0,0)", "MOV (0,0,0,0)", "END"))
    robot.do("RUNABC;0")
    desk.bench.advance(3.0)
    assert int(robot.ask("CYCLETIMEABC").split(";")[3]) > 2
    robot.do("CSTOP")
    desk.bench.advance(3.0)
    assert robot.ask("DSTATE").startswith("QoKA1")
    assert desk.bench.joints[0] == 0.0


def test_a_program_stands_still_for_a_delay() -> None:
    desk = Desk()
    robot = with_program(desk, lines=("MOV (10,0,0,0)", "DLY 3.5", "MOV (20,0,0,0)", "END"))
    robot.do("RUNABC;1")
    desk.bench.advance(3.4)
    assert desk.bench.joints[0] == pytest.approx(10.0)
    desk.bench.advance(2.0)
    assert desk.bench.joints[0] == pytest.approx(20.0)
    assert robot.ask("EXECDLY 0") == "QeR311000000"


@pytest.mark.parametrize("line", ["SELECT M1", "WHILE M1=1", "INPUT #1,M1", "PRINT #1,M1"])
def test_what_is_not_interpreted_stops_with_a_syntax_alarm(line: str) -> None:
    desk = Desk()
    robot = with_program(desk, lines=("MOV (10,0,0,0)", line))
    robot.do("RUNABC")
    desk.bench.advance(5.0)
    assert robot.ask("ERROR") == "Qok4220;2"
    assert robot.ask("LINENO") == "Qok20"
    assert robot.ask("RUN") == "QeR560000000"


def test_start_can_be_disabled() -> None:
    robot = with_program(Desk())
    assert robot.ask("ATENA") == "QoK0"
    robot.do("AUEOFF")
    assert robot.ask("ATENA") == "QoK1"
    assert robot.ask("RUNABC") == "QeR501000000"
    robot.do("AUEON", "STOPON")
    assert robot.ask("RUNABC") == "QeR561000000"


def test_files() -> None:
    robot = with_program(Desk())
    assert robot.ask("FCHECKABC") == "QoKN"
    assert robot.ask("FCHECKABC.MB6") == "QoKN"
    assert robot.ask("FCHECKXYZ") == "QoKF"
    assert robot.ask("FPATH=ABC") == "QoKABC.MB6"
    robot.do("FCOPYABC;DEF", "FRENAMEDEF;GHI", "FATTRIBGHI;+p/+q")
    assert robot.ask("FDIRTOP").split(";")[0] == "QoKABC.MB6"
    assert robot.ask("FDELGHI") == "QeR605000000"
    robot.do("FATTRIBGHI;-p", "FDELGHI")
    assert robot.ask("FDELGHI") == "QeR414000000"
    assert robot.ask("FCOPYABC;ABC") == "QeR605000000"
    total, used, percent = robot.ask("EFREE").removeprefix("QoK").split(";")
    assert 0 < int(used) < int(total)
    assert percent == "0"


def test_a_file_is_read_and_written_in_blocks() -> None:
    robot = with_program(Desk(), lines=tuple(f"MOV ({n},0,0,0)" for n in range(1, 9)))
    robot.do("FOPENABC;r")
    blocks, more = [], "1"
    while more == "1":
        digits, more = robot.ask("FREAD").removeprefix("QoK").split(";")
        blocks.append(bytes.fromhex(digits))
    robot.do("FCLOSE")
    content = b"".join(blocks)
    assert content.startswith(b"10 MOV (1,0,0,0)\r\n")
    robot.do("FOPENNEW1;w")
    for place in range(0, len(content), 110):
        part = content[place : place + 110]
        robot.do(f"FWRITE{len(part)};{part.hex()}")
    assert robot.ask("FWRITE1:00") == "QeR422000000"
    robot.do("FCLOSE", "LOAD=NEW1")
    assert robot.ask("LISTCNT") == "QoK0008"
    assert robot.ask("FREAD") == "QeR605000000"
    robot.do("FOPENBAD;w", "FWRITE3;414243")
    assert robot.ask("FCLOSE") == "QeR605000000"


def test_parameters_are_read_written_and_listed_as_changed() -> None:
    robot = Desk().client()
    assert robot.ask("PNRNETPORT") == (
        "QoKNETPORT;10000, 10001, 10002, 10003, 10004, 10005, 10006, 10007, 10008, 10009;10"
    )
    assert robot.ask("PNRNETIP") == "QoKNETIP;192.168.0.20;1"
    assert robot.ask("PNRCPRCE11") == "QoKCPRCE11;0;1"
    assert robot.ask("PMR=0") == "QoK0;0;"
    robot.do("PRM=CPRCE12;2", "PAW=NETIP;192.168.0.21")
    assert robot.ask("PARCPRCE12") == "QoKCPRCE12;2;1"
    assert robot.ask("PMR=0") == "QoK0;2;CPRCE12\vNETIP"
    assert robot.ask("PRM=NETIP;1, 2") == "QeR311000000"
    assert robot.ask("PARCRC=NETIP") == "QeR601000000"
