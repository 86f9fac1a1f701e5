"""The control port: truth, faults, witness."""

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.simulators.control_port.operations import LONGEST_BYTES, ControlSession
from catseye.simulators.emulated_bench import EmulatedBench
from catseye.simulators.melfa.r_protocol import MelfaSession
from catseye.simulators.modbus.air_sensor import AirSensor
from catseye.simulators.world.scara.truth import draw_truth
from catseye.simulators.world.tracker import Tracker
from tests.unit.simulators.benches import QUIET, aimed

CONFIG = replace(QUIET, start_joints=aimed(20.0, 30.0))


class Panel:
    """A client of the control port of a bench that does not listen; its clock is set by hand."""

    def __init__(self, emulation: EmulatedBench | None = None) -> None:
        self.emulation = emulation or EmulatedBench(CONFIG)
        self.bench = self.emulation.bench
        self.session = ControlSession(self.emulation.reach)

    def ask(self, **request: object) -> dict[str, object]:
        return self.raw(json.dumps(request).encode() + b"\n")

    def raw(self, line: bytes) -> dict[str, object]:
        self.session.feed(line)
        answer = self.session.answer()
        assert isinstance(answer, bytes)
        assert answer.endswith(b"\n")
        said: dict[str, object] = json.loads(answer)
        return said

    def fault(self, name: str, **arguments: object) -> None:
        assert self.ask(op="fault", name=name, **arguments) == {"ok": True}


@pytest.fixture
def panel() -> Panel:
    return Panel()


def test_it_says_that_it_is_an_emulator(panel: Panel) -> None:
    said = panel.ask(op="identify")
    assert said["ok"] is True
    assert "EMULATOR" in str(said["name"])


def test_the_truth_is_the_result_format(panel: Panel) -> None:
    said = panel.ask(op="truth")
    assert said["truth"] == panel.emulation.context.truth
    assert panel.emulation.context.truth["format"] == "catseye-result/1"


def test_the_state_is_that_of_the_bench(panel: Panel) -> None:
    said = panel.ask(op="state")
    insight = panel.bench.true_state()
    assert said["joints"] == list(CONFIG.start_joints)
    assert said["true_joints"] == pytest.approx(list(insight.joints))
    assert said["xy_mm"] == pytest.approx(list(insight.axis_mm))
    assert (said["moving"], said["servo"], said["alarm"]) == (False, False, 0)
    beam = said["beam"]
    assert isinstance(beam, dict)
    assert beam["nearest"] == "P2"
    assert beam["miss_mm"] == pytest.approx(insight.miss_mm)
    assert beam["largest_miss_mm"] >= beam["miss_mm"]


def test_the_tracker_sees_the_axis_in_its_own_frame() -> None:
    tracker = Tracker(3)
    places = [(300.0, 0.0), (-300.0, 0.0)]
    seen = np.array([[tracker.measure(place) for _ in range(500)] for place in places])
    noise = seen - seen.mean(axis=1, keepdims=True)
    assert np.std(noise) == pytest.approx(0.0075, rel=0.06)
    first, second = seen.mean(axis=1)
    assert np.linalg.norm(first - second) == pytest.approx(600.0, abs=0.002)
    turn_deg = np.degrees(np.arctan2(*(first - second)[::-1]))
    assert 0.01 < abs(turn_deg) < 10.0
    assert np.linalg.norm((first + second) / 2.0) > 10.0


def test_the_tracker_answers_on_the_port(panel: Panel) -> None:
    said = panel.ask(op="tracker")
    assert set(said) == {"ok", "x_mm", "y_mm", "u_mm"}
    assert said["u_mm"] == 0.0075


def test_beam_faults_come_and_go(panel: Panel) -> None:
    # The drawn arm stands a little beside the rough place: bring the reflector to the beam.
    panel.bench.beam.move_reflector("P2", *_way_to_beam(panel))
    assert panel.bench.beam.read().returns
    panel.fault("block_beam", duration_s=1.0)
    assert not panel.bench.beam.read().returns
    panel.bench.advance(1.0)
    assert panel.bench.beam.read().returns
    panel.fault("block_beam")
    panel.bench.advance(1e5)
    assert not panel.bench.beam.read().returns
    panel.fault("clear_faults")
    assert panel.bench.beam.read().returns
    panel.fault("move_reflector", reflector="P2", dx_mm=0.0, dy_mm=50.0)
    assert not panel.bench.beam.read().returns
    said = panel.ask(op="fault", name="move_reflector", reflector="P9")
    assert said == {"ok": False, "error": "there is no reflector 'P9'; there are P1, P2, P3"}


def _way_to_beam(panel: Panel) -> tuple[float, float]:
    insight = panel.bench.true_state()
    x_mm, y_mm = draw_truth(CONFIG.seed, CONFIG).reflectors["P2"]
    direction = np.exp(1j * np.deg2rad(insight.beam_deg))
    foot = complex(*insight.axis_mm) + direction * insight.length_mm
    way = complex(foot - complex(x_mm, y_mm))
    return way.real, way.imag


