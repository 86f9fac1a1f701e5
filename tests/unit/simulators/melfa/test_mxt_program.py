"""Programs that run `Mxt` (sheet, section 2): the real-time port obeys while they do.

The Robotics Library (https://github.com/roboticslibrary/rl, src/rl/hal/MitsubishiH7.cpp and MitsubishiR3.cpp, commit
43339a9) writes and starts such a program itself; its requests, without terminators, are retyped here.
"""

import importlib.resources
import struct

import pytest

from catseye.simulators.melfa.mxt import Mxt, MxtOptions, MxtSession
from catseye.simulators.ports.session import Pending
from tests.unit.simulators.melfa.desk import Desk, Talker
from tests.unit.simulators.melfa.test_mxt import CYCLE_S, joints_in, packet, radians

ENET = 'OPEN "ENET:127.0.0.1" AS #1'
NULL, MOVE, END = 0, 1, 255
JOINT = 2
RUN, SERVO, WAIT = 0x40, 0x20, 0x04


class RealTime:
    """A PC at the real-time port and at the R-protocol of one controller."""

    def __init__(self, options: MxtOptions | None = None) -> None:
        self.desk = Desk()
        self.bench = self.desk.bench
        self.port = Mxt(self.desk.controller, self.bench, options or MxtOptions(), lambda: None)
        self.desk.controller.install(self.port)
        self.desk.controller.real_time = self.port
        self.session = MxtSession(self.port, lambda _text: None)
        self.robot = self.desk.client()

    def write(self, *lines: str) -> Talker:
        """Have a program, the servo on and nothing running."""
        robot = self.robot.ready()
        robot.do("STOP", "SLOTINIT", "LOAD=ABC")
        robot.do(*(f"EDATA{n}0 {line}" for n, line in enumerate(lines, start=1)), "SAVE")
        return robot

    def run(self, *lines: str) -> Talker:
        """Write a program and start one cycle of it."""
        robot = self.write(*lines)
        robot.do("RUNABC;1")
        self.bench.advance(0.1)
        return robot

    def ask(self, command: int, joints: tuple[float, float, float, float] | None = None) -> bytes:
        """Send a datagram and wait for its answer; empty when there is none."""
        data = b"" if joints is None else struct.pack("<4f", *radians(joints))
        self.session.feed(packet(command, 0 if joints is None else JOINT, data, (2, 1, 3, 11)))
        answer = self.session.answer()
        if not isinstance(answer, Pending):
            return answer or b""
        while (due_s := answer.due()) is not None:
            # Something may change before it is due.
            self.bench.advance_to(min(due_s, self.bench.time_s + 0.001))
        return answer.reply()

    def lead(self, cycles: int = 20) -> None:
        """Lead J1 by set points of 0.1 deg a cycle."""
        assert self.ask(NULL)
        start = self.bench.joints[0]
        for n in range(1, cycles + 1):
            assert self.ask(MOVE, (start + 0.1 * n, 0.0, 0.0, 0.0))

    def raw(self, request: str) -> str:
        """Send a request without terminator, as one segment, and wait for its answer."""
        session = self.robot.session
        session.feed(request.encode("ascii"))
        if session.silence_s() is not None:
            session.idle()
        (answer,) = self.robot.answers()
        return self.robot.finish(answer)


def test_the_robotics_librarys_program_leads_the_arm() -> None:
    pc = RealTime()
    program = "\v".join((ENET, "MXT 1,1,0", "HLT", "END"))
    numbered = "\v".join(f"{n}0 {line}" for n, line in enumerate(program.split("\v"), start=1))
    start = ("1;1;STOP", "1;1;NEW", "1;1;LOAD=1432", "1;9;ECLR", f"1;9;EMDAT{numbered}", "1;1;SAVE")
    servo = ("1;1;CNTLON", "1;1;SRVON", "1;1;CNTLOFF")
    for request in (*start, *servo):
        assert pc.raw(request) == "QoK"
    while not int(pc.raw("1;1;DSTATE").removeprefix("QoK")[:2], 16) & SERVO:
        pc.bench.advance(0.1)
    for request in ("1;1;CNTLON", "1;1;SLOTINIT", "1;1;RUN1432;1", "1;1;CNTLOFF"):
        assert pc.raw(request) == "QoK"
    # Its first cycle comes with whatever delay: without a command.
    pc.bench.advance(0.1)
    pc.lead()
    assert pc.bench.joints[0] == pytest.approx(2.0, abs=0.3)
    assert int(pc.raw("1;1;DSTATE").removeprefix("QoK")[:2], 16) & RUN
    pc.session.feed(packet(END, 0, wanted=(0, 0, 0, 0)))
    assert pc.raw("1;1;STOP") == "QoK"
    bits = pc.raw("1;1;DSTATE").removeprefix("QoK")
    assert bits[4:].split(";")[0] == "0"
    # It has given the operation right back, without which SRVOFF is refused (section 1.7).
    assert pc.raw("1;1;SRVOFF") == "QeR602000000"
    assert pc.raw("1;1;ERRORMES602000000") == "QoKNo operation right"


