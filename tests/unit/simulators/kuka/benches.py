"""Benches of a KR 210 with its controller, for tests: of an arm that does exactly what it is commanded."""

from catseye.simulators.config import EmulatedDevice, EmulationConfig, Joints, Option
from catseye.simulators.emulated_bench import EmulatedSerialBench
from tests.unit.simulators.world.serial.arms import exact_arm, exact_truth

UPRIGHT: Joints = (0.0, -90.0, 90.0, 0.0, 30.0, 0.0)
"""Away from limits and singularities."""


def kuka_config(*, speed: float = 1.0, options: dict[str, Option] | None = None) -> EmulationConfig:
    """Return the configuration of a KR 210 that stands upright, with its proxy on a free port."""
    device = EmulatedDevice("robot", "kuka-varproxy", options=options or {})
    arm = exact_arm("kr210-r2700")
    truth = exact_truth(arm)
    return EmulationConfig(serial=arm, start_joints=UPRIGHT, devices=(device,), speed=speed, truth=truth)


def kuka_bench(*, speed: float = 1.0, options: dict[str, Option] | None = None) -> EmulatedSerialBench:
    """Return its emulated bench."""
    config = kuka_config(speed=speed, options=options)
    return EmulatedSerialBench(config, exact_arm("kr210-r2700"))
