"""The air around the bench, with its slow drift.

Its refractive index follows the equation of Bönsch and Potulski (Metrologia 35, 1998) with the vapour pressure of
Buck (1996). Instruments and this program correct with others, so that a fault of theirs does not cancel.
"""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.air import HE_NE_VACUUM_NM
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


_CO2 = 450e-6
"""Share of the volume."""

_MAGNUS, _MAGNUS_C = 17.62, 243.12
"""Over water, Sonntag 1990; the second one in °C."""

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
            self._index = (step, true_index(air))
        return self._index[1]


def true_index(air: AirSample) -> float:
    """Return the refractive index of air with 450 ppm CO2 for a helium-neon laser."""
    square = (1e3 / HE_NE_VACUUM_NM) ** 2
    pascal, t = 100.0 * air.pressure_hpa, air.temperature_c
    dispersion = 1e-8 * (8091.37 + 2333983.0 / (130.0 - square) + 15518.0 / (38.9 - square))
    dispersion *= 1.0 + 0.5327 * (_CO2 - 0.0004)
    density = pascal / 93214.60 * (1.0 + 1e-8 * (0.5953 - 0.009876 * t) * pascal) / (1.0 + 0.0036610 * t)
    saturated_pa = 611.21 * math.exp((18.678 - t / 234.5) * t / (257.14 + t))
    vapour_pa = air.humidity_percent / 100.0 * saturated_pa
    return 1.0 + dispersion * density - 1e-10 * vapour_pa * (3.8020 - 0.0384 * square)


def dew_point_c(temperature_c: float, humidity_percent: float) -> float:
    """Return the dew point, °C (Magnus formula, coefficients of Sonntag 1990)."""
    humidity = max(0.01, humidity_percent) / 100.0
    gamma = math.log(humidity) + _MAGNUS * temperature_c / (_MAGNUS_C + temperature_c)
    return _MAGNUS_C * gamma / (_MAGNUS - gamma)
