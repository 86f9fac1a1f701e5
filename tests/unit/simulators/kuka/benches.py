"""Benches of a KR 210 with its controller, for tests: of an arm that does exactly what it is commanded."""

from dataclasses import replace

from catseye.simulators.config import EmulatedDevice, EmulationConfig, Joints, Option, SerialArm
from catseye.simulators.emulated_bench import EmulatedSerialBench
from tests.unit.simulators.world.serial.arms import exact_truth, serial_arm

UPRIGHT: Joints = (0.0, -90.0, 90.0, 0.0, 30.0, 0.0)
"""Away from limits and singularities."""


def kuka_config(*, speed: float = 1.0, options: dict[str, Option] | None = None) -> EmulationConfig:
    """Return the configuration of a KR 210 that stands upright, with its proxy on a free port."""
    device = EmulatedDevice("robot", "kuka-varproxy", options=options or {})
    arm = _exact_arm()
    truth = exact_truth(arm)
    return EmulationConfig(serial=arm, start_joints=UPRIGHT, devices=(device,), speed=speed, truth=truth)


def kuka_bench(*, speed: float = 1.0, options: dict[str, Option] | None = None) -> EmulatedSerialBench:
    """Return its emulated bench."""
    config = kuka_config(speed=speed, options=options)
    return EmulatedSerialBench(config, _exact_arm())


def _exact_arm() -> SerialArm:
    """Return the arm with encoders of no coarser step than floating point."""
    arm = serial_arm("kr210-r2700")
    return replace(arm, joints=tuple(replace(joint, encoder_bits=48) for joint in arm.joints))
