"""The length counter: counts while the beam is unbroken, latches a break and an overspeed until zero."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from catseye.simulators.config import EmulationConfig, ErrorBudget
from catseye.simulators.world.optics import NOBODY, Sight

_SHORTEST_STEP_S = 1e-7
_FRINGE_MM = 316.5e-6
"""Half a wavelength of a helium-neon laser, mm."""

RATE_S = 0.04
"""A rate is the difference of two counts that lie so far apart; an assumption."""


@dataclass(frozen=True)
class Reading:
    """One reading of the counter.

    Attributes:
        displacement_mm: displacement since the last zero; wrong when beam_lost or overspeed is latched.
        vacuum_mm: the same as counted in vacuum wavelengths: what an instrument without any correction for
            the air shows. The air's change along the whole beam, dead path included, is in it.
        returns: the beam returns now.
        beam_lost: latched since the last zero.
        overspeed: latched since the last zero.
        level: signal level, 0...1.
        zero_id: number of zeros so far.
        laser_ready: the laser holds its frequency now.
    """

    displacement_mm: float
    vacuum_mm: float
    returns: bool
    beam_lost: bool
    overspeed: bool
    level: float
    zero_id: int
    laser_ready: bool = True

    @property
    def counts(self) -> bool:
        """The beam returns and its fringes mean something: all that an instrument without a laser bit can show."""
        return self.returns and self.laser_ready


class SlowDrift:
    """A smooth random function of bench time: three waves with periods of 5 to 60 minutes.

    Args:
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
        config: budget and seed.
        first: what the beam meets at bench time 0, shape (1,).
        air_index: refractive index of the air at a bench time.
        number: of the counters on one bench, each has noise and errors of its own.

    Attributes:
        beam_lost: latched since the last zero.
        overspeed: latched since the last zero.
        zero_id: number of zeros so far.
        break_count: breaks of the beam so far, for instruments that clear their flags in a way of their own.
        overspeed_count: how often the length changed too fast so far.
        laser_ready: the laser holds its frequency now; without it nothing can be zeroed.
    """

    def __init__(
        self, config: EmulationConfig, first: Sight, air_index: Callable[[float], float], number: int = 0
    ) -> None:
        self._air_index = air_index
        self._budget: ErrorBudget = config.budget
        self._noise = np.random.default_rng([config.seed, 6, number])
        self._slips = np.random.default_rng([config.seed, 10, number])
        self._rates = np.random.default_rng([config.seed, 17, number])
        rng = np.random.default_rng([config.seed, 7, number])
        budget, error = config.budget, float(rng.normal(0.0, 1.0)) * 1e-3 / 700.0
        self._scale = 1.0 + error * float(np.hypot(budget.wavelength_um, budget.correction_um))
        # Whoever corrects a count in vacuum wavelengths brings the errors of its own sensors.
        self._vacuum_scale = 1.0 + error * budget.wavelength_um
        self._drift = SlowDrift(rng, config.budget.environment_um * 1e-3)
        self._drift_at_zero_mm = self._drift.at(0.0)
        self._last = first
        self._origin_mm = float(first.length_mm[0])
        self._optical_origin_mm = self._optical_mm(first)
        self._held_mm = 0.0
        self._optical_held_mm = 0.0
        self.beam_lost = int(first.index[0]) == NOBODY
        self.overspeed = False
        self.zero_id = 0
        self.break_count = int(self.beam_lost)
        self.overspeed_count = 0
        self.laser_ready = True

    @property
    def last(self) -> Sight:
        """The last look at the beam, shape (1,)."""
        return self._last

    def follow(self, gaps: list["Gap"], last: Sight) -> None:
        """Count along looks at the beam.

        Args:
            gaps: what is not counted between the last look so far and the new last one, in the order of bench time.
            last: the new last look, shape (1,).
        """
        for gap in gaps:
            self._skip(gap)
        self._last = last

    def outrun(self) -> None:
        """Lose fringes, as after too fast a change of the length."""
        self.overspeed = True
        self.overspeed_count += 1
        self._slip()

    def set_laser(self, *, ready: bool) -> None:
        """Let the laser hold its frequency or lose it; what was counted until it holds again is no length."""
        if self.laser_ready != ready:
            self.beam_lost = True
            self.break_count += 1
            self._slip()
        self.laser_ready = ready

    def zero(self, time_s: float) -> bool:
        """Start again from 0 and clear the latches; refused without a beam and without a laser that is ready.

        Args:
            time_s: bench time of the last look, s.
        """
        if int(self._last.index[0]) == NOBODY or not self.laser_ready:
            self.beam_lost = True
            return False
        self._origin_mm = float(self._last.length_mm[0])
        self._optical_origin_mm = self._optical_mm(self._last)
        self._drift_at_zero_mm = self._drift.at(time_s)
        self.beam_lost = self.overspeed = False
        self.zero_id += 1
        return True

    def restart(self, time_s: float) -> None:
        """Count from 0 as after power on: with a beam nothing tells that a count was lost."""
        self.beam_lost = False
        if not self.zero(time_s):
            self._held_mm = self._optical_held_mm = 0.0
        self.zero_id = 0

    def read(self, time_s: float, level: float) -> Reading:
        """Return one reading; each has a noise of its own.

        Args:
            time_s: bench time of the last look, s.
            level: signal level of the beam, 0...1, without noise.
        """
        returns = int(self._last.index[0]) != NOBODY
        noise = self._noise.standard_normal(2)
        added_mm = self._drift.at(time_s) - self._drift_at_zero_mm
        added_mm += float(noise[0]) * self._budget.counter_noise_um * 1e-3
        shown = min(1.0, max(0.0, level + 0.003 * float(noise[1]))) if returns else 0.0
        return Reading(
            displacement_mm=self._rounded(self._count_mm() * self._scale + added_mm),
            vacuum_mm=self._rounded(self._optical_count_mm(time_s) * self._vacuum_scale + added_mm),
            returns=returns,
            beam_lost=self.beam_lost,
            overspeed=self.overspeed,
            level=shown,
            zero_id=self.zero_id,
            laser_ready=self.laser_ready,
        )

    def rate_mm_s(self, true_mm_s: float) -> float:
        """Return a rate as it comes out of two counts; without a beam there is none.

        Args:
            true_mm_s: that at which the beam really becomes longer.
        """
        if int(self._last.index[0]) == NOBODY:
            return 0.0
        noise = math.sqrt(2.0) * float(self._rates.standard_normal())
        noise_mm = 1e-3 * self._budget.counter_noise_um * noise
        return self._rounded(RATE_S * true_mm_s * self._vacuum_scale + noise_mm) / RATE_S

    def _slip(self) -> None:
        slip_mm = self._slip_mm()
        self._origin_mm -= slip_mm
        self._optical_origin_mm -= slip_mm

    def _slip_mm(self) -> float:
        """Return what fading fringes do to a count: the way out and back does not restore it by symmetry."""
        return float(self._slips.integers(1, 100) * self._slips.choice((-1, 1))) * _FRINGE_MM

    def _count_mm(self) -> float:
        if int(self._last.index[0]) == NOBODY:
            return self._held_mm
        return float(self._last.length_mm[0]) - self._origin_mm

    def _optical_mm(self, sight: Sight) -> float:
        """Return the optical length of the beam at the first of some looks: what vacuum wavelengths fill."""
        return float(sight.length_mm[0]) * self._air_index(float(sight.time_s[0]))

    def _optical_count_mm(self, time_s: float) -> float:
        if int(self._last.index[0]) == NOBODY:
            return self._optical_held_mm
        return float(self._last.length_mm[0]) * self._air_index(time_s) - self._optical_origin_mm

    def _rounded(self, value_mm: float) -> float:
        step_mm = self._budget.counter_resolution_um * 1e-3
        return round(value_mm / step_mm) * step_mm if step_mm else value_mm

    def _skip(self, gap: "Gap") -> None:
        if gap.fast:
            self.overspeed = True
            self.overspeed_count += 1
            self._origin_mm += gap.after_mm - gap.before_mm
            self._optical_origin_mm += gap.optical_after_mm - gap.optical_before_mm
            return
        if gap.before != NOBODY:
            self.beam_lost = True
            self.break_count += 1
            slip_mm = self._slip_mm()
            self._held_mm = gap.before_mm - self._origin_mm + slip_mm
            self._optical_held_mm = gap.optical_before_mm - self._optical_origin_mm + slip_mm
        if gap.after != NOBODY:
            self._origin_mm = gap.after_mm - self._held_mm
            self._optical_origin_mm = gap.optical_after_mm - self._optical_held_mm


@dataclass(frozen=True)
class Gap:
    """An interval between two looks at the beam that no counter counts: too fast, or not on one reflector.

    Attributes:
        before: reflector at its start, NOBODY without a return.
        after: reflector at its end.
        fast: the beam stays on its reflector, and its length changes too fast.
        before_mm: length of the beam at the start.
        after_mm: length of the beam at the end.
        optical_before_mm: optical length of the beam at the start.
        optical_after_mm: optical length of the beam at the end.
    """

    before: int
    after: int
    fast: bool
    before_mm: float
    after_mm: float
    optical_before_mm: float
    optical_after_mm: float


def gaps_between(
    last: Sight, sight: Sight, limit_mm_s: float, air_index: Callable[[float], float]
) -> list[Gap]:
    """Return what is not counted along consecutive looks at the beam, in the order of bench time.

    Args:
        last: the look before them, shape (1,).
        limit_mm_s: displacement rate that counters follow.
        air_index: refractive index of the air at a bench time.
    """
    index = np.concatenate([last.index, sight.index])
    length = np.concatenate([last.length_mm, sight.length_mm])
    time_s = np.concatenate([last.time_s, sight.time_s])
    same = index[1:] == index[:-1]
    most_mm = limit_mm_s * np.maximum(time_s[1:] - time_s[:-1], _SHORTEST_STEP_S)
    fast = same & (index[1:] != NOBODY) & (np.abs(length[1:] - length[:-1]) > most_mm)
    gaps = []
    for k in (~same | fast).nonzero()[0]:
        optical = [float(length[i]) * air_index(float(time_s[i])) for i in (k, k + 1)]
        ends = int(index[k]), int(index[k + 1])
        gaps.append(Gap(*ends, bool(fast[k]), float(length[k]), float(length[k + 1]), *optical))
    return gaps
