"""What encoders show, and where servos stop."""

import numpy as np
import pytest

from catseye.simulators.config import SerialJoint
from catseye.simulators.world.serial.servo import Encoders, Servos
from catseye.simulators.world.serial.truth import JointTruth
from tests.unit.simulators.world.serial.test_drivetrain import JOINT

AXIS = SerialJoint("A", False, 0.0, 0.0, 0.0, 0.0, 1, -180.0, 180.0, 100.0, gear_ratio=100.0, encoder_bits=18)
COUNT_DEG = 360.0 / 2**18 / 100.0
EXACT = JOINT.model_copy(update={"encoder_noise_counts": 0.0, "encoder_error_deg": 0.0})


def encoder(truth: JointTruth) -> Encoders:
    return Encoders([AXIS], [truth], seed=3)


def stop_deg(truth: JointTruth, target_deg: float, motor_deg: float, speed_deg_s: float = 0.1) -> float:
    servos = Servos([truth], encoder(truth), seed=3)
    stops = servos.stops_deg(
        np.array([target_deg]), np.array([motor_deg]), np.array([speed_deg_s]), np.ones(1)
    )
    return float(stops[0])


def test_an_encoder_shows_whole_counts() -> None:
    shown = encoder(EXACT).measured_deg(np.array([12.345]), 0.0)[0] / COUNT_DEG
    assert shown == pytest.approx(round(12.345 / COUNT_DEG), abs=1e-6)


def test_encoder_noise_depends_on_bench_time_alone() -> None:
    noisy = encoder(EXACT.model_copy(update={"encoder_noise_counts": 5.0}))
    times_s = np.arange(200) * 0.1
    first = [float(noisy.measured_deg(np.zeros(1), t)[0]) for t in times_s]
    again = [float(noisy.measured_deg(np.zeros(1), t)[0]) for t in times_s[::-1]]
    assert first == again[::-1]
    assert np.std(first) == pytest.approx(5.0 * COUNT_DEG, rel=0.2)


def test_an_encoder_error_returns_with_each_turn_of_the_motor() -> None:
    encoders = encoder(EXACT.model_copy(update={"encoder_error_deg": 1e-3}))
    # A quarter of a turn of the motor at 1 : 100 is 0.9° of the joint.
    assert encoders.error_deg(np.array([0.9]))[0] == pytest.approx(1e-3)
    assert encoders.error_deg(np.array([4.5]))[0] == pytest.approx(1e-3)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_slow_motor_passes_its_target(sense: float) -> None:
    # 1.5 N m over 4000 N m/deg.
    passed_deg = sense * stop_deg(EXACT, sense * 1.0, 0.0) - 1.0
    assert passed_deg == pytest.approx(1.5 / 4000.0, rel=0.02)


def test_a_fast_motor_stops_at_its_target() -> None:
    assert stop_deg(EXACT, 1.0, 0.0, speed_deg_s=50.0) == pytest.approx(1.0, abs=1e-12)


def test_a_servo_lets_errors_within_its_window_be() -> None:
    patient = EXACT.model_copy(update={"stop_window_deg": 1e-3})
    assert stop_deg(patient, 1.0009, 1.0) == 1.0
    assert stop_deg(patient, 1.0011, 1.0) > 1.0011
