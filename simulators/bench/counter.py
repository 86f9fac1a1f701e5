"""The length counter: counts while the beam is unbroken, latches a break and an overspeed until zero."""

from dataclasses import dataclass

import numpy as np

from simulators.bench.optics import NOBODY, Sight
from simulators.bench.types import Floats
from simulators.config import EmulationConfig, ErrorBudget

_SHORTEST_STEP_S = 1e-7
_FRINGE_MM = 316.5e-6
"""Half a wavelength of a helium-neon laser, mm."""


@dataclass(frozen=True)
class Reading:
    """One reading of the counter.

    Attributes:
        displacement_mm: displacement since the last zero; wrong when beam_lost or overspeed is latched.
        returns: the beam returns now.
        beam_lost: latched since the last zero.
        overspeed: latched since the last zero.
        level: signal level, 0...1.
        zero_id: number of zeros so far.
    """

    displacement_mm: float
    returns: bool
    beam_lost: bool
    overspeed: bool
    level: float
    zero_id: int


class SlowDrift:
    """A smooth random function of bench time: three waves with periods of 5 to 60 minutes.

    Args:
        rng: where periods and phases come from.
        rms: its rms, in any unit.
    """

    def __init__(self, rng: np.random.Generator, rms: float) -> None:
        self._rates = 2.0 * np.pi / rng.uniform(300.0, 3600.0, 3)
        self._phases = rng.uniform(0.0, 2.0 * np.pi, 3)
        self._amplitude = rms * np.sqrt(2.0 / 3.0)

    def at(self, time_s: float) -> float:
        """Return its value at a bench time."""
        return float(self._amplitude * np.sin(self._rates * time_s + self._phases).sum())


class Counter:
    """State of the count.

    Args:
        config: budget, seed and the displacement rate that the counter follows.
        first: what the beam meets at bench time 0, shape (1,).
    """

    def __init__(self, config: EmulationConfig, first: Sight) -> None:
        self._budget: ErrorBudget = config.budget
        self._limit_mm_s = config.speed_limit_mm_s
        self._noise = np.random.default_rng([config.seed, 6])
        self._slips = np.random.default_rng([config.seed, 10])
        rng = np.random.default_rng([config.seed, 7])
        scale_um = np.hypot(config.budget.wavelength_um, config.budget.correction_um)
        self._scale = 1.0 + float(rng.normal(0.0, 1.0)) * float(scale_um) * 1e-3 / 700.0
        self._drift = SlowDrift(rng, config.budget.environment_um * 1e-3)
        self._drift_at_zero_mm = self._drift.at(0.0)
        self._last = first
        self._origin_mm = float(first.length_mm[0])
        self._held_mm = 0.0
        self.beam_lost = int(first.index[0]) == NOBODY
        self.overspeed = False
        self.zero_id = 0

    def follow(self, sight: Sight) -> None:
        """Count along consecutive looks at the beam, in the order of bench time."""
        index = np.concatenate([self._last.index, sight.index])
        length = np.concatenate([self._last.length_mm, sight.length_mm])
        same = index[1:] == index[:-1]
        steps_s = np.diff(np.concatenate([self._last.time_s, sight.time_s]))
        fast = (
            same
            & (index[1:] != NOBODY)
            & (np.abs(np.diff(length)) > self._limit_mm_s * np.maximum(steps_s, _SHORTEST_STEP_S))
        )
        # Each interval that is not counted is taken out of the count, in the order in which they come.
        for k in np.flatnonzero(~same | fast):
            self._skip(int(index[k]), int(index[k + 1]), length[k : k + 2], fast=bool(fast[k]))
        self._last = sight.last()

    def shift_target(self, sight: Sight) -> None:
        """Go on after a reflector was moved by hand: a quick push, but not a jump in no time."""
        if int(sight.index[0]) != int(self._last.index[0]):
            self.follow(sight)
        self._last = sight

    def zero(self, time_s: float) -> bool:
        """Start again from 0 and clear the latches; refused without a beam.

        Args:
            time_s: bench time of the last look, s.
        """
        if int(self._last.index[0]) == NOBODY:
            self.beam_lost = True
            return False
        self._origin_mm = float(self._last.length_mm[0])
        self._drift_at_zero_mm = self._drift.at(time_s)
        self.beam_lost = self.overspeed = False
        self.zero_id += 1
        return True

    def read(self, time_s: float, level: float) -> Reading:
        """Return one reading; each has a noise of its own.

        Args:
            time_s: bench time of the last look, s.
            level: signal level of the beam, 0...1, without noise.
        """
        returns = int(self._last.index[0]) != NOBODY
        noise = self._noise.standard_normal(2)
        value_mm = self._count_mm() * self._scale + self._drift.at(time_s) - self._drift_at_zero_mm
        value_mm += float(noise[0]) * self._budget.counter_noise_um * 1e-3
        step_mm = self._budget.counter_resolution_um * 1e-3
        if step_mm:
            value_mm = round(value_mm / step_mm) * step_mm
        shown = min(1.0, max(0.0, level + 0.003 * float(noise[1]))) if returns else 0.0
        return Reading(value_mm, returns, self.beam_lost, self.overspeed, shown, self.zero_id)

    def _slip_mm(self) -> float:
        """Return what fading fringes do to a count: the way out and back does not restore it by symmetry."""
        return float(self._slips.integers(1, 100) * self._slips.choice((-1, 1))) * _FRINGE_MM

    def _count_mm(self) -> float:
        if int(self._last.index[0]) == NOBODY:
            return self._held_mm
        return float(self._last.length_mm[0]) - self._origin_mm

    def _skip(self, before: int, after: int, length_mm: Floats, *, fast: bool) -> None:
        if fast:
            self.overspeed = True
            self._origin_mm += float(length_mm[1] - length_mm[0])
            return
        if before != NOBODY:
            self.beam_lost = True
            self._held_mm = float(length_mm[0]) - self._origin_mm + self._slip_mm()
        if after != NOBODY:
            self._origin_mm = float(length_mm[1]) - self._held_mm
