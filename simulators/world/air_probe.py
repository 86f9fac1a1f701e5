"""What an air sensor on the bench measures, right or wrong; every emulated sensor shows this."""

from dataclasses import dataclass

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

    Attributes:
        fault: what is wrong with it; tests set it.
    """

    def __init__(self, bench: TimedBench) -> None:
        self._bench = bench
        self.fault = AirFault()

    def sample(self) -> AirSample | None:
        """Return what it measures at this moment, None when it measures nothing."""
        if self.fault.missing:
            return None
        air = self._bench.air()
        return AirSample(
            air.temperature_c + self.fault.temperature_k,
            air.pressure_hpa + self.fault.pressure_hpa,
            air.humidity_percent + self.fault.humidity_percent,
        )
