"""An emulated bench whose drives hold at once: tests that switch them on need not wait for them."""

from dataclasses import replace

from catseye.simulators.config import EmulationConfig
from tests.system.altered_bench import main


def prompt(config: EmulationConfig) -> EmulationConfig:
    """Return the bench with drives that take 0.05 s to hold."""
    return replace(config, dynamics=replace(config.dynamics, servo_delay_s=0.05))


if __name__ == "__main__":
    main(prompt)
