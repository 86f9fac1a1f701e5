"""A SCARA with drivetrains on the bench of serial arms, and what its MELFA controller shows of it."""

import numpy as np
import pytest

from catseye.simulators.config import EmulatedDevice, EmulationConfig, SerialArm
from catseye.simulators.emulated_bench import EmulatedDrivenScara, EmulatedSerialBench, served_bench
from catseye.simulators.errors import BenchError, EmulatorError
from catseye.simulators.world.serial.bench import SerialBench
from tests.unit.simulators.world.serial.arms import exact_truth, serial_arm

SCARA = serial_arm("rh-3frh5515")
START = (0.0, 0.0, 75.0, 0.0)
DEVICES = (EmulatedDevice("robot", "melfa-r3"), EmulatedDevice("robot", "melfa-datalink"))
CONFIG = EmulationConfig(serial=SCARA, start_joints=START, devices=DEVICES, seed=3)


def stand(config: EmulationConfig = CONFIG) -> EmulatedDrivenScara:
    return EmulatedDrivenScara(config, SCARA)


def stepped(bench: SerialBench, joint: int, by_deg: float, count: int) -> list[float]:
    """Return where a joint really stands after each of several equal steps, deg."""
    places = []
    for _ in range(count):
        target = list(bench.joints)
        target[joint] += by_deg
        bench.move_to(tuple(target), 1.0)
        bench.advance(5.0)
        places.append(bench.true_joints[joint])
    return places


@pytest.mark.parametrize(
    ("joint", "low_deg", "high_deg"), [(0, 0.015, 0.027), (1, 0.014, 0.028), (3, 0.002, 0.005)]
)
def test_a_reversal_loses_what_the_carried_beam_shows(joint: int, low_deg: float, high_deg: float) -> None:
    # Between 19 and 23 mdeg at the first two joints and 3 mdeg at the last one on the bench of error maps.
    bench = stand().bench
    there = stepped(bench, joint, 0.1, 10)
    back = stepped(bench, joint, -0.1, 9)
    assert low_deg < back[-1] - there[0] < high_deg


def test_a_step_within_the_friction_is_not_made_whole() -> None:
    bench = stand().bench
    stepped(bench, 0, 0.1, 5)
    before = bench.true_joints[0]
    (after,) = stepped(bench, 0, -0.002, 1)
    assert 0.0 < before - after < 0.001


def test_exact_drivetrains_go_where_they_are_sent() -> None:
    config = EmulationConfig(serial=SCARA, start_joints=START, devices=DEVICES, truth=exact_truth(SCARA))
    bench = stand(config).bench
    bench.move_to((30.0, -40.0, 20.0, 100.0))
    bench.advance(60.0)
    np.testing.assert_allclose(bench.true_joints, (30.0, -40.0, 20.0, 100.0), atol=1e-4)
    # 325 mm at 30° and 225 mm at -10°.
    np.testing.assert_allclose(bench.tracked_mm, (503.0403, 123.4291), atol=2e-3)


def test_motors_are_read_and_not_links() -> None:
    emulation = stand()
    bench = emulation.bench
    stepped(bench, 0, 0.1, 5)
    stepped(bench, 0, -0.01, 1)
    assert abs(bench.measured[0] - bench.joints[0]) < 0.001 < abs(bench.measured[0] - bench.true_joints[0])


def test_angular_optics_do_not_fit_a_joint_that_slides() -> None:
    with pytest.raises(BenchError, match="joint 3 slides"):
        stand().bench.beam.mount_angular(3)


def test_the_robots_protocol_chooses_the_controller() -> None:
    assert isinstance(served_bench(CONFIG), EmulatedDrivenScara)
    kuka = serial_arm("kr210-r2700")
    devices = (EmulatedDevice("robot", "kuka-varproxy"),)
    start = (0.0, -90.0, 90.0, 0.0, 0.0, 0.0)
    config = EmulationConfig(serial=kuka, start_joints=start, devices=devices)
    assert isinstance(served_bench(config), EmulatedSerialBench)


def test_its_controller_drives_no_arm_of_six_joints() -> None:
    kuka: SerialArm = serial_arm("kr210-r2700")
    with pytest.raises(EmulatorError, match="drives a SCARA only"):
        EmulatedDrivenScara(CONFIG, kuka)


def test_real_time_control_is_refused_on_this_bench() -> None:
    devices = (*DEVICES, EmulatedDevice("robot", "melfa-mxt", "udp://127.0.0.1:0"))
    config = EmulationConfig(serial=SCARA, start_joints=START, devices=devices)
    with pytest.raises(EmulatorError, match="carries no beam"):
        EmulatedDrivenScara(config, SCARA)
