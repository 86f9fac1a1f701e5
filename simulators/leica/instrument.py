"""The emulated tracker behind its controller: what commands do to its beam, in the units of its clients."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.calibration.air import HE_NE_VACUUM_NM, refractive_index
from catseye.simulators.leica import parameters
from catseye.simulators.leica.coordinates import Units, angles_of, direction_mm
from catseye.simulators.leica.packets import PointValues
from catseye.simulators.leica.parameters import Parameters
from catseye.simulators.survey import Place
from catseye.simulators.world.air_probe import AirProbe
from catseye.simulators.world.serial.tracker import GLANCE_S, LaserTracker
from catseye.simulators.world.timed_bench import TimedBench
from catseye.simulators.world.types import Floats

_HOME_MM: Place = (140.0, 0.0, -80.0)
"""The bird bath, in the instrument's frame."""

_NOT_CONNECTED, _CALCULATES = 0, 2
"""States of the weather monitor."""


@dataclass
class Air:
    """What the controller believes of the air: temperature, pressure, humidity, in °C, hPa, %."""

    values: tuple[float, float, float] = (20.0, 1013.25, 50.0)


class Instrument:
    """The tracker.

    Args:
        bench: whose time and air it has.
        tracker: what its controller drives.
        probe: of its weather station.
        kept: what clients have set.
        has_weather: there is a weather station.

    Attributes:
        initialised: it may move and measure.
        last_mm: the last measured point.
    """

    def __init__(
        self,
        bench: TimedBench,
        tracker: LaserTracker,
        probe: AirProbe,
        kept: Parameters,
        *,
        has_weather: bool,
    ) -> None:
        self.bench = bench
        self._tracker = tracker
        self._power_losses = tracker.power_losses
        self.initialised = False
        self.last_mm: Place | None = None
        self._probe = probe
        self._kept = kept
        self._air = Air()
        self._has_weather = has_weather
        self.refresh_air()

    @property
    def units(self) -> Units:
        """Units and coordinates as clients have set them."""
        numbers = tuple(map(int, self._kept[parameters.UNITS]))
        return Units(numbers, int(self._kept[parameters.COORDINATES][0]))

    @property
    def locked(self) -> bool:
        """The beam returns, and the distance is known."""
        return self._tracker.parked or self._tracker.locked

    @property
    def face(self) -> int:
        """1 or 2."""
        return self._tracker.face

    @property
    def beam_mm(self) -> Place:
        """A place on the beam; the true one, which is not to be answered."""
        return _HOME_MM if self._tracker.parked else self._tracker.beam_mm

    @property
    def glance_mm(self) -> Place:
        """A place on the beam as encoders and distance meter show it at this moment."""
        if self._tracker.parked:
            return self._tracker.measure_own(_HOME_MM, GLANCE_S).place_mm
        return self._scaled(self._tracker.glance_mm())

    @property
    def weather(self) -> int:
        """State of the weather monitor."""
        return int(self._kept[parameters.SETTINGS][0]) if self._has_weather else _NOT_CONNECTED

    @property
    def has_power(self) -> bool:
        """Its power was never cut."""
        return self._tracker.power_losses == self._power_losses

    def go_home(self) -> None:
        """Turn the beam to the bird bath."""
        self._tracker.park()

    def aim(self, place_mm: Place | None = None) -> bool:
        """Turn the beam to a place, or search where it points; return whether a target is found."""
        sought = self.beam_mm if place_mm is None else place_mm
        return bool(np.linalg.norm(sought) > 1.0) and self._tracker.aim(sought)

    def aim_along(self, turn_rad: float, zenith_rad: float, distance_mm: float) -> bool:
        """Turn the beam to a direction; return whether a target is found there."""
        return self.aim(direction_mm(turn_rad, zenith_rad, distance_mm))

    def turn(self, turn_rad: float, zenith_rad: float) -> bool:
        """Turn the beam by angles; what it meets it locks on."""
        now_turn, now_zenith = angles_of(self.beam_mm)
        distance_mm = float(np.linalg.norm(self.beam_mm))
        return self.aim(direction_mm(now_turn + turn_rad, now_zenith + zenith_rad, distance_mm))

    def change_face(self) -> None:
        """Turn to the other face."""
        self._tracker.change_face()

    def measure(self, duration_s: float) -> PointValues | None:
        """Return the point measured over the last seconds, in the units of clients; None: the beam was broken."""
        parked = self._tracker.parked
        seen = (
            self._tracker.measure_own(_HOME_MM, duration_s) if parked else self._tracker.measure(duration_s)
        )
        if seen is None:
            return None
        # Half of what the tracker states of itself shows in the readings, half is expected beforehand.
        part = 0.5 * seen.covariance_mm2
        place_mm = self._scaled(seen.place_mm)
        if not parked:
            self.last_mm = place_mm
        return self._shown(place_mm, part)

    def air(self) -> tuple[float, float, float]:
        """Return what the controller believes of the air, in the units of clients."""
        self.refresh_air()
        return self.units.air(self._air.values)

    def set_air(self, values: Sequence[float]) -> None:
        """Believe a client; a weather monitor overrules it at its next reading."""
        self._air.values = self.units.to_air(values)
        self._keep_index()

    def refresh_air(self) -> None:
        """Read the weather station, and have the refractive index follow."""
        sample = self._probe.sample() if self.weather != _NOT_CONNECTED else None
        if sample is not None:
            self._air.values = (sample.temperature_c, sample.pressure_hpa, sample.humidity_percent)
            if self.weather == _CALCULATES:
                self._keep_index()

    def _keep_index(self) -> None:
        index = float(refractive_index(HE_NE_VACUUM_NM, *self._air.values))
        low, high = parameters.REFRACTION_RANGE
        if low <= index <= high:
            self._kept.keep(parameters.REFRACTION, (index, index))

    def _scaled(self, place_mm: Place) -> Place:
        """Return a place as it comes out with the refractive index that the controller believes in."""
        self.refresh_air()
        scale = self.bench.air_index() / self._kept[parameters.REFRACTION][1]
        x, y, z = (scale * value for value in place_mm)
        return x, y, z

    def _shown(self, place_mm: Place, covariance_mm2: Floats) -> PointValues:
        units = self.units
        covariance = units.covariance(place_mm, covariance_mm2)
        return PointValues(units.place(place_mm), covariance, covariance)
