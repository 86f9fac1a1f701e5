"""The beam from the arm to the reflectors: who is hit, how far, what blocks it."""

from dataclasses import dataclass

import numpy as np

from simulators.bench.arm import Poses
from simulators.bench.types import Bools, Floats, Ints, Plane
from simulators.config import EmulationConfig
from simulators.truth import TrueArm

NOBODY = -1
"""Index of the reflector when no beam returns."""


@dataclass(frozen=True)
class Sight:
    """What the beam meets at several bench times, shape (n,) each.

    Attributes:
        time_s: bench times, s.
        index: reflector that returns the beam, NOBODY without a return.
        length_mm: projection of the way from the J4 axis to that reflector on the beam, mm; of the
            nearest reflector ahead, by miss, without a return.
        miss_mm: distance of that reflector's centre from the beam's line, mm.
        nearest: index of that reflector.
    """

    time_s: Floats
    index: Ints
    length_mm: Floats
    miss_mm: Floats
    nearest: Ints

    def last(self) -> "Sight":
        """Return the last look alone, shape (1,)."""
        return Sight(
            self.time_s[-1:], self.index[-1:], self.length_mm[-1:], self.miss_mm[-1:], self.nearest[-1:]
        )


class Optics:
    """Reflectors, base column and faults in the way of the beam.

    The beam starts beside the J4 axis by a lateral offset; its length is measured along the beam, so the
    cosine error is in it. A reflector returns the beam when the miss is within its acceptance, it lies
    ahead, the beam comes within its field, and neither the column nor a fault stands between.

    Args:
        truth: places of the reflectors.
        config: acceptance, field, column, offset of the beam, height of the beam.
    """

    def __init__(self, truth: TrueArm, config: EmulationConfig) -> None:
        self.names = list(truth.reflectors)
        self._centres = np.array([complex(*truth.reflectors[name]) for name in self.names])
        facing_deg = {place.name: place.facing_deg for place in config.reflectors}
        self._facing = np.array(
            [
                _facing(facing_deg.get(name), centre)
                for name, centre in zip(self.names, self._centres, strict=True)
            ]
        )
        self._acceptance_mm = config.acceptance_mm
        self._least_cosine = np.cos(np.deg2rad(config.field_half_angle_deg))
        self._column_radius_mm = config.column_radius_mm
        drawn_mm = float(np.random.default_rng([config.seed, 5]).normal(0.0, 0.1))
        self.offset_mm = drawn_mm if config.beam_offset_mm is None else config.beam_offset_mm
        height_mm = config.beam_height_j3_mm
        self._height_mm = config.start_joints[2] if height_mm is None else height_mm
        self._blocked_s = (np.inf, np.inf)

    def block(self, from_s: float, until_s: float) -> None:
        """Let something stand in the beam between two bench times."""
        self._blocked_s = (from_s, until_s)

    def move_reflector(self, name: str, shift_mm: complex) -> None:
        """Shift a reflector's centre.

        Raises:
            KeyError: there is no reflector of that name.
        """
        if name not in self.names:
            raise KeyError(name)
        self._centres[self.names.index(name)] += shift_mm

    def look(self, poses: Poses) -> Sight:
        """Return what the beam meets in each pose."""
        beam = np.exp(1j * poses.beam_rad)
        origin = poses.axis_mm + 1j * self.offset_mm * beam
        relative = (self._centres - origin[:, None]) * np.conj(beam)[:, None]
        along = relative.real
        miss = np.abs(relative.imag)
        lift = poses.height_mm - self._height_mm
        if lift.any():
            miss = np.hypot(miss, lift[:, None])
        returns = (miss <= self._acceptance_mm) & (along > 0.0)
        if returns.any():
            returns &= self._in_field(beam) & ~self._behind_column(origin, beam, along)
            returns[self._blocked(poses.time_s)] = False
        return _choose(poses, returns, along, miss)

    def level(self, miss_mm: float) -> float:
        """Return the signal level, 0...1, of a beam that returns with a miss."""
        return float(np.exp(-2.0 * (miss_mm / self._acceptance_mm) ** 2))

    def _in_field(self, beam: Plane) -> Bools:
        back: Bools = (-beam[:, None] * np.conj(self._facing)).real >= self._least_cosine
        return back

    def _behind_column(self, origin: Plane, beam: Plane, along: Floats) -> Bools:
        nearest = np.clip(-(origin * np.conj(beam)).real[:, None], 0.0, along)
        behind: Bools = np.abs(origin[:, None] + nearest * beam[:, None]) < self._column_radius_mm
        return behind

    def _blocked(self, time_s: Floats) -> Bools:
        started: Bools = time_s >= self._blocked_s[0]
        ended: Bools = time_s >= self._blocked_s[1]
        return started & ~ended


def _facing(facing_deg: float | None, centre: complex) -> complex:
    if facing_deg is None:
        return -centre / abs(centre) if centre else 1.0 + 0.0j
    return complex(np.exp(1j * np.deg2rad(facing_deg)))


def _choose(poses: Poses, returns: Bools, along: Floats, miss: Floats) -> Sight:
    hit: Bools = np.any(returns, axis=1)
    # Of several reflectors in the beam the first one stops it; without any, the nearest miss is of interest.
    rank = np.where(hit[:, None], np.where(returns, along, np.inf), np.where(along > 0.0, miss, np.inf))
    best = np.argmin(rank, axis=1)
    rows = np.arange(best.size)
    length = along[rows, best] + poses.white_mm
    return Sight(poses.time_s, np.where(hit, best, NOBODY), length, miss[rows, best], best)
