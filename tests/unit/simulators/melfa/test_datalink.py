"""The emulated data link program against the sheet's section 4 and the record table of its documentation."""

import itertools
import math
import re
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.choices import Choices
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.datalink import Datalink, DatalinkSession, NumberFormat
from catseye.simulators.ports.session import Pending
from catseye.simulators.world.scara.arm import scara_bench
from tests.transcripts import melfa_datalink as records
from tests.unit.simulators.benches import QUIET, perfect_arm, without_j4_play

HOME = (0.0, 0.0, 10.0, 0.0)


class Line:
    """A controller that runs the program, and one client."""

    def __init__(
        self, number_format: NumberFormat = "plain", *, servo: bool = True, start: tuple[float, ...] = HOME
    ) -> None:
        config = without_j4_play(replace(QUIET, start_joints=(start[0], start[1], start[2], start[3])))
        self.bench = scara_bench(perfect_arm(config), config)
        self.controller = Controller(self.bench, config, lambda: None)
        self.program = Datalink(self.controller, number_format=number_format)
        self.controller.install(self.program)
        self.session = self.client()
        if servo:
            self.controller.switch_servo_on()
            self.bench.advance(2.0)

    def client(self) -> DatalinkSession:
        """Return a further client."""
        return DatalinkSession(self.program, lambda _text: None)

    def ask(self, request: bytes, within_s: float = 60.0) -> bytes:
        """Send bytes and return all answers that come within a bench time."""
        self.session.feed(request)
        return self.answers(within_s)

    def answers(self, within_s: float = 60.0) -> bytes:
        """Return all answers that come within a bench time."""
        until_s = self.bench.time_s + within_s
        came = b""
        while (answer := self.session.answer()) is not None:
            if isinstance(answer, Pending):
                while (due_s := answer.due()) is not None:
                    if due_s > until_s:
                        return came
                    self.bench.advance_to(due_s)
                came += answer.reply()
            else:
                came += answer
        return came


def joints_in(record: bytes) -> list[float]:
    """Return the four values of an answer."""
    assert record.endswith(b"\r")
    return [float(field) for field in record.split(b",")[2:]]


def test_it_says_what_it_is_and_obeys_the_small_commands() -> None:
    line = Line()
    assert line.ask(records.WHO) == records.EMULATOR
    assert line.ask(records.ADD) == records.ADDED
    assert line.ask(records.FORGET) == records.FORGOTTEN
    assert line.ask(records.SPEED) == records.SET
    assert line.ask(records.STRANGE) == records.UNKNOWN
    assert line.ask(records.ADD) == records.ADDED


@pytest.mark.parametrize("number_format", records.ANSWERS)
def test_feedback_has_the_chosen_notation(number_format: NumberFormat) -> None:
    line = Line(number_format, start=records.FEEDBACK)
    assert line.ask(records.ASK_FEEDBACK) == records.ANSWERS[number_format]


def test_feedback_is_float32() -> None:
    line = Line("exponent", start=(0.1, 0.0, 0.0, 0.0))
    # The float32 next to 0.1 is 0.100000001490116...
    assert line.ask(records.ASK_FEEDBACK).split(b",")[2] == b"1.0000000E-01"
    line = Line("exponent", start=(165.001, 0.0, 0.0, 0.0))
    # Steps of float32 are 1.5e-5 there: 10813506 / 65536.
    assert line.ask(records.ASK_FEEDBACK).split(b",")[2] == b"1.6500101E+02"


def test_the_queue_holds_sixty_points() -> None:
    line = Line()
    for count in range(1, 61):
        assert line.ask(records.ADD) == b"7,1,%d,0,0,0\r" % count
    assert line.ask(records.ADD) == records.FULL


def test_via_points_are_blended_and_answered_at_standstill() -> None:
    line = Line()
    for k in range(1, 6):
        line.ask(b"%d,1,%d,%d,10,%d\r" % (k, 2 * k, -k, -k))
    start_s = line.bench.time_s
    answer = line.ask(b"9,2,0,0,0,0\r")
    assert answer.startswith(b"9,2,")
    assert joints_in(answer) == pytest.approx([10.0, -5.0, 10.0, -5.0])
    assert not line.bench.moving
    blended_s = line.bench.time_s - start_s
    # J1 sets the pace: 2 deg at 2000 deg/s² and less than 420 deg/s take two ramps of sqrt(2 / 2000) s each.
    ramp_s = math.sqrt(2.0 / 2000.0)
    assert blended_s == pytest.approx(6.0 * ramp_s + 0.05, rel=1e-6)
    # The queue is empty: another drive returns the feedback at once.
    assert line.ask(b"10,2,0,0,0,0\r", 0.0).startswith(b"10,2,10,-5,10,-5")


