"""The bench of a SCARA that carries the interferometer."""

from catseye.simulators.config import EmulationConfig
from catseye.simulators.world.bench import Bench, OnEvent
from catseye.simulators.world.scara.arm import ScaraArm
from catseye.simulators.world.scara.truth import TrueArm


def scara_bench(truth: TrueArm, config: EmulationConfig, on_event: OnEvent | None = None) -> Bench:
    """Return the bench on which a true arm stands; see `Bench`."""
    return Bench(ScaraArm(truth, config), truth.reflectors, config, on_event)
