"""The room around a serial arm: what stands in it, what the arm carries, and where all of it really is.

Its frame is the nominal frame of the arm's base. The base stands a little off it and wanders; links that warm are
longer, all in the same proportion, so that the arm grows from its base.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from catseye.simulators.config import EmulationConfig, SerialBody
from catseye.simulators.errors import BenchError
from catseye.simulators.survey import Mark, Place
from catseye.simulators.world.serial.drift import Drift
from catseye.simulators.world.serial.driven_arm import DrivenArm
from catseye.simulators.world.serial.frames import inverse, placed
from catseye.simulators.world.serial.sight import clear, in_cone
from catseye.simulators.world.serial.station import base_seen
from catseye.simulators.world.types import Bools, Floats

BAR_ENDS = ("bar1", "bar2")
CENTRE = "centre"
"""Nest of the ballbar's cup."""

_U_NEST_MM = 1.0
"""How roughly nests of the table are where the cell file says; nobody relies on it, they are measured."""


@dataclass
class Nest:
    """A nest and its retroreflector.

    Attributes:
        place_mm: true centre, in the frame of the flange, or of the room, shape (3,).
        normal: where the retroreflector looks, of length 1; None: everywhere.
        on_tool: the arm carries it.
        occupied: a retroreflector sits in it.
        loose_mm: standard deviation of each coordinate with which it shifts at each motion.
    """

    place_mm: Floats
    normal: Floats | None
    on_tool: bool
    occupied: bool = True
    loose_mm: float = 0.0


@dataclass
class Room:
    """What stands in the room.

    Args:
        plant: the arm.
        bodies: of the arm.
        config: what the arm carries, and how much wanders.
        now: bench time, s.

    Attributes:
        nests: by name.
    """

    plant: DrivenArm
    bodies: tuple[SerialBody, ...]
    config: EmulationConfig
    now: Callable[[], float]
    nests: dict[str, Nest] = field(init=False)

    def __post_init__(self) -> None:
        survey, seed = self.config.survey, self.config.seed
        self.plant.warming.set_up(survey.growth_ppm, survey.warm_up_s)
        rng = np.random.default_rng([seed, 30])
        self._hands = np.random.default_rng([seed, 31])
        self._drift = Drift(rng, survey.base_drift_um, survey.base_drift_urad)
        self.nests = {
            mark.name: _nest(mark, survey.u_target_mm, rng, on_tool=True) for mark in survey.targets
        }
        for mark in survey.nests:
            nest = _nest(mark, _U_NEST_MM, rng, on_tool=False)
            nest.place_mm = placed(inverse(base_seen(survey)), nest.place_mm)
            self.nests[mark.name] = nest
        if len(self.nests) < len(survey.targets) + len(survey.nests):
            raise BenchError(
                f"two nests have one name; they are called {', '.join(n.name for n in survey.targets)} on the "
                f"tool and {', '.join(n.name for n in survey.nests)} on the table"
            )

        self._cup_mm: Place | None = None
        if survey.cup is not None:
            self.set_up_cup(survey.cup)

    def named(self, name: str) -> Nest:
        """Return a nest.

        Raises:
            BenchError: there is none of that name.
        """
        if name not in self.nests:
            raise BenchError(f"there is no nest {name!r}; there are {', '.join(self.nests)}")
        return self.nests[name]

    @property
    def standstill_s(self) -> float:
        """Bench time at which the present or last motion of the arm ends, s."""
        return self.plant.motion.end_s

    def base_at(self, times_s: Floats) -> Floats:
        """Return the true base at bench times, shape (m, 4, 4)."""
        return np.asarray(self._drift.at(times_s) @ self.plant.base)

    def frames_at(self, times_s: Floats) -> Floats:
        """Return true base and joints at bench times, shape (m, n + 1, 4, 4)."""
        frames = self.plant.screws.frames(self.plant.links_deg(times_s))
        frames[..., :3, 3] *= self.plant.warming.growth(times_s)[:, None, None]
        return np.asarray(self.base_at(times_s)[:, None] @ frames)

    def places_mm(self, names: Iterable[str], times_s: Floats) -> Floats:
        """Return where nests really are at bench times, shape (names, m, 3)."""
        frames = self.frames_at(times_s)
        return np.array([self._placed(self.nests[name], frames, times_s) for name in names])

    def seen(self, name: str, station_mm: Floats, times_s: Floats) -> Bools:
        """Return whether an instrument at a station sees a nest's retroreflector at bench times, shape (m,)."""
        nest = self.nests[name]
        if not nest.occupied:
            return np.zeros(times_s.size, dtype=np.bool_)
        frames = self.frames_at(times_s)
        places = self._placed(nest, frames, times_s)
        found = clear(self.bodies, frames, places, station_mm)
        if nest.normal is not None:
            turned = frames[:, -1, :3, :3] @ nest.normal if nest.on_tool else nest.normal
            found &= in_cone(
                places, np.broadcast_to(turned, places.shape), station_mm, self.config.survey.cone_deg
            )
        return found

    def set_up_bar(self, place_mm: Place, turn_deg: float) -> None:
        """Stand the scale bar on its tripod, level, a retroreflector at either end; hands are off by millimetres.

        Args:
            place_mm: of its middle.
            turn_deg: of its direction about z.
        """
        survey = self.config.survey
        length_mm = survey.bar_mm + 1e-3 * survey.u_bar_um * float(self._bar_error())
        off_mm, off_deg = self._hands.normal(0.0, 5.0, 3), self._hands.normal(0.0, 1.0)
        turn = np.deg2rad(turn_deg + off_deg)
        along = 0.5 * length_mm * np.array([np.cos(turn), np.sin(turn), 0.0])
        middle = np.array(place_mm) + off_mm
        for name, sense in zip(BAR_ENDS, (-1.0, 1.0), strict=True):
            seat = self._hands.normal(0.0, 1e-3 * survey.nest_um, 3)
            self.nests[name] = Nest(middle + sense * along + seat, None, on_tool=False)

    def set_up_cup(self, place_mm: Place) -> None:
        """Put the cup of the ballbar on its post, with a retroreflector in it; hands are a little off.

        Where it stands already, nobody touches it.
        """
        if place_mm == self._cup_mm:
            return
        self._cup_mm = place_mm
        off_mm = self._hands.normal(0.0, self.config.survey.u_cup_mm, 3)
        self.nests[CENTRE] = Nest(np.array(place_mm) + off_mm, None, on_tool=False)

    def put_back(self) -> None:
        """Put every retroreflector into its nest, and fasten it."""
        for nest in self.nests.values():
            nest.occupied, nest.loose_mm = True, 0.0

    def _bar_error(self) -> float:
        return float(np.random.default_rng([self.config.seed, 32]).standard_normal())

    def _placed(self, nest: Nest, frames: Floats, times_s: Floats) -> Floats:
        if not nest.on_tool:
            return np.broadcast_to(nest.place_mm, (times_s.size, 3))
        shaken = np.random.default_rng([self.config.seed, 33, self.plant.motions_begun])
        place_mm = nest.place_mm + nest.loose_mm * shaken.standard_normal(3)
        return placed(frames[:, -1], place_mm)


def _nest(mark: Mark, u_mm: float, rng: np.random.Generator, *, on_tool: bool) -> Nest:
    place_mm = np.array(mark.place_mm) + rng.normal(0.0, u_mm, 3)
    if mark.normal is None:
        return Nest(place_mm, None, on_tool)
    normal = np.array(mark.normal, dtype=np.float64)
    return Nest(place_mm, normal / np.linalg.norm(normal), on_tool)