@pytest.mark.parametrize("begun_s", [0.0, 0.5])
def test_what_comes_before_mxt_waits_for_it(begun_s: float) -> None:
    """The Robotics Library sends its first datagram at once after RUN, when the file is not open yet."""
    pc = RealTime()
    robot = pc.write(ENET, "DLY 1", "MXT 1,1,0")
    robot.do("RUNABC;1")
    pc.bench.advance(begun_s)
    began_s = pc.bench.time_s
    assert joints_in(pc.ask(NULL), 8) == pytest.approx((0.0, 0.0, 0.0, 0.0))
    assert 1.0 <= pc.bench.time_s - began_s + begun_s < 1.1
    assert robot.ask("ERROR") == "QoK"
    pc.lead()


def test_what_waits_for_an_mxt_that_never_comes_is_dropped() -> None:
    pc = RealTime()
    robot = pc.write("DLY 1")
    robot.do("RUNABC;1")
    assert pc.ask(NULL) == b""
    assert 1.0 <= pc.bench.time_s < 3.0


def test_the_port_is_silent_unless_a_program_runs_mxt() -> None:
    pc = RealTime(MxtOptions(holds_early=False))
    robot = pc.write(ENET, "DLY 1", "MXT 1,1,0")
    robot.do("RUNABC;1")
    pc.bench.advance(0.5)
    assert pc.ask(NULL) == b""
    pc.bench.advance(1.0)
    assert pc.ask(NULL)


def test_end_leads_to_the_next_line_and_is_answered() -> None:
    pc = RealTime()
    robot = pc.run(ENET, "MXT 1,1,0", "CLOSE #1", "M_OUT(3)=1")
    pc.lead()
    assert robot.ask("LINENO") == "QoK20"
    answer = pc.ask(END)
    assert answer[:2] == bytes([END, 0])
    pc.bench.advance(1.0)
    assert robot.ask("OUT0") == "QoK0008"
    assert not pc.desk.controller.task.running
    # The arm stands at the last set point, as if the filter and the lag had run out.
    assert pc.bench.joints[0] == pytest.approx(2.0, abs=1e-6)


def test_the_answers_tell_the_joints_in_the_types_asked_for() -> None:
    pc = RealTime()
    pc.run(ENET, "MXT 1,1,0")
    answer = pc.ask(NULL)
    assert joints_in(answer, 8) == pytest.approx((0.0, 0.0, 0.0, 0.0))
    assert struct.unpack_from("<H", answer, 4) == (2,)


def test_stop_ends_mxt_and_run_begins_it_again() -> None:
    pc = RealTime()
    robot = pc.run(ENET, "MXT 1,1,0", "M_OUT(3)=1")
    pc.lead()
    robot.do("STOP")
    pc.bench.advance(0.5)
    assert pc.ask(NULL) == b""
    assert robot.ask("LINENO") == "QoK20"
    robot.do("RUN;1")
    pc.bench.advance(0.1)
    pc.lead()
    pc.ask(END)
    pc.bench.advance(1.0)
    assert robot.ask("OUT0") == "QoK0008"


def test_silence_is_an_alarm_that_halts_the_program() -> None:
    pc = RealTime()
    robot = pc.run(ENET, "MXT 1,1,0")
    pc.lead()
    pc.bench.advance(0.5 + 3 * CYCLE_S)
    assert robot.ask("ERROR") == "Qok7820;1"
    assert pc.desk.controller.task.paused
    assert pc.ask(NULL) == b""


def test_data_of_another_type_than_declared_are_an_alarm() -> None:
    pc = RealTime()
    robot = pc.run(ENET, "MXT 1,0,50")
    assert pc.ask(NULL)
    assert pc.ask(MOVE, (0.0, 0.0, 0.0, 0.0)) == b""
    assert robot.ask("ERROR") == "Qok7840;1"