def test_corners_are_cut() -> None:
    line = Line()
    line.ask(b"1,1,20,0,10,0\r")
    line.ask(b"2,1,20,20,10,0\r")
    line.session.feed(b"3,2,0,0,0,0\r")
    answer = line.session.answer()
    assert isinstance(answer, Pending)
    nearest = min(_distance(line, 0.002) for _ in range(400))
    assert 0.5 < nearest < 10.0


def _distance(line: Line, step_s: float) -> float:
    line.bench.advance(step_s)
    return math.dist(line.bench.joints, (20.0, 0.0, 10.0, 0.0))


def test_the_override_slows_the_drive() -> None:
    took_s = []
    for percent in (100, 10):
        line = Line()
        line.ask(b"1,6,%d,20,0,0\r" % percent)
        line.ask(b"2,1,42,0,10,0\r")
        start_s = line.bench.time_s
        line.ask(b"3,2,0,0,0,0\r")
        took_s.append(line.bench.time_s - start_s - 0.05)
    # 42 deg/s after 0.021 s.
    assert took_s[1] == pytest.approx(1.0 + 0.021)
    assert took_s[0] < 0.5


def test_requests_wait_for_the_drive() -> None:
    line = Line()
    line.ask(b"1,1,20,0,10,0\r")
    answers = line.ask(b"2,2,0,0,0,0\r3,3,0,0,0,0\r").split(b"\r")
    assert [answer.split(b",")[0] for answer in answers[:-1]] == [b"2", b"3"]
    assert float(answers[1].split(b",")[2]) == 20.0


@pytest.mark.parametrize("record", records.BAD)
def test_a_malformed_record_halts_the_program_with_an_alarm(record: bytes) -> None:
    line = Line()
    assert line.ask(record) == b""
    assert line.controller.alarm == 3500
    assert line.controller.servo_on
    assert line.ask(records.WHO) == b""
    line.controller.reset_alarm()
    assert line.answers() == b""
    line.controller.task.reset()
    line.controller.task.start("CATSDL", repeat=False)
    assert line.answers() == records.EMULATOR


@pytest.mark.parametrize(
    ("point", "number"),
    [(b"171,0,0,0", 2602), (b"0,-146,0,0", 2602), (b"0,0,-1,0", 2602), (b"0,0,0,361", 2602)],
)
def test_a_point_outside_the_limits_alarms_without_motion(point: bytes, number: int) -> None:
    line = Line()
    line.ask(b"1,1," + point + b"\r")
    assert line.ask(b"2,2,0,0,0,0\r") == b""
    assert line.controller.alarm == number
    assert line.bench.joints == HOME


def test_a_drive_with_the_servo_off_is_an_alarm() -> None:
    line = Line(servo=False)
    assert line.ask(records.WHO) == records.EMULATOR
    line.ask(b"1,1,10,0,10,0\r")
    assert line.ask(b"2,2,0,0,0,0\r") == b""
    assert line.controller.alarm == 2000


def driving() -> tuple[Line, Pending]:
    """Return a line in the middle of a drive to J1 = 90 deg, and the answer that waits for its end."""
    line = Line()
    line.ask(b"1,1,45,0,10,0\r")
    line.ask(b"2,1,90,0,10,0\r")
    line.session.feed(b"3,2,0,0,0,0\r")
    answer = line.session.answer()
    assert isinstance(answer, Pending)
    line.bench.advance(0.2)
    return line, answer


def test_stop_brakes_and_the_answer_never_comes() -> None:
    line, answer = driving()
    line.controller.stop()
    line.bench.advance(100.0)
    assert not line.bench.moving
    assert 30.0 < line.bench.joints[0] < 89.0
    due_s = answer.due()
    assert due_s is not None
    assert due_s > line.bench.time_s
    line.controller.task.reset()
    assert answer.due() is None
    assert answer.reply() == b""


