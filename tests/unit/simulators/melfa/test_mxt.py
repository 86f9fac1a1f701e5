"""Real-time control against the sheet's offsets and hand calculation of filter, lag and limits."""

import math
import struct
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from catseye.simulators.config import EmulationConfig, Joints
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.mxt import Mode, Mxt, MxtOptions, MxtSession
from catseye.simulators.ports.session import Pending
from catseye.simulators.world.scara.arm import scara_bench
from tests.transcripts import melfa_mxt
from tests.unit.simulators.benches import QUIET, perfect_arm, without_j4_play

CYCLE_S = 0.0071


class Line:
    """A controller under real-time control, and one PC at it."""

    def __init__(
        self,
        start: Joints = (10.0, -20.0, 75.5, 90.0),
        *,
        servo: bool = True,
        options: MxtOptions | None = None,
    ) -> None:
        self.config: EmulationConfig = without_j4_play(replace(QUIET, start_joints=start))
        self.said: list[str] = []
        self.bench = scara_bench(perfect_arm(self.config), self.config, self.said.append)
        self.controller = Controller(self.bench, self.config, lambda: None)
        self.program = Mxt(self.controller, self.bench, options or MxtOptions(), lambda: None)
        self.controller.install(self.program)
        self.session = MxtSession(self.program, lambda _text: None)
        if servo:
            self.controller.switch_servo_on()
            self.bench.advance(2.0)

    def ask(self, datagram: bytes) -> bytes:
        """Send a datagram and wait for its answer; empty when there is none."""
        self.session.feed(datagram)
        return self.answer()

    def answer(self) -> bytes:
        """Wait for the next answer."""
        answer = self.session.answer()
        if not isinstance(answer, Pending):
            return answer or b""
        while (due_s := answer.due()) is not None:
            self.bench.advance_to(due_s)
        return answer.reply()

    def to(self, joints: Joints, kind: int = 2) -> bytes:
        """Send a set point."""
        return self.ask(packet(1, kind, struct.pack("<4f", *radians(joints))))

    def begin(self) -> bytes:
        """Ask where the arm stands."""
        return self.ask(melfa_mxt.WHERE)


def radians(joints: Joints) -> Joints:
    """Return joint data: rad, rad, mm, rad."""
    return (math.radians(joints[0]), math.radians(joints[1]), joints[2], math.radians(joints[3]))


def packet(command: int, send_type: int, data: bytes = b"", wanted: tuple[int, ...] = (2, 5, 8, 11)) -> bytes:
    """Put a datagram together by the sheet's offsets."""
    made = bytearray(196)
    struct.pack_into("<3H", made, 0, command, send_type, wanted[0])
    made[8 : 8 + len(data)] = data
    for offset, kind in zip((64, 108, 152), wanted[1:], strict=True):
        struct.pack_into("<H", made, offset, kind)
    return bytes(made)


def joints_in(data: bytes, offset: int) -> Joints:
    """Return joint data at an offset as deg, deg, mm, deg."""
    j1, j2, j3, j4 = struct.unpack_from("<4f", data, offset)
    return (math.degrees(j1), math.degrees(j2), j3, math.degrees(j4))


def silent_cycles(data: bytes) -> int:
    """Return TCount."""
    count: int = struct.unpack_from("<H", data, 58)[0]
    return count


def lead(line: Line, axis: int, size: float, cycles: int) -> bytes:
    """Send set points that move one axis by a size a cycle; return the last answer."""
    line.begin()
    start = line.bench.joints
    last = b""
    for k in range(1, cycles + 1):
        target = list(start)
        target[axis] += size * k
        last = line.to((target[0], target[1], target[2], target[3]))
    return last


def test_feedback_matches_byte_by_byte() -> None:
    assert Line().ask(melfa_mxt.WHERE) == melfa_mxt.AT_JOINTS


def test_the_answer_comes_next_cycle_and_echoes_the_counter() -> None:
    line = Line()
    line.begin()
    start_s = line.bench.time_s
    line.bench.advance(0.001)
    answer = line.ask(melfa_mxt.SET_POINT)
    assert line.bench.time_s == pytest.approx(start_s + CYCLE_S)
    assert start_s / CYCLE_S == pytest.approx(round(start_s / CYCLE_S))
    assert answer[:6] == bytes.fromhex("01 00 02 00 02 00")
    assert answer[60:64] == bytes.fromhex("04 03 02 01")
    assert joints_in(answer, 8) == pytest.approx(melfa_mxt.JOINTS, abs=1e-5)


