"""The air around the bench, with its slow drift."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.air import HE_NE_VACUUM_NM, refractive_index
from catseye.simulators.config import AirState
from catseye.simulators.world.counter import SlowDrift


@dataclass(frozen=True)
class AirSample:
    """State of the air at one bench time.

    Attributes:
        temperature_c: temperature, °C.
        pressure_hpa: pressure, hPa.
        humidity_percent: relative humidity, %.
    """

    temperature_c: float
    pressure_hpa: float
    humidity_percent: float


_INDEX_STEP_S = 1.0
"""The index is worked out once in this bench time: it drifts by some 1e-9 meanwhile, a nanometre of a metre."""


class Air:
    """Air whose state follows from bench time alone."""

    def __init__(self, state: AirState, seed: int) -> None:
        rng = np.random.default_rng([seed, 8])
        self._index: tuple[float, float] | None = None
        self._state = state
        self._drifts = [
            SlowDrift(rng, size) for size in (state.drift_k, state.drift_hpa, state.drift_percent)
        ]

    def at(self, time_s: float) -> AirSample:
        """Return the air's state at a bench time."""
        warmer_k, higher_hpa, wetter_percent = (drift.at(time_s) for drift in self._drifts)
        return AirSample(
            self._state.temperature_c + warmer_k,
            self._state.pressure_hpa + higher_hpa,
            min(100.0, max(0.0, self._state.humidity_percent + wetter_percent)),
        )

    def index_at(self, time_s: float) -> float:
        """Return the refractive index for a helium-neon laser at a bench time."""
        step = time_s // _INDEX_STEP_S
        if self._index is None or self._index[0] != step:
            air = self.at(step * _INDEX_STEP_S)
            n = refractive_index(HE_NE_VACUUM_NM, air.temperature_c, air.pressure_hpa, air.humidity_percent)
            self._index = (step, float(n))
        return self._index[1]


def dew_point_c(temperature_c: float, humidity_percent: float) -> float:
    """Return the dew point, °C (Magnus formula, coefficients of Sonntag 1990)."""
    humidity = max(0.01, humidity_percent) / 100.0
    gamma = math.log(humidity) + 17.62 * temperature_c / (243.12 + temperature_c)
    return 243.12 * gamma / (17.62 - gamma)
