"""What an air sensor on the bench measures, right or wrong; every emulated sensor shows this."""

from dataclasses import dataclass

import numpy as np

from catseye.simulators.config import ErrorBudget
from catseye.simulators.world.air import AirSample
from catseye.simulators.world.timed_bench import TimedBench


@dataclass(frozen=True)
class AirFault:
    """What is wrong with the probe.

    Attributes:
        missing: it measures nothing.
        temperature_k: error of the temperature, K.
        pressure_hpa: error of the pressure, hPa.
        humidity_percent: error of the relative humidity, %.
    """

    missing: bool = False
    temperature_k: float = 0.0
    pressure_hpa: float = 0.0
    humidity_percent: float = 0.0


class AirProbe:
    """What the air sensors of the bench measure, right or wrong.

    Args:
        error: as its calibration leaves it; a perfect one by default, for tests.

    Attributes:
        fault: what is wrong with it beside that; tests set it.
    """

    def __init__(self, bench: TimedBench, error: AirSample | None = None) -> None:
        self._bench = bench
        self._error = error or AirSample(0.0, 0.0, 0.0)
        self.fault = AirFault()

    def sample(self) -> AirSample | None:
        """Return what it measures at this moment, None when it measures nothing."""
        if self.fault.missing:
            return None
        air, error = self._bench.air(), self._error
        return AirSample(
            air.temperature_c + error.temperature_c + self.fault.temperature_k,
            air.pressure_hpa + error.pressure_hpa + self.fault.pressure_hpa,
            air.humidity_percent + error.humidity_percent + self.fault.humidity_percent,
        )


def calibrated_probe(bench: TimedBench, seed: int, budget: ErrorBudget) -> AirProbe:
    """Return a probe with the errors of its calibration, drawn from the seed."""
    accuracies = budget.air_temperature_k, budget.air_pressure_hpa, budget.air_humidity_percent
    draws = np.random.default_rng([seed, 16]).standard_normal(3)
    return AirProbe(bench, AirSample(*(float(draw) * u for draw, u in zip(draws, accuracies, strict=True))))
