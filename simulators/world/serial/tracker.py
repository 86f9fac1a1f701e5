"""A laser tracker beside an arm: its beam, what the beam is locked on, and how well it measures.

It measures a distance and two angles. Its frame stands where its axes cross; z is its standing axis. The beam follows
a retroreflector while that is seen, and hangs in the air once it was not; then it has to be led to one again.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from catseye.simulators.config import EmulationConfig
from catseye.simulators.errors import BenchError
from catseye.simulators.survey import Place
from catseye.simulators.world.beam_path import BeamPath
from catseye.simulators.world.serial.frames import placed
from catseye.simulators.world.serial.optics import Wander
from catseye.simulators.world.serial.station import Station
from catseye.simulators.world.types import Bools, Floats

Face = Literal[1, 2]

_FOLLOWED_S = 0.05
_CALM_S = 1.0
_MOST_LOOKS = 2000
_SAMPLES_PER_S = 20.0
_HOME = (1000.0, 0.0, 0.0)
"""Where the beam points at first, in the tracker's frame."""

_TURBULENCE_S = (0.5, 20.0)
"""Periods of the air's turbulence."""

_M_PER_MM = 1e-3

GLANCE_S = 0.02
"""How long a tracker measures what it shows without a measurement; an assumption."""

_BY_HAND_MM = 5.0
"""How well hands lead the beam to a retroreflector, each coordinate."""


class Surroundings(Protocol):
    """What stands around a tracker. Places are in the frame of the room."""

    @property
    def nests(self) -> Mapping[str, object]:
        """Nests of retroreflectors by their names."""
        ...

    @property
    def standstill_s(self) -> float:
        """Bench time at which the present or last motion of the arm ends, s."""
        ...

    def places_mm(self, names: Iterable[str], times_s: Floats) -> Floats:
        """Return where nests really are at bench times, shape (names, m, 3)."""
        ...

    def seen(self, name: str, station_mm: Floats, times_s: Floats) -> Bools:
        """Return whether an instrument at a station sees a nest's retroreflector at bench times, shape (m,)."""
        ...


@dataclass(frozen=True)
class Sighting:
    """A measured retroreflector.

    Attributes:
        target: the nest in which it really sits; no wire carries that.
        place_mm: measured place, in the tracker's frame.
        covariance_mm2: of x, y and z that the instrument states, shape (3, 3): of its noise, nothing of what it does
            not know of itself.
    """

    target: str
    place_mm: Place
    covariance_mm2: Floats


