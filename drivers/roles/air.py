"""An air sensor."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Protocol

from catseye.drivers.roles.device import Device, Role


@dataclass(frozen=True)
class AirSample:
    """State of the air. A quantity that the sensor does not measure is None.

    Attributes:
        temperature_c: temperature, °C.
        pressure_hpa: pressure, hPa.
        humidity_percent: relative humidity, %.
        time_s: arrival, on the driver's clock, s.
    """

    temperature_c: float | None
    pressure_hpa: float | None
    humidity_percent: float | None
    time_s: float = 0.0


class AirSensor(Device, Protocol):
    """A sensor of the air, or of the temperature of something else."""

    role: ClassVar[Role] = "environment"

    @abstractmethod
    async def sample(self) -> AirSample:
        """Return the state of the air now."""
        ...