@pytest.mark.parametrize(("axis", "size"), [(0, 0.1), (1, -0.2), (2, 0.5), (3, 0.3)])
def test_a_steady_stream_lags_by_filter_and_servo(axis: int, size: float) -> None:
    options = MxtOptions()
    last = lead(Line(options=options), axis, size, 60)
    command, filtered, feedback = (joints_in(last, offset)[axis] for offset in (8, 68, 112))
    # 7.1 of 10 ms are the newest set point, 2.9 ms the one before.
    assert command - filtered == pytest.approx(0.29 * size, abs=1e-4)
    # y += (1 - q)(x - y) stays x's step times q / (1 - q) behind; the answer gives the place one cycle before.
    decay = math.exp(-CYCLE_S / options.lags_s[axis])
    assert filtered - feedback == pytest.approx(size * (decay / (1.0 - decay) + 1.0), rel=1e-3, abs=1e-4)


def test_the_axes_lag_differently_by_choice_only() -> None:
    even = Line(options=MxtOptions(lag_spread_s=0.0))
    uneven = Line()
    for line in (even, uneven):
        line.begin()
        j1, j2, j3, j4 = line.bench.joints
        for k in range(1, 40):
            line.to((j1 + 0.1 * k, j2 + 0.1 * k, j3, j4 + 0.1 * k))
    start = (10.0, -20.0, 75.5, 90.0)
    one, two, _, four = (now - then for now, then in zip(even.bench.joints, start, strict=True))
    assert (two, four) == pytest.approx((one, one), abs=1e-5)
    one, two, _, four = (now - then for now, then in zip(uneven.bench.joints, start, strict=True))
    # 0.1 deg in 7.1 ms is 14.1 deg/s: 0.2 ms more lag are 2.8 mdeg, 0.1 ms less 1.4 mdeg, in cycles a bit less.
    assert two - one == pytest.approx(-0.0028, rel=0.1)
    assert four - one == pytest.approx(0.0014, rel=0.1)


def test_after_end_the_arm_rests_at_the_last_set_point() -> None:
    line = Line()
    lead(line, 0, 0.1, 40)
    answer = line.ask(melfa_mxt.END)
    assert answer[:2] == b"\xff\x00"
    line.bench.advance(5.0)
    assert not line.bench.moving
    assert line.bench.joints[0] == pytest.approx(14.0, abs=1e-5)
    assert line.controller.alarm == 0
    # Set points are ignored now, until somebody asks where the arm stands.
    assert line.to((14.1, -20.0, 75.5, 90.0)) == b""
    line.bench.advance(1.0)
    assert line.bench.joints[0] == pytest.approx(14.0, abs=1e-5)
    line.begin()
    line.to((14.1, -20.0, 75.5, 90.0))
    line.bench.advance(0.5)
    assert line.bench.joints[0] == pytest.approx(14.1, abs=1e-5)


def test_the_last_set_point_in_a_cycle_counts() -> None:
    line = Line()
    line.begin()
    for j1 in (10.1, 10.2, 10.3):
        line.session.feed(packet(1, 2, struct.pack("<4f", *radians((j1, -20.0, 75.5, 90.0)))))
    answers = [line.answer() for _ in range(3)]
    assert [joints_in(answer, 8)[0] for answer in answers] == pytest.approx([10.3] * 3, abs=1e-5)
    assert line.answer() == b""


def test_missed_cycles_are_counted() -> None:
    line = Line()
    answer = lead(line, 0, 0.1, 20)
    assert silent_cycles(answer) == 0
    line.bench.advance(5 * CYCLE_S)
    answer = line.to((12.1, -20.0, 75.5, 90.0))
    assert silent_cycles(answer) == 5


def test_a_paused_stream_stays_one_until_begun_anew() -> None:
    line = Line()
    lead(line, 0, 0.1, 20)
    line.bench.advance(0.3)
    line.to((12.1, -20.0, 75.5, 90.0))
    line.bench.advance(0.3)
    line.ask(packet(255, 0))
    lead(line, 0, 0.1, 5)
    line.bench.advance(0.3)
    begun = [text.partition(" 1")[0] for text in line.said if text.startswith("stream")]
    assert begun == ["stream from", "stream goes on from", "stream from"]


