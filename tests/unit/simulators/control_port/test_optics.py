"""Hands on the optics beside a serial arm, by the control port, and the counters that look along them."""

import json
from typing import TypeVar

import numpy as np
import pytest

from catseye.simulators.config import EmulatedDevice, EmulationConfig, TruthText
from catseye.simulators.control_port.exchange import Answer, RefusedRequestError, Request
from catseye.simulators.control_port.faults import BlockBeam, ClearFaults, MoveReflector
from catseye.simulators.control_port.messages import (
    MountAngularOptics,
    MountInterferometer,
    MountLinearOptics,
    OpticsState,
    ReadOptics,
    ReadTruth,
    TurnScrew,
)
from catseye.simulators.control_port.operations import ControlSession
from catseye.simulators.emulated_bench import EmulatedBench, EmulatedSerialBench
from catseye.simulators.errors import TruthFileError
from catseye.simulators.world.serial.truth import draw_joint_truth, joint_truth_document
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.world.serial.arms import TOOL, serial_arm

ARM = serial_arm("kr210-r2700", TOOL)
START = (0.0, -90.0, 90.0, 0.0, 0.0, 0.0)
DEVICES = (EmulatedDevice("robot", "kuka-varproxy"), EmulatedDevice("interferometer", "line-counter"))
CONFIG = EmulationConfig(serial=ARM, start_joints=START, devices=DEVICES, seed=3)

A = TypeVar("A", bound=Answer)


class Stand:
    """A client of the control port of a bench that does not listen; only the test lets bench time pass."""

    def __init__(self) -> None:
        self.emulation = EmulatedSerialBench(CONFIG, ARM)
        self.bench = self.emulation.bench
        self.counter = self.emulation.context.instrument("interferometer")
        self._session = ControlSession(self.emulation.reach)

    def ask(self, request: Request[A]) -> A:
        return answered(self._session, request)


def answered(session: ControlSession, request: Request[A]) -> A:
    session.feed(request.encode())
    answer = session.answer()
    assert isinstance(answer, bytes)
    return request.decode(answer)


def test_nothing_is_mounted_at_first() -> None:
    stand = Stand()
    state = stand.ask(ReadOptics())
    assert (state.kind, state.joint, state.returns) == (None, None, False)
    assert not stand.counter.zero()


def test_hands_mount_and_align_angular_optics() -> None:
    stand = Stand()
    mounted = stand.ask(MountAngularOptics(joint="A3"))
    assert (mounted.kind, mounted.joint, mounted.returns) == ("angular", "A3", True)
    for screw in ("pitch", "yaw"):
        stand.ask(TurnScrew(screw=screw, turns=-mounted.tilts_mrad[screw]))
    aligned = stand.ask(ReadOptics())
    assert aligned.miss < 0.1 < mounted.miss
    assert stand.counter.read().level > 0.95


def test_a_counter_counts_the_turn_of_the_joint() -> None:
    stand = Stand()
    spacing_mm = stand.ask(MountAngularOptics(joint="A5")).spacing_mm
    assert stand.counter.zero()
    before = stand.bench.true_joints[4]
    stand.bench.move_to((0.0, -90.0, 90.0, 0.0, 1.0, 0.0), 1.0)
    stand.bench.advance(20.0)
    shown_deg = np.rad2deg(np.arcsin(stand.counter.read().displacement_mm / spacing_mm))
    assert shown_deg == pytest.approx(stand.bench.true_joints[4] - before, abs=1e-3)
    assert stand.bench.velocity_mm_s() == pytest.approx(0.0, abs=0.1)


def test_linear_optics_take_the_place_of_angular_ones() -> None:
    stand = Stand()
    stand.ask(MountAngularOptics(joint="A1"))
    state = stand.ask(MountLinearOptics(axis="Z"))
    assert (state.kind, state.joint, state.returns) == ("linear", "A6", True)
    assert stand.counter.read().beam_lost


def test_an_obstacle_stops_the_beam_until_faults_are_cleared() -> None:
    stand = Stand()
    stand.ask(MountAngularOptics(joint="A1"))
    stand.ask(BlockBeam())
    assert not stand.ask(ReadOptics()).returns
    stand.ask(ClearFaults())
    assert stand.ask(ReadOptics()).returns


@pytest.mark.parametrize(
    ("request_", "said"),
    [
        (MountAngularOptics(joint="A7"), "no joint 'A7'; there are A1, A2"),
        (TurnScrew(screw="stage", turns=1.0), "no screw 'stage'; there are pitch, yaw"),
        (MountInterferometer(turned_deg=90.0), "carries no beam"),
        (MoveReflector(reflector="P1"), "carries no beam"),
    ],
)
def test_what_this_bench_does_not_have_is_refused(request_: Request[Answer], said: str) -> None:
    with pytest.raises(RefusedRequestError, match=said):
        Stand().ask(request_)


@pytest.mark.parametrize("request_", [ReadOptics(), MountAngularOptics(joint="A1")])
def test_a_scara_has_no_optics_beside_it(request_: Request[OpticsState]) -> None:
    session = ControlSession(EmulatedBench(QUIET).reach)
    with pytest.raises(RefusedRequestError, match="no serial arm"):
        answered(session, request_)


def test_the_truth_is_that_of_the_drivetrains() -> None:
    stand = Stand()
    document = json.loads(json.dumps(joint_truth_document(draw_joint_truth(ARM, CONFIG.seed))))
    assert stand.ask(ReadTruth()).truth["drivetrains"] == document["joints"]


def test_a_stated_truth_takes_the_place_of_a_drawn_one() -> None:
    document = joint_truth_document(draw_joint_truth(ARM, 77))
    config = EmulationConfig(
        serial=ARM, start_joints=START, devices=(), truth=TruthText(json.dumps(document).encode(), "t.json")
    )
    assert EmulatedSerialBench(config, ARM).context.truth["drivetrains"] == document["joints"]


def test_a_truth_of_another_format_is_refused() -> None:
    config = EmulationConfig(
        serial=ARM, start_joints=START, devices=(), truth=TruthText(b'{"format": "x"}', "t.json")
    )
    with pytest.raises(TruthFileError, match=r"t\.json: format"):
        EmulatedSerialBench(config, ARM)