class LaserTracker:
    """The tracker.

    Args:
        room: what stands around it.
        config: where it stands, and its errors.
        now: bench time, s.

    Attributes:
        station: where it stands.
        face: 1 or 2.
        parked: the beam is in the tracker's own home position.
        power_losses: how often its power was cut.
    """

    def __init__(self, room: Surroundings, config: EmulationConfig, now: Callable[[], float]) -> None:
        survey = config.survey
        self._room, self._survey, self._now = room, survey, now
        self.station = Station(config, survey.tracker_mm, 0)
        self.face: Face = 1
        self.parked = False
        self.power_losses = 0
        self._path = BeamPath()
        rng = np.random.default_rng([config.seed, 36])
        self._zero_mm = 1e-3 * survey.zero_um * float(rng.standard_normal())
        self._face_rad = 1e-6 * survey.face_urad * rng.standard_normal(2)
        # Half of the noise is turbulence, which no average of seconds takes away; parts of 1 here.
        self._air = [Wander(rng, np.sqrt(0.5), _TURBULENCE_S) for _ in range(3)]
        self._noise = np.random.default_rng([config.seed, 37])
        self._glances = np.random.default_rng([config.seed, 45])
        self._hands = np.random.default_rng([config.seed, 38])
        self._beam_mm: Floats = np.array(_HOME)
        self._locked: str | None = None
        self._looked_s = now()

    @property
    def target(self) -> str | None:
        """Nest of the retroreflector that the beam follows; no wire carries that."""
        return self._follow()

    @property
    def locked(self) -> bool:
        """The beam returns from a retroreflector that it follows."""
        return self._follow() is not None

    @property
    def beam_mm(self) -> Place:
        """A place on the beam, in the tracker's frame: of the retroreflector if it is locked on one.

        It is the true one, which no wire carries; see `glance_mm`.
        """
        self._follow()
        x, y, z = self._beam_mm.tolist()
        return x, y, z

    def park(self) -> None:
        """Turn the beam to its home position; what it followed goes its own way."""
        self._follow()
        self._locked = None
        self.parked = True

    def lose_power(self) -> None:
        """Let go of what the beam follows: there is none any more, and no zero of the angles."""
        self._locked = None
        self.parked = False
        self.face = 1
        self._beam_mm = np.array(_HOME)
        self.power_losses += 1

    def aim(self, near_mm: Place | None = None) -> bool:
        """Turn the beam to a place, search around it, and lock on what is found; the nearer one of two in one line.

        Args:
            near_mm: where, in the tracker's frame; None: where the beam points already.

        Returns:
            Whether something was found.

        Raises:
            BenchError: the place is the tracker's own.
        """
        self._follow()
        self.parked = False
        if near_mm is not None:
            if not np.linalg.norm(near_mm) > 1.0:
                raise BenchError(
                    "the laser tracker cannot point at itself: the place has to be at a distance"
                )
            self._beam_mm = np.array(near_mm)
        self._locked = self._found()
        self._looked_s = self._now()
        return self._follow() is not None

    def lead(self, name: str) -> bool:
        """Have hands lead the beam to a nest's retroreflector, and search there.

        Returns:
            Whether it was found.

        Raises:
            BenchError: there is no such nest.
        """
        if name not in self._room.nests:
            raise BenchError(f"there is no nest {name!r}; there are {', '.join(self._room.nests)}")
        place = self._in_frame(name, np.array([self._now()]))[0]
        x, y, z = (place + self._hands.normal(0.0, _BY_HAND_MM, 3)).tolist()
        return self.aim((x, y, z))

    def change_face(self) -> None:
        """Turn to the other face, and to the same retroreflector."""
        self.face = 2 if self.face == 1 else 1
        self.aim()

    def block(self, duration_s: float | None) -> None:
        """Hold something into the beam, wherever it points, for a time in s or until it is taken away."""
        self._follow()
        self._path.block(self._now(), np.inf if duration_s is None else self._now() + duration_s)

    def unblock(self) -> None:
        """Take away what stands in the beam."""
        self._follow()
        self._path.block(np.inf, np.inf)

    def measure(self, duration_s: float) -> Sighting | None:
        """Return the mean of what the tracker measured in the last seconds of bench time, in its frame.

        None: the beam was not locked on one retroreflector for all of that time.

        Args:
            duration_s: above 0; the caller lets that time pass beforehand.
        """
        name = self._follow()
        if name is None:
            return None
        times_s = self._past(duration_s)
        true_mm = self._in_frame(name, times_s)
        if not self._steady(name, times_s):
            return None
        return self._measured(name, true_mm, times_s, duration_s, self._noise)

    def glance_mm(self) -> Place:
        """Return a place on the beam as the tracker shows it at this moment, without measuring for longer."""
        now = np.array([self._now()])
        seen = self._measured("", np.array([self.beam_mm]), now, GLANCE_S, self._glances)
        return seen.place_mm

    def measure_own(self, place_mm: Place, duration_s: float) -> Sighting:
        """Return the mean of what the tracker measured of a retroreflector that it carries itself; see `measure`.

        Args:
            place_mm: where that is, in the tracker's frame.
        """
        return self._measured("", np.array([place_mm]), self._past(duration_s), duration_s, self._glances)

    def point_at(self, near_mm: Place | None, duration_s: float, face: Face = 1) -> Sighting | None:
        """Aim in a face and measure as if the last seconds had been spent on it; see `aim` and `measure`."""
        self.face = face
        return self.measure(duration_s) if self.aim(near_mm) else None

    def _past(self, duration_s: float) -> Floats:
        until_s = self._now()
        count = min(max(2, int(np.ceil(duration_s * _SAMPLES_PER_S)) + 1), _MOST_LOOKS)
        return np.linspace(max(0.0, until_s - duration_s), until_s, count)

    def _measured(
        self, name: str, true_mm: Floats, times_s: Floats, duration_s: float, rng: np.random.Generator
    ) -> Sighting:
        mean_mm = true_mm.mean(axis=0)
        range_mm = float(np.linalg.norm(mean_mm))
        along, across = self._sigmas_mm(range_mm)
        white = rng.standard_normal(3) * np.sqrt(0.5 / max(duration_s, 1e-3))
        air = np.array([wander.at(times_s).mean() for wander in self._air])
        off = (white + air) * np.array([along, across, across])
        u, v = _across(mean_mm)
        place = mean_mm + (off[0] + self._zero_mm) * mean_mm / range_mm + off[1] * u + off[2] * v
        place = place + range_mm * self._turned_by_face(u, v)
        stated = np.sqrt(0.5 + 0.5 / max(duration_s, 1e-3)) * np.array([along, across, across])
        axes = np.column_stack([mean_mm / range_mm, u, v])
        x, y, z = place.tolist()
        return Sighting(name, (x, y, z), np.asarray((axes * stated**2) @ axes.T))

    def _sigmas_mm(self, range_mm: float) -> tuple[float, float]:
        survey, range_m = self._survey, _M_PER_MM * range_mm
        return (
            1e-3 * (survey.range_um + survey.range_um_per_m * range_m),
            1e-3 * (survey.angle_um + survey.angle_um_per_m * range_m),
        )

    def _turned_by_face(self, u: Floats, v: Floats) -> Floats:
        """Return what collimation and index errors turn a direction by, of the other sign in the other face."""
        sense = 1.0 if self.face == 1 else -1.0
        collimation, index = sense * self._face_rad
        return np.asarray(collimation * u + index * v)

    def _found(self) -> str | None:
        """Return the nearest retroreflector that the beam finds where it points."""
        now = np.array([self._now()])
        towards = self._beam_mm / np.linalg.norm(self._beam_mm)
        found: list[tuple[float, str]] = []
        for name in self._room.nests:
            place = self._in_frame(name, now)[0]
            along = float(place @ towards)
            beside = float(np.linalg.norm(place - along * towards))
            if along > 0.0 and beside <= self._survey.search_mm and self._steady(name, now):
                found.append((along, name))
        return min(found)[1] if found else None

    def _follow(self) -> str | None:
        """Return what the beam is locked on, after all that happened since somebody looked last."""
        now_s = self._now()
        if self._locked is not None:
            times_s = self._since_last_look(now_s)
            broken = self._path.met(self._looked_s, now_s)
            if not broken and self._locked in self._room.nests and self._steady(self._locked, times_s):
                self._beam_mm = self._in_frame(self._locked, times_s[-1:])[0]
            else:
                self._locked = None
        self._looked_s = now_s
        return self._locked

    def _since_last_look(self, now_s: float) -> Floats:
        """Return when to look whether the beam was lost: often while the arm moves, and at this moment."""
        until_s = min(now_s, self._room.standstill_s + _CALM_S)
        count = max(0, int(np.ceil((until_s - self._looked_s) / _FOLLOWED_S)))
        return np.append(np.linspace(self._looked_s, until_s, min(count, _MOST_LOOKS)), now_s)

    def _steady(self, name: str, times_s: Floats) -> bool:
        """Return whether the beam met a retroreflector at some times in order, and nothing between."""
        if self._path.met(times_s[0], times_s[-1]):
            return False
        station_mm = self.station.frame_at(times_s)[:, :3, 3]
        return bool(self._room.seen(name, station_mm, times_s).all())

    def _in_frame(self, name: str, times_s: Floats) -> Floats:
        """Return where a nest really is in the tracker's frame, shape (m, 3)."""
        return placed(self.station.into_at(times_s), self._room.places_mm([name], times_s)[0])


def _across(place_mm: Floats) -> tuple[Floats, Floats]:
    """Return the directions in which a beam turns with the standing and with the tilting axis."""
    x, y, _ = place_mm
    level = float(np.hypot(x, y))
    u = np.array([-y, x, 0.0]) / level if level else np.array([0.0, 1.0, 0.0])
    v = np.cross(place_mm / np.linalg.norm(place_mm), u)
    return u, v