def test_a_long_silence_alarms_with_servo_off() -> None:
    line = Line()
    lead(line, 0, 0.1, 20)
    line.bench.advance(0.49)
    assert line.controller.alarm == 0
    line.bench.advance(0.03)
    assert line.controller.alarm == 7820
    assert not line.controller.servo_on
    # Nothing is answered until the alarm is reset and the program starts again.
    assert line.begin() == b""
    line.controller.reset_alarm()
    assert line.begin() == b""
    line.controller.task.reset()
    assert line.begin() != b""


def test_without_time_out_silence_means_nothing() -> None:
    line = Line(options=MxtOptions(timeout_s=-1.0))
    lead(line, 0, 0.1, 20)
    line.bench.advance(100.0)
    assert line.controller.alarm == 0
    assert line.bench.joints[0] == pytest.approx(12.0, abs=1e-5)
    line.to((12.1, -20.0, 75.5, 90.0))
    line.bench.advance(1.0)
    assert line.bench.joints[0] == pytest.approx(12.1, abs=1e-5)


@pytest.mark.parametrize(
    ("axis", "step", "number"),
    [(0, 420.0, 2131), (1, -720.0, 2132), (2, -1100.0, 2133), (3, 3000.0, 2134)],
)
def test_a_step_beyond_the_speed_limit_alarms_its_axis(axis: int, step: float, number: int) -> None:
    for factor, expected in ((0.99, 0), (1.01, number)):
        line = Line()
        line.begin()
        target = list(line.bench.joints)
        target[axis] += factor * step * CYCLE_S
        line.to((target[0], target[1], target[2], target[3]))
        assert line.controller.alarm == expected
        assert line.controller.servo_on is (expected == 0)


@pytest.mark.parametrize(
    ("axis", "start", "beyond", "number"),
    [
        (0, (169.9, 0.0, 0.0, 0.0), 170.1, 2161),
        (1, (0.0, -144.9, 0.0, 0.0), -145.1, 2172),
        (2, (0.0, 0.0, 0.1, 0.0), -0.1, 2173),
        (3, (0.0, 0.0, 0.0, 359.9), 360.1, 2164),
    ],
)
def test_a_set_point_outside_limits_alarms_axis_and_side(
    axis: int, start: Joints, beyond: float, number: int
) -> None:
    line = Line(start)
    line.begin()
    target = list(start)
    target[axis] = beyond
    assert line.to((target[0], target[1], target[2], target[3])) == b""
    assert line.controller.alarm == number


@pytest.mark.parametrize(
    "datagram",
    [
        b"",
        melfa_mxt.SET_POINT[:195],
        melfa_mxt.SET_POINT + b"\0",
        b"\x02" + melfa_mxt.WHERE[1:],
        packet(1, 1, bytes(40)),
        packet(1, 2, struct.pack("<f", math.nan)),
    ],
)
def test_an_illegal_datagram_is_an_alarm(datagram: bytes) -> None:
    line = Line()
    line.begin()
    assert line.ask(datagram) == b""
    assert line.controller.alarm == 7840
    assert line.begin() == b""


def test_set_points_with_the_servo_off_are_an_alarm() -> None:
    line = Line(servo=False)
    assert line.begin() != b""
    assert line.to((10.0, -20.0, 75.5, 90.0)) == b""
    assert line.controller.alarm == 2000


def test_stop_halts_the_program_and_brakes_the_arm() -> None:
    line = Line()
    lead(line, 0, 0.1, 40)
    before = line.bench.joints[0]
    line.controller.stop()
    assert line.to((14.1, -20.0, 75.5, 90.0)) == b""
    line.bench.advance(2.0)
    # From 14.1 deg/s at 2000 deg/s²: 0.05 deg.
    assert line.bench.joints[0] - before == pytest.approx(0.05, abs=0.01)
    assert line.controller.alarm == 0
    line.controller.task.reset()
    line.controller.task.start("CATSMXT", repeat=False)
    assert joints_in(line.begin(), 8)[0] == pytest.approx(line.bench.joints[0], abs=1e-5)


def test_an_arm_that_moves_otherwise_cannot_be_led() -> None:
    line = Line()
    line.begin()
    line.controller.move((20.0, -20.0, 75.5, 90.0))
    line.to(line.bench.joints)
    line.to((10.5, -20.0, 75.5, 90.0))
    assert line.controller.alarm == 5640


