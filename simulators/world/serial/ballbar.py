"""A telescopic ballbar between a cup on the table and a nest on the tool."""

from collections.abc import Callable

import numpy as np

from catseye.simulators.config import EmulationConfig
from catseye.simulators.errors import BenchError
from catseye.simulators.survey import Place
from catseye.simulators.world.serial.room import CENTRE, Nest, Room
from catseye.simulators.world.types import Floats

_STROKE_MM = 0.5
"""By how much it slides beyond what it reads before its magnets let go; an assumption."""

_LOOK_S = 0.02
_MOST_LOOKS = 20_000
_CALM_S = 1.0

_RECORDED_S = 0.05
"""Between two readings of a recording: 20 readings a second; an assumption."""


class Ballbar:
    """The ballbar; hands put it between its cup and a nest, and it falls off when the arm pulls too far.

    Args:
        room: where cup and nests are.
        config: its length and its errors.
        now: bench time, s.
    """

    def __init__(self, room: Room, config: EmulationConfig, now: Callable[[], float]) -> None:
        self._room, self._survey, self._now = room, config.survey, now
        rng = np.random.default_rng([config.seed, 40])
        self._calibration_mm = 1e-3 * self._survey.u_ballbar_um * float(rng.standard_normal())
        self._noise = np.random.default_rng([config.seed, 41])
        self._target: str | None = None
        self._fallen = False
        self._looked_s = 0.0
        self._mounted_s = 0.0
        self._recording = (np.zeros(0), np.zeros(0))

    @property
    def mounted(self) -> str | None:
        """Nest in which it hangs; None: in none, or it fell off."""
        self._follow()
        return None if self._fallen else self._target

    def place_cup(self, target: str) -> None:
        """Clamp the cup under the ball in a nest, where that is now.

        Raises:
            BenchError: there is no such nest on the tool.
        """
        self._on_tool(target)
        x, y, z = self._room.places_mm([target], np.array([self._now()]))[0, 0].tolist()
        self._room.set_up_cup((x, y, z))

    def mount(self, target: str, centre_mm: Place | None = None) -> None:
        """Put it between cup and nest, in place of the retroreflectors there.

        Args:
            target: nest on the tool.
            centre_mm: where the cup is put first, in the room; None: it stays where it is.

        Raises:
            BenchError: there is no such nest or no cup, or the nest is not at the ballbar's length from it.
        """
        nest = self._on_tool(target)
        self.take_off()
        if centre_mm is not None:
            self._room.set_up_cup(centre_mm)
        self._room.named(CENTRE)
        off_mm = float(self._deviations_mm(target, np.array([self._now()]))[0])
        if abs(off_mm) > self._longest_mm:
            raise BenchError(
                f"{target} is {self._survey.ballbar_mm + off_mm:.1f} mm from the cup: the ballbar reaches "
                f"{self._survey.ballbar_mm:g} ± {self._longest_mm:g} mm; move the arm there first"
            )
        self._target, self._fallen, self._looked_s = target, False, self._now()
        self._mounted_s = self._looked_s
        nest.occupied = self._room.nests[CENTRE].occupied = False

    def take_off(self) -> None:
        """Take it off, or pick it up, and put the retroreflectors back."""
        if self._target is not None:
            self._recording = self._recorded(self._target)
            self._room.nests[self._target].occupied = self._room.nests[CENTRE].occupied = True
        self._target = None

    def recording(self) -> tuple[Floats, Floats]:
        """Return what its program has recorded since the last mounting until it was taken off, or until now.

        Returns:
            Times since the mounting, s, and deviations from the nominal length, mm, over range left out.
        """
        return self._recording if self._target is None else self._recorded(self._target)

    def _recorded(self, target: str) -> tuple[Floats, Floats]:
        count = int((self._now() - self._mounted_s) / _RECORDED_S) + 1
        times_s: Floats = self._mounted_s + _RECORDED_S * np.arange(count, dtype=np.float64)
        true_mm = self._deviations_mm(target, times_s)
        fallen = np.flatnonzero(np.abs(true_mm) > self._longest_mm)
        shown_mm = self._shown_mm(true_mm)[: fallen[0] if len(fallen) else None]
        kept = np.flatnonzero(np.abs(shown_mm) <= self._survey.ballbar_range_mm)
        return times_s[kept] - self._mounted_s, shown_mm[kept]

    def reading_mm(self) -> float | None:
        """Return by how much it is longer than its nominal length now; None: over range, or not mounted."""
        target = self.mounted
        if target is None:
            return None
        shown_mm = float(self._shown_mm(self._deviations_mm(target, np.array([self._now()])))[0])
        return shown_mm if abs(shown_mm) <= self._survey.ballbar_range_mm else None

    def _on_tool(self, target: str) -> Nest:
        nest = self._room.named(target)
        if not nest.on_tool:
            raise BenchError(
                f"{target} is not on the tool: the ballbar hangs between the cup and a nest on the tool"
            )
        return nest

    def _shown_mm(self, true_mm: Floats) -> Floats:
        noise_mm = 1e-3 * self._survey.ballbar_um * self._noise.standard_normal(true_mm.size)
        return true_mm + self._calibration_mm + noise_mm

    @property
    def _longest_mm(self) -> float:
        return self._survey.ballbar_range_mm + _STROKE_MM

    def _follow(self) -> None:
        """Let it fall off if it was pulled too far since somebody looked last."""
        now_s = self._now()
        if self._target is not None and not self._fallen:
            until_s = min(now_s, self._room.plant.motion.end_s + _CALM_S)
            count = max(0, int(np.ceil((until_s - self._looked_s) / _LOOK_S)))
            times_s = np.append(np.linspace(self._looked_s, until_s, min(count, _MOST_LOOKS)), now_s)
            self._fallen = bool(np.abs(self._deviations_mm(self._target, times_s)).max() > self._longest_mm)
        self._looked_s = now_s

    def _deviations_mm(self, target: str, times_s: Floats) -> Floats:
        ends = self._room.places_mm([target, CENTRE], times_s)
        return np.asarray(np.linalg.norm(ends[0] - ends[1], axis=-1) - self._survey.ballbar_mm)