def test_mxt_declares_positions_and_a_filter() -> None:
    """`Mxt 1, 0, 50`: positions, averaged over 50 ms."""
    pc = RealTime()
    pc.run(ENET, "Mxt 1, 0, 50")
    assert pc.ask(NULL)
    here = pc.desk.controller.position()
    for n in range(1, 30):
        data = struct.pack("<6f8xII", here.x_mm - 0.01 * n, here.y_mm, 0, 0, 0, 0, here.flag1, 0)
        pc.session.feed(packet(MOVE, 1, data, (1, 4, 7, 11)))
        answer = pc.session.answer()
        assert isinstance(answer, Pending)
        while (due_s := answer.due()) is not None:
            pc.bench.advance_to(due_s)
        reply = answer.reply()
    command, filtered = (struct.unpack_from("<f", reply, offset)[0] for offset in (8, 68))
    # An average over 50 ms of a ramp is (50 - 7.1) / 2 ms behind it.
    assert filtered - command == pytest.approx(0.01 * (50.0 - 7.1) / 2.0 / 7.1, abs=1e-3)


@pytest.mark.parametrize(
    ("lines", "alarm"),
    [
        (('OPEN "ENET:robot" AS #1',), "Qok6130;2"),
        ((ENET, ENET), "Qok6130;2"),
        (("MXT 1,1,0",), "Qok6130;2"),
        ((ENET, "CLOSE #1", "MXT 1,1,0"), "Qok6130;2"),
        ((ENET, "CLOSE", "MXT 1,1,0"), "Qok6130;2"),
        ((ENET, "MXT 2,1,0"), "Qok6130;2"),
        ((ENET, "MXT 1,1,X"), "Qok4220;2"),
    ],
)
def test_wrong_files_stop_the_program(lines: tuple[str, ...], alarm: str) -> None:
    robot = RealTime().run(*lines)
    assert robot.ask("ERROR") == alarm


def test_a_port_that_another_program_leads_is_refused() -> None:
    pc = RealTime()
    robot = pc.write(ENET, "MXT 1,1,0")
    robot.do("RUNCATSMXT", "RUNABC;1")
    pc.bench.advance(0.1)
    assert robot.ask("ERROR") == "Qok6130;2"


def test_the_other_program_cannot_start_meanwhile() -> None:
    pc = RealTime()
    robot = pc.run(ENET, "MXT 1,1,0")
    assert robot.ask("RUNCATSMXT") == "QeR564000000"
    assert pc.ask(NULL)


def test_a_machine_lock_leaves_the_feedback_where_the_arm_is() -> None:
    pc = RealTime()
    robot = pc.write(ENET, "MXT 1,1,0")
    robot.do("MLOCKON", "RUNABC;1")
    pc.bench.advance(0.1)
    assert pc.ask(NULL)
    for n in range(1, 20):
        pc.session.feed(packet(MOVE, JOINT, struct.pack("<4f", *radians((0.1 * n, 0, 0, 0))), (2, 5, 8, 11)))
        answer = pc.session.answer()
        assert isinstance(answer, Pending)
        while (due_s := answer.due()) is not None:
            pc.bench.advance_to(due_s)
        reply = answer.reply()
    assert joints_in(reply, 8)[0] == pytest.approx(1.9, abs=1e-5)
    assert joints_in(reply, 112)[0] == 0.0
    assert pc.bench.joints[0] == 0.0


def test_the_shipped_program_is_interpreted_too() -> None:
    """Its loop opens the port again after each END."""
    text = (importlib.resources.files("catseye.drivers.melfa") / "programs/CATSMXT.prg").read_text("ascii")
    pc = RealTime()
    robot = pc.run(*text.splitlines())
    for _ in range(2):
        pc.lead()
        assert pc.ask(END)
        pc.bench.advance(0.5)
    assert robot.ask("ERROR") == "QoK"
    assert pc.bench.joints[0] == pytest.approx(4.0, abs=1e-6)


def test_what_comes_long_before_mxt_is_dropped() -> None:
    pc = RealTime()
    robot = pc.write(ENET, "WAIT M_IN(2)=1", "MXT 1,1,0")
    robot.do("RUNABC;1")
    assert pc.ask(NULL) == b""
    assert pc.bench.time_s < 10.0