def test_robot_faults_act_on_the_controller(panel: Panel) -> None:
    controller = panel.emulation.controller
    controller.switch_servo_on()
    panel.bench.advance(1.0)
    assert panel.ask(op="state")["servo"] is True
    panel.fault("servo_off")
    assert panel.ask(op="state")["servo"] is False
    panel.fault("alarm", number=2160)
    assert controller.alarm == 2160
    panel.fault("emergency_stop", on=True)
    assert (controller.emergency_stop, controller.alarm) == (True, 50)
    panel.fault("emergency_stop", on=False)
    assert (controller.emergency_stop, controller.alarm) == (False, 50)
    panel.fault("teach_mode", on=True)
    assert controller.teach_mode
    panel.fault("clear_faults")
    assert (controller.alarm, controller.teach_mode) == (0, False)


def test_an_alarm_stops_a_motion(panel: Panel) -> None:
    controller = panel.emulation.controller
    controller.switch_servo_on()
    panel.bench.advance(1.0)
    controller.move((60.0, 30.0, 0.0, 0.0))
    panel.bench.advance(0.05)
    panel.fault("alarm", number=2602)
    panel.bench.advance(1.0)
    assert 20.0 < panel.bench.joints[0] < 60.0
    assert controller.servo_on


def test_the_air_can_be_wrong_or_missing(panel: Panel) -> None:
    sensor = AirSensor(panel.emulation.context.air.of("environment"), 0x2C)
    good = sensor.read_words(0x0100, 2)
    panel.fault("air", temperature_k=1.0)
    assert sensor.read_words(0x0101, 1)[0] == pytest.approx(good[1] + 100, abs=1)
    panel.fault("air", nan=True)
    assert sensor.read_words(0x0101, 1) == [0x8000]
    panel.fault("clear_faults")
    assert sensor.read_words(0x0100, 2) == good


def test_the_journal_is_a_witness(panel: Panel) -> None:
    emulation = panel.emulation
    session = MelfaSession(
        emulation.controller, "", lambda text: emulation.journal.add("robot", "request", text)
    )
    session.feed(b"1;1;CNTLON\r1;1;SRVON\r")
    assert (session.answer(), session.answer()) == (b"QoK", b"QoK")
    panel.bench.advance(1.0)
    session.feed(b"1;1;EXECMOV (21,30,0,0)\r")
    assert session.answer() == b"QoK"
    panel.bench.advance(0.01)
    session.feed(b"1;1;STOP\r")
    assert session.answer() == b"QoK"
    panel.bench.advance(1.0)
    entries = panel.ask(op="log", device="robot")["entries"]
    assert isinstance(entries, list)
    kinds = [(entry["kind"], entry["text"].split()[0]) for entry in entries]
    assert kinds[2:] == [
        ("request", "1;1;EXECMOV"),
        ("motion", "motion"),
        ("request", "1;1;STOP"),
        ("motion", "stop"),
        ("motion", "arrival"),
    ]
    assert entries[2]["time_s"] == pytest.approx(1.0)
    assert entries[4]["time_s"] == pytest.approx(1.01)
    assert entries[6]["time_s"] < 1.1


def test_the_speed_is_set(panel: Panel) -> None:
    assert panel.ask(op="speed", value=7.0) == {"ok": True}
    assert panel.emulation.keeper.speed == 7.0


@pytest.mark.parametrize(
    ("line", "error"),
    [
        (b"\n", "one JSON object"),
        (b"[]\n", "one JSON object"),
        (b"[" * 50_000 + b"\n", "one JSON object"),
        (b'{"op": 1}\n', "there is no op 1; there are identify, "),
        (b'{"op": "fault"}\n', "there is no fault None; there are block_beam, "),
        (b'{"op": "state", "x": 1}\n', "x: Extra inputs are not permitted"),
        (b'{"op": "fault", "name": "alarm", "number": "1"}\n', "number: "),
        (b'{"op": "fault", "name": "stall", "device": "control", "duration_s": 1}\n', "device: "),
        (b'{"op": "speed", "value": 0}\n', "value: "),
        (b"x" * (LONGEST_BYTES + 1), "one JSON object"),
    ],
)
def test_a_wrong_request_is_answered_with_what_is_wrong(panel: Panel, line: bytes, error: str) -> None:
    said = panel.raw(line)
    assert said["ok"] is False
    assert error in str(said["error"])


@given(st.lists(st.integers(0, 60), max_size=5))
def test_lines_may_be_cut_anywhere(cuts: list[int]) -> None:
    stream = b'{"op": "identify"}\n{"op": "nothing"}\n{"op": "tracker"}\n'
    panel = Panel()
    places = [0, *sorted(cut for cut in cuts if cut < len(stream)), len(stream)]
    said: list[bool] = []
    for start, end in pairwise(places):
        panel.session.feed(stream[start:end])
        while (answer := panel.session.answer()) is not None:
            assert isinstance(answer, bytes)
            said.append(json.loads(answer)["ok"])
    assert said == [True, False, True]