def test_run_continues_a_stopped_drive() -> None:
    line, answer = driving()
    line.controller.stop()
    line.bench.advance(1.0)
    line.controller.task.start("", repeat=True)
    while (due_s := answer.due()) is not None:
        line.bench.advance_to(due_s)
    assert joints_in(answer.reply()) == pytest.approx([90.0, 0.0, 10.0, 0.0])


def test_after_a_reset_the_next_connection_starts_the_program() -> None:
    line, _ = driving()
    line.controller.stop()
    line.bench.advance(1.0)
    line.controller.task.reset()
    assert line.ask(records.WHO) == b""
    line.session.close()
    line.session = line.client()
    assert line.ask(records.WHO) == records.EMULATOR
    assert line.ask(records.ADD) == records.ADDED


def test_a_program_that_runs_is_neither_reset_nor_started() -> None:
    """Sheet, section 5.3: 5640 is "not possible while running"; which commands it refuses is not documented."""
    line = Line()
    for command in (line.controller.task.reset, lambda: line.controller.task.start("CATSDL", repeat=False)):
        with pytest.raises(Refusal) as caught:
            command()
        assert caught.value.number == 5640
    assert line.ask(records.ADD) == records.ADDED


def test_a_controller_may_reset_a_program_that_runs() -> None:
    line = Line()
    line.controller.choices = Choices(reset_while_running=True)
    line.controller.task.reset()
    assert not line.program.running
    line.controller.task.start("CATSDL", repeat=False)
    line.controller.task.start("CATSDL", repeat=False)
    assert line.program.running


def test_servo_off_halts_a_drive_but_not_waiting_programs() -> None:
    line, _ = driving()
    line.controller.switch_servo_off()
    assert not line.program.running
    line = Line()
    line.controller.switch_servo_off()
    assert line.ask(records.WHO) == records.EMULATOR


def test_the_end_is_the_end_until_the_next_connection() -> None:
    line = Line()
    assert line.ask(records.FINISH) == records.FINISHED
    assert line.ask(records.WHO) == b""
    line.session.close()
    line.session = line.client()
    assert line.ask(records.WHO) == records.EMULATOR


def test_a_second_client_waits_for_the_first() -> None:
    line = Line()
    first, second = line.session, line.client()
    line.session = second
    assert line.ask(records.WHO) == b""
    first.close()
    assert line.answers() == records.EMULATOR


@given(cuts=st.lists(st.integers(0, 120), max_size=12))
def test_any_split_gives_the_same_answers(cuts: list[int]) -> None:
    stream = records.WHO + b"\n" + records.ADD + b"2,2,0,0,0,0\r" + records.STRANGE + b"3,3,0,0,0,0\r"
    places = sorted({0, len(stream), *(cut for cut in cuts if cut < len(stream))})
    line = Line()
    came = b"".join(line.ask(stream[a:b]) for a, b in itertools.pairwise(places))
    assert came == Line().ask(stream)
    assert came.count(b"\r") == 5


pieces = st.one_of(
    st.binary(max_size=400),
    st.builds(
        lambda command, values: b"1,%d,%s\r" % (command, ",".join(map(repr, values)).encode()),
        st.integers(-3, 9),
        st.lists(st.floats(-400.0, 400.0), min_size=3, max_size=5),
    ),
)


@given(sent=st.lists(pieces, max_size=10))
def test_random_bytes_get_whole_records_and_do_no_harm(sent: list[bytes]) -> None:
    line = Line()
    came = b""
    for piece in sent:
        came += line.ask(piece)
        restart_after_alarm(line)
    assert re.fullmatch(rb"(-?[\d.]+,-?\d+(,-?[\d.]+){4}\r)*", came)
    line.session.close()
    restart_after_alarm(line)
    line.session = line.client()
    assert line.ask(records.WHO) == records.EMULATOR


def restart_after_alarm(line: Line) -> None:
    """Do what an operator does when a record made no sense."""
    if line.controller.alarm:
        line.controller.reset_alarm()
        line.controller.task.reset()
        line.controller.task.start("CATSDL", repeat=False)


def test_what_waits_is_bounded() -> None:
    line = Line()
    line.controller.stop()
    for _ in range(2000):
        line.session.feed(b"1" * 1000)
        line.session.feed(records.WHO)
    line.controller.task.start("CATSDL", repeat=False)
    assert line.answers().count(b"\r") <= 128
