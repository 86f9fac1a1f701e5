"""An emulated bench without measuring errors: what two runs on it differ by is the program's doing."""

from dataclasses import replace

from catseye.simulators.config import EmulationConfig, ErrorBudget
from tests.system.altered_bench import main


def quiet(config: EmulationConfig) -> EmulationConfig:
    """Return the bench without errors of distances, of the beam's mounting and of J4."""
    return replace(
        config,
        budget=ErrorBudget.none(),
        beam_offset_mm=0.0,
        beam_pitch_mrad=0.0,
        scara=replace(config.scara, j4_backlash_mdeg=0.0),
    )


if __name__ == "__main__":
    main(quiet)
