"""Benches of an IRB 120 with its controller, for tests: of an arm that does exactly what it is commanded."""

from catseye.simulators.config import EmulatedDevice, EmulationConfig, Joints, Option
from catseye.simulators.emulated_bench import EmulatedAbbBench
from tests.unit.simulators.world.serial.arms import exact_arm, exact_truth

BENT: Joints = (0.0, 0.0, 0.0, 0.0, 30.0, 0.0)
"""Away from limits and singularities."""


def abb_config(*, speed: float = 1.0, options: dict[str, Option] | None = None) -> EmulationConfig:
    """Return the configuration of an IRB 120 with Robot Web Services on a free port."""
    device = EmulatedDevice("robot", "abb-rws", options=options or {})
    arm = exact_arm("irb120")
    truth = exact_truth(arm)
    return EmulationConfig(serial=arm, start_joints=BENT, devices=(device,), speed=speed, truth=truth)


def abb_bench(*, speed: float = 1.0, options: dict[str, Option] | None = None) -> EmulatedAbbBench:
    """Return its emulated bench."""
    return EmulatedAbbBench(abb_config(speed=speed, options=options), exact_arm("irb120"))
