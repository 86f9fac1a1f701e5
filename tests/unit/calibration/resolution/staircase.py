"""Recordings of steps that are written down here: what a joint did, not what the evaluation makes of it."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.moves import Moves, moves_of
from catseye.calibration.resolution.recording import Recording, recording_of
from catseye.calibration.resolution.units import Unit

DEG = np.pi / 180.0
STEPS_DEG: Floats = np.asarray(0.1 / 1.072267 ** np.arange(109.0), dtype=np.float64)
"""The paper's series (section 3.4)."""


@dataclass(frozen=True)
class Bench:
    """How a staircase is recorded.

    Attributes:
        noise: white noise of a sample, in the unit of the position.
        motion_s: how long a step takes, s.
        lead_s: standstill before the first move, s.
    """

    rate_hz: float = 100.0
    dwell_s: float = 5.0
    motion_s: float = 0.8
    lead_s: float = 62.0
    noise: float = 0.0
    drift_per_s: float = 0.0
    unit: Unit = "rad"

    def moves(self, command: Floats) -> Moves:
        """Return moves of these sizes, one a dwell."""
        return moves_of(self.lead_s + self.dwell_s * np.arange(float(command.size)), command, self.unit)

    def samples(self, moves: Moves, done: Floats, seed: int = 1) -> tuple[Floats, Floats]:
        """Return times and positions of a recording in which each move did what is given."""
        time_s = np.arange(0.0, moves.time_s[-1] + self.dwell_s, 1.0 / self.rate_hz)
        position = self.drift_per_s * time_s
        for start_s, step in zip(moves.time_s, done, strict=True):
            share = np.clip((time_s - start_s) / self.motion_s, 0.0, 1.0)
            position += step * (0.5 - 0.5 * np.cos(np.pi * share))
        return time_s, position + np.random.default_rng(seed).normal(0.0, self.noise, time_s.size)

    def recorded(self, moves: Moves, done: Floats, seed: int = 1) -> Recording:
        """Return a recording in which each move did what is given."""
        return recording_of(*self.samples(moves, done, seed), self.unit)
