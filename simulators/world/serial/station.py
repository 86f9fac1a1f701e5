"""Where an instrument stands in the room: a frame that nobody knows, and that wanders."""

import numpy as np

from catseye.simulators.config import EmulationConfig
from catseye.simulators.survey import Place, SurveyConfig
from catseye.simulators.world.serial.drift import Drift
from catseye.simulators.world.serial.frames import frames_of, inverse
from catseye.simulators.world.types import Floats

_OFF_MM = 100.0


class Station:
    """The frame of an instrument in the room, and what stands before it.

    Args:
        place_mm: roughly where it stands, unless the cell says where it sees the arm's base.
        number: of the instrument, for its own random values.
    """

    def __init__(self, config: EmulationConfig, place_mm: Place, number: int) -> None:
        rng = np.random.default_rng([config.seed, 34, number])
        survey = config.survey
        self._frame = _seen(survey, rng) if survey.base_seen else _anyhow(place_mm, survey.leans_deg, rng)
        self._drift = Drift(rng, survey.instrument_drift_um, survey.instrument_drift_urad)
        self._bumps = np.random.default_rng([config.seed, 35, number])

    def frame_at(self, times_s: Floats) -> Floats:
        """Return the instrument's frame in the room at bench times, shape (m, 4, 4)."""
        return np.asarray(self._frame @ self._drift.at(times_s))

    def into_at(self, times_s: Floats) -> Floats:
        """Return what leads from the room into the instrument's frame, shape (m, 4, 4)."""
        return inverse(self.frame_at(times_s))

    def bump(self, mm: float, deg: float) -> None:
        """Push the instrument: by so much, and turned by so much, in a random direction."""
        ways = self._bumps.standard_normal((2, 3))
        moved, turned = ways / np.linalg.norm(ways, axis=1, keepdims=True)
        self._frame = self._frame @ frames_of(mm * moved, np.deg2rad(deg) * turned)


def _anyhow(place_mm: Place, leans_deg: float, rng: np.random.Generator) -> Floats:
    leans = np.deg2rad(rng.normal(0.0, leans_deg, 2))
    stands_mm = np.array(place_mm) + rng.normal(0.0, _OFF_MM, 3)
    return frames_of(stands_mm, np.array([*leans, rng.uniform(-np.pi, np.pi)]))


def _seen(survey: SurveyConfig, rng: np.random.Generator) -> Floats:
    off = frames_of(rng.normal(0.0, survey.u_seen_mm, 3), np.deg2rad(rng.normal(0.0, survey.u_seen_deg, 3)))
    return np.asarray(off @ inverse(base_seen(survey)))


def base_seen(survey: SurveyConfig) -> Floats:
    """Return the arm's base in the instrument's frame as an operator knows it, shape (4, 4); by default no turn."""
    place_mm, turn_deg = survey.base_seen or ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return frames_of(np.array(place_mm), np.deg2rad(turn_deg))
