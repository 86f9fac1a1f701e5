"""What the control port shows and does of a bench with a KUKA."""

import math

import pytest

from catseye.simulators.control_port.messages import (
    ArmState,
    PressKey,
    ReadArm,
    ReadState,
    Track,
    TrackedPlace,
)
from catseye.simulators.control_port.operations import carry_out
from catseye.simulators.emulated_bench import EmulatedBench
from catseye.simulators.errors import EmulatorError
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.kuka.benches import UPRIGHT, kuka_bench


def test_the_arms_state_is_shown() -> None:
    state = carry_out(ReadArm(), kuka_bench().reach)
    assert isinstance(state, ArmState)
    assert (state.joints, state.moving, state.servo, state.alarm) == (UPRIGHT, False, True, 0)


def test_a_tracker_sees_the_flange_in_its_frame() -> None:
    bench = kuka_bench()
    seen, places = [], []
    for a1_deg in (0.0, 30.0):
        bench.bench.move_to((a1_deg, *UPRIGHT[1:]))
        bench.bench.advance(5.0)
        tracked = carry_out(Track(), bench.reach)
        assert isinstance(tracked, TrackedPlace)
        seen.append((tracked.x_mm, tracked.y_mm))
        places.append([float(bench.controller.variables.read(f"$POS_ACT.{axis}")) for axis in "XY"])
    assert math.dist(*seen) == pytest.approx(math.dist(*places), abs=10.0 * bench.reach.tracker.u_mm)


def test_the_panel_is_pressed_through_the_port() -> None:
    bench = kuka_bench()
    carry_out(PressKey(key="T1"), bench.reach)
    assert bench.controller.variables.read("$MODE_OP") == "#T1"


def test_the_panel_of_a_melfa_has_no_such_key() -> None:
    with pytest.raises(EmulatorError, match="no key"):
        carry_out(PressKey(key="start"), EmulatedBench(QUIET).reach)


def test_a_serial_bench_has_no_state_of_a_scaras_beam() -> None:
    with pytest.raises(EmulatorError, match="no beam"):
        carry_out(ReadState(), kuka_bench().reach)