def test_all_monitors_of_an_arm_at_rest() -> None:
    line = Line((30.0, 60.0, 12.0, 10.0))
    # 325 cos 30 + 225 cos 90, 325 sin 30 + 225 sin 90, 12 mm, 100 deg.
    pose = (281.458256, 387.5, 12.0, 0.0, 0.0, math.radians(100.0))
    for kind in (1, 4, 7):
        answer = line.ask(packet(0, 0, wanted=(kind, 0, 0, 0)))
        assert struct.unpack_from("<6f", answer, 8) == pytest.approx(pose, abs=1e-4)
        assert struct.unpack_from("<2I", answer, 40) == (4, 0)
    for kind in (2, 5, 8):
        answer = line.ask(packet(0, 0, wanted=(0, 0, 0, kind)))
        assert joints_in(answer, 156) == pytest.approx((30.0, 60.0, 12.0, 10.0), abs=1e-5)
    for kind in (3, 6, 9):
        answer = line.ask(packet(0, 0, wanted=(0, kind, 0, 0)))
        assert struct.unpack_from("<4i", answer, 68) == (30_000, 60_000, 12_000, 10_000)
    assert line.ask(packet(0, 0, wanted=(0, 999, 0, 0)))[68:108] == bytes(40)


@pytest.mark.parametrize(("mode", "kind"), [("xyz", 1), ("pulse", 3)])
def test_other_declared_types_lead_the_arm_to_the_same_joints(mode: Mode, kind: int) -> None:
    line = Line((30.0, 60.0, 12.0, 10.0), options=MxtOptions(mode=mode))
    line.begin()
    if mode == "xyz":
        # The J4 axis a hundredth of a degree of J1 further, 10 deg more of J4 spread over the way.
        turned = math.radians(30.01), math.radians(90.01)
        x_mm = 325.0 * math.cos(turned[0]) + 225.0 * math.cos(turned[1])
        y_mm = 325.0 * math.sin(turned[0]) + 225.0 * math.sin(turned[1])
        data = struct.pack("<8f2I", x_mm, y_mm, 12.0, 0.0, 0.0, math.radians(100.01), 0.0, 0.0, 4, 0)
    else:
        data = struct.pack("<8i", 30_010, 60_000, 12_000, 10_000, 0, 0, 0, 0)
    line.ask(packet(1, kind, data))
    line.bench.advance(0.5)
    assert line.bench.joints == pytest.approx((30.01, 60.0, 12.0, 10.0), abs=1e-4)


def test_a_position_out_of_reach_is_an_alarm() -> None:
    for x_mm in (600.0, 1e30):
        line = Line((30.0, 60.0, 12.0, 10.0), options=MxtOptions(mode="xyz"))
        line.begin()
        line.ask(packet(1, 1, struct.pack("<8f2I", x_mm, *[0.0] * 7, 4, 0)))
        assert line.controller.alarm == 2802


def test_currents_show_friction_and_acceleration() -> None:
    last = lead(Line(), 0, 0.1, 60)
    # Whole numbers (sheet, section 2): a client that reads them as such finds the friction of J1 and the load of J3.
    assert struct.unpack_from("<8i", last, 156) == (5, 0, 20, 0, 0, 0, 0, 0)


datagrams = st.one_of(
    st.binary(max_size=300),
    st.builds(
        packet,
        st.sampled_from([0, 1, 255]),
        st.sampled_from([1, 2, 3]),
        st.binary(min_size=40, max_size=40),
        st.tuples(*[st.integers(0, 0xFFFF)] * 4),
    ),
)


# Bytes at random, as in tests/unit/test_random_bytes.py, hardly ever have the length of a packet.
@settings(max_examples=200)
@given(sent=st.lists(datagrams, max_size=8), mode=st.sampled_from(["joint", "xyz", "pulse"]))
def test_random_datagrams_raise_nothing(sent: list[bytes], mode: Mode) -> None:
    line = Line(options=MxtOptions(mode=mode))
    for datagram in sent:
        assert len(line.ask(datagram)) in {0, 196}
        if line.controller.alarm:
            line.controller.reset_alarm()
            line.controller.task.reset()


def test_what_is_not_answered_yet_is_bounded() -> None:
    line = Line()
    line.begin()
    for _ in range(1000):
        line.session.feed(melfa_mxt.WHERE)
    answers = 0
    while line.answer():
        answers += 1
    assert answers <= 64
