"""What the air sensors of a bench measure, right or wrong: each with the errors of its own calibration and noise."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from catseye.simulators.config import ErrorBudget
from catseye.simulators.world.air import AirSample
from catseye.simulators.world.timed_bench import TimedBench
from catseye.simulators.world.types import Floats

_CYCLE_S = 1.0
"""A sensor measures anew once in this bench time; an assumption."""

_NOISE = 0.1
"""Standard deviation of one reading, as a part of the accuracy; an assumption."""

_MAIN = "environment"
"""Name of the sensor that every cell has."""


@dataclass(frozen=True)
class AirFault:
    """What is wrong with the air sensors of a bench.

    Attributes:
        missing: they measure nothing.
        temperature_k: error of the temperature, K.
        pressure_hpa: error of the pressure, hPa.
        humidity_percent: error of the relative humidity, %.
    """

    missing: bool = False
    temperature_k: float = 0.0
    pressure_hpa: float = 0.0
    humidity_percent: float = 0.0


class AirProbe:
    """One sensor.

    Args:
        error: its error at a bench time, shape (3,): K, hPa, %; None: a perfect one, for tests.

    Attributes:
        fault: what is wrong with it beside that; tests set it.
    """

    def __init__(self, bench: TimedBench, error: Callable[[float], Floats] | None = None) -> None:
        self._bench = bench
        self._error = error or (lambda _time_s: np.zeros(3))
        self.fault = AirFault()

    def sample(self) -> AirSample | None:
        """Return what it measures at this moment, None when it measures nothing."""
        fault = self.fault
        if fault.missing:
            return None
        air = self._bench.air()
        true = np.array([air.temperature_c, air.pressure_hpa, air.humidity_percent])
        wrong = np.array([fault.temperature_k, fault.pressure_hpa, fault.humidity_percent])
        temperature_c, pressure_hpa, humidity_percent = (
            true + wrong + self._error(self._bench.time_s)
        ).tolist()
        return AirSample(temperature_c, pressure_hpa, humidity_percent)


class AirSensors:
    """The sensors of a bench by the names of their devices; all endpoints of a device lead to the same one.

    Args:
        accuracy: standard deviation of what calibrations leave, K, hPa and %.
    """

    def __init__(self, bench: TimedBench, seed: int = 0, accuracy: ErrorBudget | None = None) -> None:
        budget = accuracy or ErrorBudget.none()
        self._bench, self._seed = bench, seed
        self._u = np.array([budget.air_temperature_k, budget.air_pressure_hpa, budget.air_humidity_percent])
        self._probes: dict[str, AirProbe] = {}
        self._fault = AirFault()

    @property
    def fault(self) -> AirFault:
        """What is wrong with all of them; tests set it."""
        return self._fault

    @fault.setter
    def fault(self, fault: AirFault) -> None:
        self._fault = fault
        for probe in self._probes.values():
            probe.fault = fault

    def of(self, device: str) -> AirProbe:
        """Return the sensor of a device."""
        if device not in self._probes:
            probe = AirProbe(self._bench, self._error_of(device))
            probe.fault = self._fault
            self._probes[device] = probe
        return self._probes[device]

    def _error_of(self, device: str) -> Callable[[float], Floats]:
        own = [] if device == _MAIN else list(device.encode())
        constant = self._u * np.random.default_rng([self._seed, 16, *own]).standard_normal(3)
        key = int(np.random.default_rng([self._seed, 18, *own]).integers(2**63))

        def error(time_s: float) -> Floats:
            cycle = int(time_s // _CYCLE_S)
            noise = np.random.Generator(np.random.Philox(key=key, counter=[0, 0, 0, cycle]))
            return np.asarray(constant + _NOISE * self._u * noise.standard_normal(3))

        return error
