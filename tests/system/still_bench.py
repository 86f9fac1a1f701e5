"""An emulated bench whose distances have no errors of their own: a miscount of a single fringe shows."""

from dataclasses import replace

from catseye.simulators.config import EmulationConfig, ErrorBudget
from tests.system.altered_bench import main


def still(config: EmulationConfig) -> EmulationConfig:
    """Return the bench without errors of distances and of the beam's mounting."""
    return replace(config, budget=ErrorBudget.none(), beam_offset_mm=0.0, beam_pitch_mrad=0.0)


if __name__ == "__main__":
    main(still)
