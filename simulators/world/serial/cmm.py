"""An optical CMM beside a serial arm: it measures the pose of everything that carries marks, from those it sees.

Each mark is seen with noise and with an error of the place in the volume; the pose is what fits them best.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from catseye.simulators.config import EmulationConfig
from catseye.simulators.errors import BenchError
from catseye.simulators.survey import Mark, SurveyConfig
from catseye.simulators.world.beam_path import BeamPath
from catseye.simulators.world.serial.frames import placed
from catseye.simulators.world.serial.room import Room
from catseye.simulators.world.serial.sight import clear, in_cone
from catseye.simulators.world.serial.station import Station
from catseye.simulators.world.types import Bools, Floats

Artifact = Literal["tool", "base"]

_FEWEST = 3
_FRAMES_PER_S = 30.0
"""Of an optical CMM (six-axis paper, section 1)."""

_WAVE_MM = 700.0


@dataclass(frozen=True)
class SeenPose:
    """A measured pose.

    Attributes:
        frame: of the artifact in the frame of the CMM, mm, shape (4, 4).
        visible: how many marks were seen.
        of: how many the artifact has.
    """

    frame: Floats
    visible: int
    of: int


class OpticalCmm:
    """The CMM.

    Args:
        room: what stands around it.
        config: where it stands, its marks and its errors.
        now: bench time, s.

    Attributes:
        station: where it stands.
    """

    def __init__(self, room: Room, config: EmulationConfig, now: Callable[[], float]) -> None:
        survey = config.survey
        self._room, self._survey, self._now = room, survey, now
        self.station = Station(config, survey.cmm_mm, 1)
        self._path = BeamPath()
        marks = {"tool": survey.tool_marks or plate_marks(survey), "base": survey.base_marks or BASE_MARKS}
        self._places = {name: np.array([mark.place_mm for mark in of]) for name, of in marks.items()}
        self._normals = {name: np.array([_normal(mark) for mark in of]) for name, of in marks.items()}
        rng = np.random.default_rng([config.seed, 38])
        self._volume = rng.normal(0.0, 2.0 * np.pi / _WAVE_MM, (3, 3)), rng.uniform(0.0, 2.0 * np.pi, 3)
        self._noise = np.random.default_rng([config.seed, 39])

    def block(self, duration_s: float | None) -> None:
        """Stand in its way, for a time in s or for ever."""
        self._path.block(self._now(), np.inf if duration_s is None else self._now() + duration_s)

    def unblock(self) -> None:
        """Go out of its way."""
        self._path.block(np.inf, np.inf)

    def pose(self, artifact: Artifact, duration_s: float) -> SeenPose | None:
        """Return the mean pose over the last seconds of bench time; None: too few marks are seen for any.

        Args:
            artifact: tool, whose frame is that of the flange, or base, whose frame is that of the arm's base.
            duration_s: above 0; the caller lets that time pass beforehand.

        Raises:
            BenchError: nothing of that name carries marks.
        """
        if artifact not in get_args(Artifact):
            raise BenchError(
                f"nothing called {artifact!r} carries marks; there are {', '.join(get_args(Artifact))}"
            )
        times_s = np.linspace(max(0.0, self._now() - duration_s), self._now(), 5)
        seen = self._visible(artifact, times_s)
        count = int(seen.sum())
        if count < _FEWEST:
            return None
        drawn = self._places[artifact][seen]
        frames = self.station.into_at(times_s) @ self._carrier(artifact, times_s)
        true_mm = placed(frames[:, None], drawn).mean(axis=0)
        averaged = max(1.0, duration_s * _FRAMES_PER_S)
        noise = self._noise.normal(
            0.0, 1e-3 * self._survey.mark_um / np.sqrt(min(averaged, 10.0)), (count, 3)
        )
        fitted = _fitted(drawn, true_mm + self._warped(true_mm) + noise)
        return None if fitted is None else SeenPose(fitted, count, len(self._places[artifact]))

    def _carrier(self, artifact: Artifact, times_s: Floats) -> Floats:
        if artifact == "base":
            return self._room.base_at(times_s)
        return self._room.frames_at(times_s)[:, -1]

    def _visible(self, artifact: Artifact, times_s: Floats) -> Bools:
        """Return which marks are seen at all of some times, shape (marks,)."""
        station = self.station.frame_at(times_s)[:, :3, 3]
        frames, carrier = self._room.frames_at(times_s), self._carrier(artifact, times_s)
        if self._path.met(times_s[0], times_s[-1]):
            return np.zeros(len(self._places[artifact]), dtype=np.bool_)
        found = []
        for place, normal in zip(self._places[artifact], self._normals[artifact], strict=True):
            places, turned = placed(carrier, place), carrier[:, :3, :3] @ normal
            looks = in_cone(places, turned, station, self._survey.mark_cone_deg)
            found.append(bool((looks & clear(self._room.bodies, frames, places, station)).all()))
        return np.array(found)

    def _warped(self, places_mm: Floats) -> Floats:
        """Return the error of places in the volume, a smooth function of them, mm."""
        rates, phases = self._volume
        waves: Floats = np.sqrt(2.0) * np.sin(places_mm @ rates + phases)
        return 1e-3 * self._survey.volume_um * waves


def plate_marks(survey: SurveyConfig) -> tuple[Mark, ...]:
    """Return nine marks on either side of the plate that the first three nests span; none without three nests."""
    if len(survey.targets) < 3:
        return ()
    corners = np.array([target.place_mm for target in survey.targets[:3]])
    square = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normal = square / np.linalg.norm(square)
    found = []
    for sense in (1.0, -1.0):
        for one in range(4):
            for other in range(4 - one):
                if (one, other) == (1, 1):
                    continue
                parts = np.array([one, other, 3.0 - one - other]) / 3.0
                place = (0.85 * parts + 0.05) @ corners + sense * 3.0 * normal
                found.append(Mark("", _triple(place), _triple(sense * normal)))
    return tuple(found)


def _base_marks() -> tuple[Mark, ...]:
    """Return fifteen marks on base and table: nine looking forwards and outwards, six up."""
    found: list[Mark] = []
    for angle in np.deg2rad(np.linspace(-60.0, 60.0, 9)):
        out = np.array([np.cos(angle), np.sin(angle), 0.6])
        place = np.array([110.0 * out[0], 110.0 * out[1], 25.0 + 15.0 * (len(found) % 3)])
        found.append(Mark("", _triple(place), _triple(out)))
    for k in range(6):
        found.append(Mark("", (180.0 + 30.0 * (k % 2), -150.0 + 60.0 * k, 5.0), (0.6, 0.0, 0.8)))
    return tuple(found)


def _triple(vector: Floats) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z


def _normal(mark: Mark) -> Floats:
    normal = np.array(mark.normal or (0.0, 0.0, 1.0), dtype=np.float64)
    return np.asarray(normal / np.linalg.norm(normal))


def _fitted(drawn_mm: Floats, seen_mm: Floats) -> Floats | None:
    """Return the frame that fits drawn marks best to seen ones (Arun et al., 1987); None: all on one line."""
    centre, seen_centre = drawn_mm.mean(axis=0), seen_mm.mean(axis=0)
    left, sizes, right = np.linalg.svd((drawn_mm - centre).T @ (seen_mm - seen_centre))
    if sizes[1] < 1e-6 * sizes[0]:
        return None
    turned = right.T @ np.diag([1.0, 1.0, np.linalg.det(right.T @ left.T)]) @ left.T
    frame = np.eye(4)
    frame[:3, :3] = turned
    frame[:3, 3] = seen_centre - turned @ centre
    return frame


BASE_MARKS = _base_marks()
"""Where the paper's fifteen marks sat nobody states; an assumption."""
